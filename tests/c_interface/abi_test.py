#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Whether libjink.so.0 is what programs were compiled against: its symbols, the numbers of jink.h, its structures.

    abi_test.py --library FILE --header FILE --layout PROGRAM [--write]

abi.txt beside this file has them. A change of a line is another JINK_ABI; new lines are not. --write writes abi.txt.
"""
import argparse
import pathlib
import re
import subprocess
import sys

PINNED = pathlib.Path(__file__).resolve().with_name("abi.txt")


def output(*command):
    return subprocess.run([str(c) for c in command], check=True, capture_output=True, text=True).stdout


def symbols(library):
    """Names and versions of all that the library exports."""
    for line in output("nm", "--dynamic", "--defined-only", "--with-symbol-versions", library).splitlines():
        _, kind, name = line.split()
        if kind != "A":
            yield f"{kind} {name}"


def numbers(header):
    """Enumerators and constants."""
    for name, value in re.findall(r"^\s*(?:#define )?(JINK_[A-Z0-9_]+)(?: = | )(-?\w[\w()]*)", header, re.M):
        yield f"{name} {value}"
    for names in re.findall(r"^enum \{ (.*) \};$", header, re.M):
        yield from (pair.strip().replace(" = ", " ") for pair in names.split(","))


def fields(header):
    """Every field of every structure, found without the compiler."""
    for body, name in re.findall(r"typedef struct \w+ \{(.*?)\} (\w+);", header, re.S):
        body = re.sub(r"/\*.*?\*/", "", body, flags=re.S)
        for declaration in filter(str.strip, body.split(";")):
            for field in declaration.split(","):
                yield name + "." + re.search(r"(\w+)(?:\[[^]]*\])?$", field.strip())[1]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    for name in ("library", "header", "layout"):
        parser.add_argument(f"--{name}", type=pathlib.Path, required=True)
    parser.add_argument("--write", action="store_true")
    arguments = parser.parse_args()
    header = arguments.header.read_text(encoding="utf-8")
    layout = output(arguments.layout, "--layout").splitlines()
    soname = re.search(r"\(SONAME\).*\[(.+)\]", output("readelf", "-d", arguments.library))[1]
    found = [soname, *sorted(symbols(arguments.library)), *sorted(set(numbers(header))), *layout]
    if arguments.write:
        PINNED.write_text("\n".join(found) + "\n", encoding="utf-8")
    errors = []
    declared = set(re.findall(r"^JINK_API .*?(jink_\w+)\(", header, re.M))
    exported = {re.search(r"jink_\w+", s)[0] for s in symbols(arguments.library) if s.startswith("T jink_")}
    errors += [f"{name}: declared or exported, not both" for name in sorted(declared ^ exported)]
    errors += [f"exported beside the functions of jink.h: {s}" for s in symbols(arguments.library) if not re.match(r"T jink_\w+@@JINK_0$", s)]
    errors += [f"{field} is missing in layout_fields.h" for field in fields(header) if not any(line.startswith(field + " ") for line in layout)]
    pinned = PINNED.read_text(encoding="utf-8").splitlines()
    errors += [f"changed or gone: {line}" for line in pinned if line not in found]
    errors += [f"new, and not in abi.txt: {line}" for line in found if line not in pinned]
    print("\n".join(errors) or f"{soname}: {len(declared)} functions, {len(layout)} places of structures")
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main())
