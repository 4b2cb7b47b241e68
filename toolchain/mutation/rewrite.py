# SPDX-License-Identifier: BSD-3-Clause
"""Rewrites the sources with every site as a call of mutation.hpp, so that one build holds all mutants."""


class Mutant:
    """key: names the mutant as long as the expression exists, on any line."""

    def __init__(self, number, site, change, line, expression, nth):
        self.number, self.site, self.change, self.line = number, site, change, line
        self.key = f"{site.file} | {site.function} | {expression} | {site.kind} -> {change} | {nth}"


def number_mutants(sites, texts):
    """Mutants in the order of the sources, numbered from 1; `site.first` is set to the first one's number."""
    mutants, seen = [], {}
    for site in sites:
        site.first = len(mutants) + 1
        text = texts[site.file]
        line = text.count(b"\n", 0, site.begin) + 1
        expression = " ".join(text[site.begin:site.end].decode().split())
        same = (site.file, site.function, expression, site.kind)
        seen[same] = seen.get(same, 0) + 1
        for change in site.mutants:
            mutants.append(Mutant(len(mutants) + 1, site, change, line, expression, seen[same]))
    return mutants


def rewritten(text, sites):
    """`text` (bytes) of a file with its sites as calls."""
    ordered = sorted(sites, key=lambda s: (s.begin, -s.end))

    def part(begin, end, inside):
        """Text from begin to end; `inside`: the sites in it, outer ones first."""
        out, at, i = [], begin, 0
        while i < len(inside):
            site = inside[i]
            j = i + 1
            while j < len(inside) and inside[j].begin < site.end:
                j += 1
            out.append(text[at:site.begin])
            out.append(call(site, inside[i + 1:j]))
            at, i = site.end, j
        out.append(text[at:end])
        return b"".join(out)

    def call(site, inside):
        operands = []
        for begin, end in site.operands:
            written = part(begin, end, [s for s in inside if begin <= s.begin and s.end <= end])
            operands.append(b"[&] { return static_cast<bool>(" + written + b"); }" if site.lazy else written)
        arguments = b", ".join(operands)
        if site.braces:
            arguments = b"{" + arguments + b"}"
        return b"::jink_mutation::%s<%d>(%s)" % (site.call.encode(), site.first, arguments)

    return part(0, len(text), ordered)


def write_if_new(path, data):
    """Keeps the time stamp of an unchanged file, so that only changes are built."""
    if not path.exists() or path.read_bytes() != data:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)


def write_trees(root, folders, sites, header, original):
    """The sources of `folders` below root with the sites rewritten, beside `header`, a copy of `original`."""
    out = header.parent
    by_file = {}
    for site in sites:
        by_file.setdefault(site.file, []).append(site)
    kept = set()
    for path in sorted(p for folder in folders for p in (root / folder).rglob("*")):
        if not path.is_file():
            continue
        name = path.relative_to(root)
        data = path.read_bytes()
        if str(name) in by_file:
            include = b'#include "%s"  // NOLINT\n#line 1 "%s"\n' % (header.name.encode(), str(path).encode())
            data = include + rewritten(data, by_file[str(name)])
        write_if_new(out / name, data)
        kept.add(out / name)
    for path in sorted(p for folder in folders for p in (out / folder).rglob("*")):
        if path.is_file() and path not in kept:
            path.unlink()
    write_if_new(header, original.read_bytes())
