# SPDX-License-Identifier: BSD-3-Clause
"""Figures of a mutation run, and its two reference lists."""
import sys

RELATIONS = ("<", "<=", ">", ">=", "==", "!=")
KINDS = (*RELATIONS, "&&", "||", "!", "condition", "min max clamp", "unary -", "abs", "binary + -")
HEADER = """\
# SPDX-License-Identifier: BSD-3-Clause
# Mutants that no test tells apart, written by `toolchain/mutation/mutate --write-survivors`:
# file | function | expression | kind -> change | which of several alike
# A line after "above: " is a mutant that only tests of other rooms tell apart.
"""
ABOVE = "above: "


class Lists:
    """survivors.txt: mutants known to survive, and those that only tests of other modules kill. equivalent.txt: mutants
    that no test can detect, each line or group of lines followed by the reason, indented."""

    def __init__(self, folder):
        self.folder = folder
        lines = self._lines("survivors.txt")
        self.survivors = {line for line in lines if not line.startswith(ABOVE)}
        self.above = {line.removeprefix(ABOVE) for line in lines if line.startswith(ABOVE)}
        self.equivalent = {}
        keys = []
        for line in self._lines("equivalent.txt"):
            if line.startswith(" "):
                for key in keys:
                    self.equivalent[key] = (self.equivalent.get(key, "") + " " + line.strip()).strip()
            else:
                keys = keys + [line] if keys and keys[-1] not in self.equivalent else [line]
        unreasoned = [key for key in keys if key not in self.equivalent]
        if unreasoned:
            print(f"mutate: {folder / 'equivalent.txt'} gives no reason for {unreasoned[0]}", file=sys.stderr)
            sys.exit(2)

    def _lines(self, name):
        path = self.folder / name
        text = path.read_text() if path.exists() else ""
        return [line.rstrip() for line in text.splitlines() if line.strip() and not line.startswith("#")]


class Outcome:
    """Outcome of `mutants`, a subset of `all_mutants` of the sources in `folders`; the tests of `above` ran too."""

    def __init__(self, mutants, all_mutants, by_key, lists, folders, above):
        self.mutants, self.by_key, self.lists, self.folders = mutants, by_key, lists, set(folders)
        self.existing = {m.key for m in all_mutants}
        self.known = lists.survivors | set(lists.equivalent) | (set() if above else lists.above)
        self.surviving = [m for m in mutants if by_key[m.key]["how"] == "survived"]

    def _row(self, name, mutants):
        survivors = [m for m in mutants if self.by_key[m.key]["how"] == "survived"]
        equivalent = sum(m.key in self.lists.equivalent for m in survivors)
        killed, total = len(mutants) - len(survivors), len(mutants)
        share = 100.0 * killed / total
        without = 100.0 * killed / (total - equivalent) if total > equivalent else 100.0
        print(f"{name:34} {total:7} {killed:7} {share:6.1f} % {equivalent:10} {without:8.1f} %")

    def _table(self, title, groups):
        print(f"\n{title:34} {'mutants':>7} {'killed':>7} {'share':>8} {'equivalent':>10} {'of others':>10}")
        for name, mutants in groups:
            if mutants:
                self._row(name, mutants)

    def print(self):
        by = {}
        for m in self.mutants:
            by.setdefault((m.site.kind, m.change), []).append(m)
        relations = [m for m in self.mutants if m.site.kind in RELATIONS]
        self._table("operator and change", [(f"{kind} to {change}", by[kind, change]) for kind in KINDS
                                            for k, change in sorted(by) if k == kind])
        self._table("operator", [(kind, [m for m in self.mutants if m.site.kind == kind]) for kind in KINDS])
        files = sorted({m.site.file for m in self.mutants})
        self._table("file", [(file, [m for m in self.mutants if m.site.file == file]) for file in files])
        rooms = sorted({file.rsplit("/", 1)[0] for file in files})
        self._table("room", [(room, [m for m in self.mutants if m.site.file.rsplit("/", 1)[0] == room]) for room in rooms])
        self._table("all", [("comparisons (< <= > >= == !=)", relations), ("all", self.mutants)])
        how = [self.by_key[m.key]["how"] for m in self.mutants]
        print(f"\nkilled by a failing test {how.count('failed')}, a crash {how.count('crashed')}, a hang {how.count('hung')}")
        known = sum(m.key in self.known for m in self.surviving)
        print(f"survivors {len(self.surviving)}, of them listed {known}")
        for m in self.surviving:
            kind = ("equivalent" if m.key in self.lists.equivalent else
                    "listed" if m.key in self.known else "NOT LISTED")
            print(f"  {kind:10} {m.key}  (line {m.line})")
        for complaint in self.complaints():
            print(f"mutate: {complaint}", file=sys.stderr)

    def _is_mine(self, key):
        return key.partition(" | ")[0].rpartition("/")[0] in self.folders

    def complaints(self):
        """Survivors that are on no list; lines of the lists that were run and killed, or that are no mutants (any more)."""
        surviving = {m.key for m in self.surviving}
        out = [f"no test notices: {key}" for key in sorted(surviving - self.known)]
        run = {m.key for m in self.mutants}
        dead = (self.known - self.lists.above) & run - surviving
        out += [f"is listed and killed: {key} by {self.by_key[key]['by']}" for key in sorted(dead)]
        listed = self.known | self.lists.above
        mine = {key for key in listed if self._is_mine(key)}
        return out + [f"is listed and does not exist: {key}" for key in sorted(mine - self.existing)]

    def write_survivors(self):
        listed = [*self.lists.survivors, *(ABOVE + key for key in self.lists.above)]
        keys = sorted(line for line in listed if not self._is_mine(line.removeprefix(ABOVE)))
        keys += [m.key for m in self.surviving if m.key not in self.lists.equivalent]
        for m in self.mutants:
            killer = self.by_key[m.key]["by"].partition(".")[0]
            if killer and killer.partition("_")[2] != m.site.file.split("/")[1]:
                keys.append(ABOVE + m.key)
        self.lists.folder.mkdir(parents=True, exist_ok=True)
        (self.lists.folder / "survivors.txt").write_text(HEADER + "".join(f"{key}\n" for key in keys))
