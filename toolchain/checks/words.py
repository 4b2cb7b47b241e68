#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Whether code and its comments use the words of the glossary (docs/guides/glossary.md).

    words.py           every complaint by file and line; exit status 1 when there is one
    words.py --top DIR of another tree

Comments are held to the words of pages.py, names to those below. Quoted names in comments are held to the latter.
"""
import argparse
import fnmatch
import pathlib
import re
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
sys.dont_write_bytecode = True
import pages  # noqa: E402

SOURCES = (".hpp", ".cpp", ".h", ".c")
# Parts of names, with the part to use: of CamelCase and of snake_case.
NAMES = {"ball": "sphere", "balls": "spheres", "barrel": "cylinder", "barrels": "cylinders", "glance": "quick reject", "glances": "quick rejects",
         "rung": "method", "rungs": "methods", "ladder": "order", "told": "reported", "echo": "return", "dear": "expensive", "dearest": "most expensive"}
PREFIXES = {"kMost": "kMax", "kLeast": "kMin"}
# (files, word): why the word is right there.
EXCUSED = {
    ("firmware/linux/read_ahead.hpp", "room"): "the name of a parameter: free space of a queue",
    ("tests/property/core/orca/published_rooms_test.cpp", "room"): "the buildings that Alejo draws",
    ("tests/property/core/orca/published_rooms_test.cpp", "rooms"): "the buildings that Alejo draws",
    ("tests/target/board/counters.cpp", "guard"): "the C++ ABI's guard variable",
    ("tests/target/can/guest.cpp", "echo"): "a CAN controller's echo of its own frames",
    ("tests/unit/hal/termios_serial_port_test.cpp", "echo"): "a terminal's echo",
}
PART = re.compile(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])")
NAME = re.compile(r"\b[A-Za-z_]\w*\b")
TOKEN = re.compile(r'//[^\n]*|/\*.*?\*/|R"(\w*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])\'', re.S)


def split(text):
    """(code, comments), each with the other and all strings blanked; lines stay."""
    def blank(match):
        return re.sub(r"[^\n]", " ", match[0])
    code = TOKEN.sub(blank, text)
    comments, last = [], 0
    for match in TOKEN.finditer(text):
        comments.append(re.sub(r"[^\n]", " ", text[last:match.start()]))
        comments.append(match[0] if match[0].startswith("/") else blank(match))
        last = match.end()
    return code, "".join(comments) + re.sub(r"[^\n]", " ", text[last:])


def excused(name, word):
    return any(fnmatch.fnmatch(name, files) and word == w for files, w in EXCUSED)


def complaints_of(name, text):
    code, comments = split(text)
    for found in NAME.finditer(code):
        parts = [p.lower() for p in PART.findall(found[0])]
        hits = [(p, NAMES[p]) for p in parts if p in NAMES] + [(p, b) for p, b in PREFIXES.items() if re.match(p + r"([A-Z]|$)", found[0])]
        for word, better in hits:
            if not excused(name, word):
                yield code.count("\n", 0, found.start()) + 1, f"{found[0]}: write {better}"
    prose = re.sub(r"`[^`]*`", lambda m: re.sub(r"[^\n]", " ", m[0]), comments)
    prose = re.sub(r"\n(\s*)///?<?", lambda m: "\n" + m[1], prose)  # sentences go on in the next line
    for found in pages.WORDS.finditer(prose):
        word = " ".join(found[0].split()).lower()
        better = next(b for w, b in pages.REFUSED.items() if re.fullmatch(w, word, re.I))
        if not excused(name, word):
            yield prose.count("\n", 0, found.start()) + 1, f"\"{word}\": write {better}"


def complaints(top):
    done = subprocess.run(["git", "-C", str(top), "ls-files", "-co", "--exclude-standard"], capture_output=True, text=True, check=True)
    for name in done.stdout.splitlines():
        if name.endswith(SOURCES) and (top / name).is_file():
            for line, what in complaints_of(name, (top / name).read_text(encoding="utf-8")):
                yield name, line, what


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--top", type=pathlib.Path, default=pages.TOP, help="of the tree that is checked")
    found = list(complaints(p.parse_args().top.resolve()))
    for name, line, what in found:
        print(f"{name}:{line}: {what}")
    if not found:
        print("every comment and name uses the words of the glossary")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
