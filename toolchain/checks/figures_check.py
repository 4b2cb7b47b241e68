# SPDX-License-Identifier: BSD-3-Clause
"""Compares pages, registry and lock; reports errors by page and line."""
import dataclasses
import difflib
import hashlib
import json
import pathlib
import sys

import figures_digest
import figures_pages as pages
import figures_registry
import figures_run

LOCK = "docs/figures.lock.json"
RECORD = "toolchain/checks/figures --record {}"


@dataclasses.dataclass
class Problem:
    text: str
    page: str = ""
    line: int = 0
    sealed: bool = False  # of a sealed number, which --seal accepts

    def __str__(self):
        return (f"{self.page}:{self.line}: " if self.line else f"{self.page}: " if self.page else "") + self.text


class Lock:
    """The recorded outputs with their dates, and the sealed numbers of each page."""

    def __init__(self, top):
        self.path = top / LOCK
        kept = json.loads(self.path.read_text(encoding="utf-8")) if self.path.exists() else {}
        self.commands, self.seals = kept.get("commands", {}), kept.get("seals", {})
        self.witness = kept.get("witness", {})  # digest of its sources, commit, and its output

    def write(self):
        def block(mapping):
            return ",\n".join(f"  {json.dumps(key)}: " + inner(mapping[key]) for key in sorted(mapping))

        def inner(value):
            if isinstance(value, dict) and "values" in value:
                head = {k: v for k, v in value.items() if k != "values"}
                values = ",\n".join(f"    {json.dumps(k, ensure_ascii=False)}: {json.dumps(v, ensure_ascii=False)}" for k, v in value["values"].items())
                return "{" + "".join(f"{json.dumps(k)}: {json.dumps(v)}, " for k, v in head.items()) + '"values": {\n' + values + "}}"
            return "[\n" + ",\n".join(f"   {json.dumps(line, ensure_ascii=False)}" for line in value) + "]"

        witness = f" \"witness\": {json.dumps(self.witness, indent=1)},\n" if self.witness else ""
        text = "{\n" + witness + " \"commands\": {\n" + block(self.commands) + "},\n \"seals\": {\n" + block(self.seals) + "}}\n"
        new = self.path.with_suffix(".new")
        new.write_text(text, encoding="utf-8")
        new.replace(self.path)


