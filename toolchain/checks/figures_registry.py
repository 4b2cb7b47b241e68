# SPDX-License-Identifier: BSD-3-Clause
"""docs/figures.toml: the command that prints each figure of each page."""
import fractions
import re
import tomllib

FILE = "docs/figures.toml"
KINDS = ("quick", "long", "record", "not_run")
LEAST_DATED = 3  # minutes: shorter commands are run again instead


class Wrong(Exception):
    """The registry contradicts itself; the text says how."""


def refuse_unknown(what, where, known):
    for key in what:
        if key not in known:
            raise Wrong(f"{where}: no key is called {key}")


class Figure:
    """The place of figures on a page, and in the output."""

    def __init__(self, of, page, entry):
        refuse_unknown(entry, f"{of}, a figure", ("page", "text", "printed", "json", "scale", "under", "each", "block", "nth"))
        self.of, self.page = of, entry.get("page", page)
        self.text = entry.get("text")  # {} matches a figure, {*} anything on the line
        self.block = entry.get("block")  # an output in a fenced block that begins with this text: compared line by line
        self.printed = entry.get("printed")
        self.json = [entry["json"]] if isinstance(entry.get("json"), str) else entry.get("json")
        self.under = entry.get("under")
        self.each, self.nth = entry.get("each", False), entry.get("nth", 0)
        scale = entry.get("scale", "1")
        self.scale = [fractions.Fraction(str(s)) for s in (scale if isinstance(scale, list) else [scale])]
        if (self.text is None) == (self.block is None) or self.page is None:
            raise Wrong(f"{of}: a figure has a page and either text or block: {entry}")
        if self.text is not None and (self.printed is None) == (self.json is None):
            raise Wrong(f"{of}: {self.text}: either printed or json says where the figure comes from")
        if self.text is not None and self.printed is not None:
            groups, places = re.compile(self.printed).groups, self.text.count("{}")
            if groups != places or not places:
                raise Wrong(f"{of}: {self.text}: {places} figures on the page, {groups} in the output")
        if self.json and len(self.json) != self.text.count("{}"):
            raise Wrong(f"{of}: {self.text}: {len(self.json)} values for {self.text.count('{}')} figures")

    @property
    def key(self):
        under = f"{self.under}: " if self.under else ""
        nth = f" ({self.nth})" if self.nth else ""
        return f"{self.page}: {under}{self.text if self.block is None else 'block ' + self.block}{nth}"

    def scale_of(self, index):
        return self.scale[index % len(self.scale)]


def expanded(globs, groups):
    return [g for glob in globs for g in (groups[glob[1:]] if glob.startswith("@") else [glob])]


class Witness:
    """A quick command whose whole output is compared: equal outputs mean equal decisions of two source states."""
    kind, name, status, in_tree = "witness", "witness", [0], False

    def __init__(self, entry, groups):
        refuse_unknown(entry, "witness", ("run", "sources"))
        self.run, self.sources = entry["run"], expanded(entry["sources"], groups)


class Command:
    def __init__(self, name, entry, groups):
        refuse_unknown(entry, name, ("name", "kind", "pages", "as_written", "run", "seconds", "figures", "sources", "reason", "record", "render", "stamp",
                                     "dated", "commit", "minutes", "in_tree", "status", "witnessed", "witnessed_but"))
        self.name, self.kind = name, entry.get("kind")
        if self.kind not in KINDS:
            raise Wrong(f"{name}: kind is one of {', '.join(KINDS)}")
        written = entry.get("as_written", [])
        self.as_written = [written] if isinstance(written, str) else written
        self.pages = entry.get("pages", [])
        self.run = entry.get("run") or "\n".join(self.as_written)
        self.reason, self.record, self.render, self.stamp = (entry.get(k) for k in ("reason", "record", "render", "stamp"))
        self.in_tree = entry.get("in_tree", False)  # the command writes into the tree: not run in a folder of its own
        self.status = entry.get("status", [0])  # exit statuses that count as success
        self.dated, self.commit, self.minutes = entry.get("dated", False), entry.get("commit"), entry.get("minutes", 0)
        self.sources = expanded(entry.get("sources", []), groups)
        self.witnessed = entry.get("witnessed", False)  # stays valid if the sources have changed but the witness has
                                                        # not
        self.witnessed_but = entry.get("witnessed_but", [])  # names of digests that say nothing about this command
        self.figures = [Figure(name, self.pages[0] if self.pages else None, f) for f in entry.get("figures", [])]
        if self.kind == "not_run" and not self.reason:
            raise Wrong(f"{name}: says not why it is not run")
        if self.kind in ("long", "record") and not self.sources:
            raise Wrong(f"{name}: says not which sources decide its figures")
        if self.kind == "record" and not self.record:
            raise Wrong(f"{name}: says not where its record is")
        if self.witnessed and (self.kind != "long" or self.dated):
            raise Wrong(f"{name}: witnessed is for long commands that are not dated")
        if self.dated and (self.kind != "long" or not self.commit or self.minutes <= LEAST_DATED):
            raise Wrong(f"{name}: dated is for long commands of more than {LEAST_DATED} minutes, with the commit that they ran on")

    @property
    def has_figures(self):
        return self.kind == "record" or bool(self.figures)


class Registry:
    def __init__(self, top):
        self.top = top
        with open(top / FILE, "rb") as file:
            data = tomllib.load(file)
        refuse_unknown(data, FILE, ("pages", "programs", "sources", "command", "witness"))
        self.programs = data["programs"]
        self.pages = sorted({p.relative_to(top).as_posix() for glob in data["pages"] for p in top.glob(glob)})
        self.commands = {}
        self.witness = Witness(data["witness"], data["sources"]) if "witness" in data else None
        for entry in data["command"]:
            if entry["name"] in self.commands:
                raise Wrong(f"{entry['name']} stands in {FILE} twice")
            self.commands[entry["name"]] = Command(entry["name"], entry, data["sources"])
        if self.witness is None and any(c.witnessed for c in self.commands.values()):
            raise Wrong("a command is witnessed, but there is no witness")
        keys = [(c.name, f.key) for c in self.commands.values() for f in c.figures]
        for key in {k for k in keys if keys.count(k) > 1}:
            raise Wrong(f"{key[0]}: {key[1]} stands there twice")
