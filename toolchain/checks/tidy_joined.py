#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""clang-tidy over many sources at the price of a few.

clang-tidy spends most of its time on the headers of a source (Eigen, the standard library), again for each source. This
script joins the sources of core to a few texts and checks each text once: every include once, each line mapped to its
source, so that findings name the source and its line. Names in unnamed namespaces must be unique per namespace;
otherwise the joined text does not compile, which is reported.

Usage: tidy_joined.py CLANG_TIDY BUILD TEXTS [--OPTION_OF_CLANG_TIDY ...] SOURCE ...
"""
import json
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

TOP = pathlib.Path(__file__).resolve().parents[2]
INCLUDE = re.compile(r'\s*#\s*include\s*([<"][^>"]+[>"])')
JOINED = re.compile(r'^#include "([^"]+)"', re.M)
FINDING = re.compile(r'^(?P<file>[^:\s]+):(?P<line>\d+):(?P<rest>\d+: .*)$')


def without_precompiled(flags):
    """clang cannot read headers that GCC has precompiled."""
    kept, skip = [], False
    for flag, following in zip(flags, [*flags[1:], ""]):
        if skip:
            skip = False
        elif flag == "-include" and "cmake_pch" in following:
            skip = True
        elif flag != "-Winvalid-pch":
            kept.append(flag)
    return kept


def flags_of(build, sources):
    """The compiler's arguments; joined sources must have equal arguments. Where the build joins sources itself, those
    of the joined text (jink_joined)."""
    commands = {}
    for command in json.loads((build / "compile_commands.json").read_text()):
        words = shlex.split(command["command"])
        text = pathlib.Path(command["file"])
        parts = JOINED.findall(text.read_text()) if text.parent.name == "Unity" and text.exists() else [text]
        if "_sanitized.dir" not in words[words.index("-o") + 1]:
            commands.update({pathlib.Path(part).resolve(): words for part in parts})
    found = None
    for source in sources:
        if source not in commands:
            raise SystemExit(f"tidy: {source} is not built in {build}")
        words = commands[source]
        start = next(i for i, word in enumerate(words) if word.startswith("-"))
        flags = without_precompiled(words[start:words.index("-o")])
        if found is not None and flags != found:
            raise SystemExit(f"tidy: {source} is built with other flags than the rest")
        found = flags
    return found


def join(sources):
    """The text, and the origin of each of its lines."""
    lines, places, seen = [], [], set()
    for source in sources:
        own = set()
        for number, line in enumerate(source.read_text().splitlines(), start=1):
            include = INCLUDE.match(line)
            # A header included twice within one source stays, so that the check reports it.
            if include and include[1] in seen and include[1] not in own:
                line = ""
            if include:
                own.add(include[1])
            lines.append(line)
            places.append((source, number))
        seen |= own
    return "\n".join(lines) + "\n", places


def groups(sources, texts):
    """Sequences of neighbouring sources, one per text, of about equal length."""
    sizes = [len(source.read_text()) for source in sources]
    whole, so_far, out = sum(sizes), 0, [[] for _ in range(texts)]
    for source, size in zip(sources, sizes):
        out[min(texts - 1, so_far * texts // whole)].append(source)
        so_far += size
    return [group for group in out if group]


def told(output, text, places):
    """clang-tidy's output with the sources' own names and lines."""
    for line in output.splitlines():
        finding = FINDING.match(line)
        if finding and finding["file"] == str(text):
            source, number = places[int(finding["line"]) - 1]
            line = f"{source.relative_to(TOP)}:{number}:{finding['rest']}"
        yield line


def main(tidy, build, texts, *names):
    options = [name for name in names if name.startswith("--")]
    sources = [pathlib.Path(name).resolve() for name in names if name not in options]
    failed = False
    with tempfile.TemporaryDirectory() as folder:
        running = []
        for i, group in enumerate(groups(sources, int(texts))):
            text = pathlib.Path(folder) / f"joined_{i}.cpp"
            content, places = join(group)
            text.write_text(content)
            command = [tidy, f"--config-file={TOP}/.clang-tidy", "--quiet", *options, str(text), "--",
                       *flags_of(pathlib.Path(build), group)]
            running.append((text, places, subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                                           text=True)))
        # Output is small and comes at the end: no pipe fills up.
        for text, places, process in running:
            out, err = process.communicate()
            for line in told(out, text, places):
                print(line)
            for line in err.splitlines():
                if process.returncode != 0 and not re.search(r"warnings? generated|treated as error", line):
                    print(line, file=sys.stderr)
            failed = failed or process.returncode != 0
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