class Book:
    """The pages with their registry and their lock."""

    def __init__(self, top):
        self.top = pathlib.Path(top)
        self.registry = figures_registry.Registry(self.top)
        self.lock = Lock(self.top)
        self.pages = {name: pages.Page(name, (self.top / name).read_text(encoding="utf-8")) for name in self.registry.pages}
        self.found = {}  # (command, figure's key): places on the page
        self.problems, self.digests = [], {}
        self._find()

    def digest(self, command):
        globs = tuple(command.sources)
        if globs not in self.digests:
            self.digests[globs] = figures_digest.of_sources(self.top, globs)
        return self.digests[globs]

    def _find(self):
        for command in self.registry.commands.values():
            for figure in command.figures:
                if figure.page not in self.pages:
                    raise figures_registry.Wrong(f"{command.name}: {figure.page} is no page")
                places, complaint = pages.find(self.pages[figure.page], figure)
                if complaint:
                    self.problems.append(Problem(f"{complaint.partition(': ')[2]} (figure of {command.name})", figure.page))
                self.found[command.name, figure.key] = places

    def covered(self, name):
        return [span for (command, key), places in self.found.items() for f in self.registry.commands[command].figures
                if f.key == key and f.page == name for place in places for span in place]

    # --- recorded and printed figures

    def state(self, command):
        """fresh, as before, stale, never, dated or quick; quick ones are never stale, because they are run"""
        if command.kind == "record":
            try:
                record = json.loads((self.top / command.record).read_text(encoding="utf-8"))
                kept = figures_run.at(record, command.stamp or "sources")
            except (KeyError, IndexError, OSError):
                return "never"
        elif command.name not in self.lock.commands:
            return "never"
        else:
            kept = self.lock.commands[command.name].get("digest")
        if command.kind == "quick":
            return "quick"
        if command.dated:
            return "dated" if self.lock.commands[command.name].get("commit") == command.commit else "stale"
        if kept == self.digest(command):
            return "fresh"
        return "as before" if command.witnessed and self.lock.commands[command.name].get("witness") == self.witness_of(command) is not None else "stale"

    def witness_of(self, command):
        """Digest of the witness's outputs relevant to a command, if it was run on these sources; else None."""
        of = self.registry.witness
        if of is None or self.lock.witness.get("digest") != self.digest(of):
            return None
        told = [line for line in self.lock.witness["printed"] if line.rpartition(": ")[0] not in command.witnessed_but]
        return hashlib.sha256("\n".join(told).encode()).hexdigest()[:24]

    def evidence(self, any_age=False):
        """any_age: accepts figures that were recorded on other code, or never"""
        for command in self.registry.commands.values():
            if not command.has_figures:
                continue
            state = self.state(command)
            again = RECORD.format(command.name)
            page = command.pages[0] if command.pages else ""
            if state == "never":
                if not any_age:
                    yield Problem(f"{command.name}: never recorded: run {again}", page)
                if command.kind != "record":
                    continue
            if state == "stale" and not any_age:
                yield Problem(f"{command.name}: recorded on other code: run {again}", page)
            if state == "dated":
                for name in {f.page for f in command.figures}:
                    if f"commit {command.commit}" not in " ".join(self.pages[name].text.split()):
                        yield Problem(f"{command.name}: the page does not say that it was recorded on commit {command.commit}", name)
            if command.render:
                yield from self.rendered(command)
            yield from self.compare(command, self.recorded(command))

    def recorded(self, command):
        if command.kind == "record":
            return {f.key: figures_run.values_of_record(f, self.top, command) for f in command.figures}
        return self.lock.commands[command.name]["values"]

    def rendered(self, command):
        """The generated part of a page, and the text from its record."""
        sys.path.insert(0, str(self.top / "toolchain/report"))
        module = __import__(command.render)
        record = json.loads((self.top / command.record).read_text(encoding="utf-8"))
        page = self.pages[command.pages[0]]
        found = pages.GENERATED.search(page.text)
        text = module.generated(record)
        if not found or found[0] != text:
            old, new = (found[0] if found else "").splitlines(), text.splitlines()
            line = next((i for i, (a, b) in enumerate(zip(old, new)) if a != b), min(len(old), len(new)))
            yield Problem(f"stands \"{old[line] if line < len(old) else ''}\", {command.record} gives \"{new[line] if line < len(new) else ''}\" ({command.name})",
                          page.name, page.line(found.start()) + line if found else 1)

    def compare(self, command, values):
        for figure in command.figures:
            places = self.found[command.name, figure.key]
            page = self.pages[figure.page]
            if not places:
                continue
            printed = values.get(figure.key)
            if printed is None:
                yield Problem(f"{command.name}: \"{figure.key}\" was never recorded: run {RECORD.format(command.name)}", figure.page)
            elif figure.block is not None:
                begin, end = places[0][0]
                there = page.text[begin:end].splitlines()
                for i in range(max(len(there), len(printed))):
                    a, b = (x[i].rstrip() if i < len(x) else "" for x in (there, printed))
                    if a != b:
                        yield Problem(f"stands \"{a}\", printed is \"{b}\" ({command.name})", page.name, page.line(begin) + i)
            else:
                yield from self.compare_numbers(command, figure, page, [s for place in places for s in place], printed)

    def compare_numbers(self, command, figure, page, spans, printed):
        if len(spans) != len(printed):
            yield Problem(f"{len(spans)} figures stand, {len(printed)} are printed: \"{figure.text}\" ({command.name})", page.name, page.line(spans[0][0]))
            return
        for i, ((begin, end), value) in enumerate(zip(spans, printed)):
            token = page.text[begin:end]
            if not pages.agrees(token, value, figure.scale_of(i)):
                yield Problem(f"stands {token}, printed is {value}: \"{figure.text}\" ({command.name})", page.name, page.line(begin))

    def put(self, command, values):
        """Writes the printed figures into the pages; yields the changes."""
        for name in sorted({f.page for f in command.figures}):
            changes, page = [], self.pages[name]
            for figure in (f for f in command.figures if f.page == name and values.get(f.key) is not None):
                spans = [s for place in self.found[command.name, figure.key] for s in place]
                if figure.block is not None:
                    changes += [(s, "".join(line + "\n" for line in values[figure.key])) for s in spans]
                elif len(spans) == len(values[figure.key]):
                    for i, (span, value) in enumerate(zip(spans, values[figure.key])):
                        token = page.text[slice(*span)]
                        if not pages.agrees(token, value, figure.scale_of(i)):
                            changes.append((span, pages.written(token, value, figure.scale_of(i))))
            text = page.text
            for (begin, end), new in sorted(changes, reverse=True):
                if text[begin:end] != new:
                    yield f"{name}:{page.line(begin)}: {text[begin:end].strip()} -> {new.strip()}"
                    text = text[:begin] + new + text[end:]
            if text != page.text:
                (self.top / name).write_text(text, encoding="utf-8")
                self.pages[name] = pages.Page(name, text)
        self.problems = []
        self._find()

    # --- commands

    def commands(self):
        known = {pages.plain(line): c for c in self.registry.commands.values() for line in c.as_written}
        given = set()
        for page in self.pages.values():
            for command, line in pages.commands(page, self.registry.programs):
                given.add((page.name, command))
                begins = [k for k in known if k.endswith(" *") and command.startswith(k[:-1])]
                given.update((page.name, k) for k in begins)
                if command not in known and not begins:
                    yield Problem(f"docs/figures.toml does not know the command: {command}", page.name, line)
        flat = {name: " ".join(page.text.split()) for name, page in self.pages.items()}
        for command in self.registry.commands.values():
            for line in command.as_written:
                for name in command.pages:
                    if name not in flat:
                        yield Problem(f"{command.name}: is no page", name)
                    elif pages.plain(line) not in flat[name] and (name, pages.plain(line)) not in given:
                        yield Problem(f"{command.name}: the page does not give the command: {line}", name)

    # --- sealed numbers

    def seals(self):
        for name, page in self.pages.items():
            if name not in self.lock.seals:
                yield Problem(f"its numbers were never sealed: run toolchain/checks/figures --seal {name}", name)
                continue
            there = pages.tokens(page, self.covered(name))
            kept = [t for line in self.lock.seals.get(name, []) for t in line.split()]
            for old, new, line in changes(kept, there, page):
                yield Problem(f"a number was changed: {old or 'nothing'} was sealed, {new or 'nothing'} stands", name, line, True)

    def seal(self, name):
        page = self.pages[name]
        rows = {}
        for token, line in pages.tokens(page, self.covered(name)):
            rows.setdefault(line, []).append(token)
        self.lock.seals[name] = [" ".join(row) for row in rows.values()]

    def all(self, any_age=False):
        return [*self.problems, *self.evidence(any_age), *self.commands(), *self.seals()]


def changes(kept, there, page):
    """(old token, new token, line)"""
    now = [t for t, _ in there]
    last = page.line(len(page.text) - 1) if page.text else 1
    for kind, a, b, c, d in difflib.SequenceMatcher(None, kept, now, autojunk=False).get_opcodes():
        if kind == "equal":
            continue
        for i in range(max(b - a, d - c)):
            line = there[min(c + i, len(there) - 1)][1] if there else last
            yield (kept[a + i] if a + i < b else ""), (now[c + i] if c + i < d else ""), line
