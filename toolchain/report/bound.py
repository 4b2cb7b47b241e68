# SPDX-License-Identifier: BSD-3-Clause
"""A bound on a function's instructions, from its code: no instruction executes more often than its loops iterate.

For each function of the program: the most expensive path through its code, loop code multiplied by its iterations, each
call with the bound of the called function. Iteration counts come from bound_loops.py, by the source line of the loop. A
loop without an entry there, a recursion, or a call or jump with an unknown target makes the bound fail. The bound
contains no measurement.
"""
import re
import subprocess

import stack

LINE = re.compile(r"^ *([0-9a-f]+):\t([^\t]+)(?:\t(.*))?$")
SYMBOL = re.compile(r"^([0-9a-f]+) <(.+)>:$")
TARGET = re.compile(r"\b([0-9a-f]+) <([^>]+)>")
CONDITIONS = "eq|ne|cs|hs|cc|lo|mi|pl|vs|vc|hi|ls|ge|lt|gt|le"
BRANCH = re.compile(rf"^b({CONDITIONS})?(\.[nw])?$")
COMPARE = re.compile(r"^cbn?z(\.n)?$")
RETURN = re.compile(rf"^(bx|pop|ldm\w*|ldr)({CONDITIONS})?(\.[nw])?$")


class Refused(Exception):
    pass


class Function:
    def __init__(self, name, code, data):
        self.name, self.code, self.data = name, code, data  # code: {address: (mnemonic, operands)} in order; data: {address: byte}
        self.addresses = list(code)
        self.calls = []  # (address, name of the called function, or None through a pointer)
        self.after = {}
        for i, address in enumerate(self.addresses):
            following = self.addresses[i + 1:i + 2]
            self.after[address] = self._successors(address, following)

    def _successors(self, address, following):
        mnemonic, operands = self.code[address]
        target = TARGET.search(operands or "")
        branch = BRANCH.match(mnemonic)
        if branch or COMPARE.match(mnemonic):
            to = int(target[1], 16)
            on = following if COMPARE.match(mnemonic) or branch[1] else []
            if to in self.code:
                return on + [to]
            self.calls.append((address, target[2].split("+")[0]))  # a tail call
            return on
        if mnemonic.startswith(("bl", "blx")) and not branch:
            self.calls.append((address, target[2].split("+")[0] if target else None))
            return following
        if mnemonic in ("tbb", "tbh"):
            return self._table(address, 2 if mnemonic == "tbh" else 1)
        if mnemonic.startswith("udf"):
            return []
        returns = RETURN.match(mnemonic)
        if returns and ((returns[1] == "bx" and "lr" in operands) or re.search(r"\bpc\b(?!,)", operands.split("[")[0]) or
                        (returns[1] == "ldr" and operands.startswith("pc,"))):
            if returns[1] == "ldr" and "sp" not in operands:
                raise Refused(f"{self.name}: {mnemonic} {operands}")
            return following if returns[2] else []
        if returns and returns[1] == "bx":  # a tail call through a pointer
            self.calls.append((address, None))
            return []
        if re.search(r"\bpc\b", operands.split(",")[0]):
            raise Refused(f"{self.name}: {mnemonic} {operands}")
        return following

    def _table(self, address, size):
        """Targets of a table of jumps that follows its jump (4 bytes long)."""
        targets, at = set(), address + 4
        while at in self.data:
            entry = sum(self.data.get(at + i, 0) << (8 * i) for i in range(size))
            targets.add(address + 4 + 2 * entry)
            at += size
        known = sorted(t for t in targets if t in self.code)  # padding bytes are no targets
        if not known:
            raise Refused(f"{self.name}: a table of jumps that cannot be read")
        return known


def components(nodes, after):
    """Strongly connected components of a part of a graph (Tarjan), without recursion."""
    index, low, stack_, on, found = {}, {}, [], set(), []
    for root in nodes:
        if root in index:
            continue
        work = [(root, iter(after(root)))]
        index[root] = low[root] = len(index)
        stack_.append(root)
        on.add(root)
        while work:
            node, rest = work[-1]
            for following in rest:
                if following not in nodes:
                    continue
                if following not in index:
                    index[following] = low[following] = len(index)
                    stack_.append(following)
                    on.add(following)
                    work.append((following, iter(after(following))))
                    break
                if following in on:
                    low[node] = min(low[node], index[following])
            else:
                work.pop()
                if work:
                    low[work[-1][0]] = min(low[work[-1][0]], low[node])
                if low[node] == index[node]:
                    part = set()
                    while True:
                        member = stack_.pop()
                        on.discard(member)
                        part.add(member)
                        if member == node:
                            break
                    found.append(part)
    return found


class Costs:
    """The most expensive path through a function.

    Branches: the costlier side. A loop is a component of the graph, entered at one place or at several (where the compiler
    has threaded jumps). A turn passes each entry once at most; between two passages the way leads through what is left
    of the component without the ways into its entries, where the loops inside are found in the same manner.
    `turns(function, places)` gives ("each", n) turns each time a loop is entered, or ("in all", n) in one call of the
    function, by the places that jump back; a turn is a body begun. Where every jump back can leave instead, the test is at
    the end and the entry is passed once a turn, else once more for the test that fails. What lies behind a place in `ends`
    alone is never reached.
    """

    def __init__(self, function, cost, turns, ends=()):
        self.function, self.cost, self.turns, self.ends, self.in_all = function, cost, turns, ends, 0
        self.before = {n: [] for n in function.addresses}
        for node, following in function.after.items():
            for n in following:
                self.before[n].append(node)

    def whole(self):
        entry = self.function.addresses[0]
        reached, work = {entry}, [entry]
        while work:
            node = work.pop()
            for following in () if node in self.ends else self.function.after[node]:
                if following not in reached:
                    reached.add(following)
                    work.append(following)
        return self.way(reached, frozenset(), {entry}) + self.in_all

    def way(self, nodes, cut, starts):
        """From any of `starts` on, inside `nodes`, without edges into `cut`."""
        def after(node):
            return [n for n in self.function.after[node] if n not in cut and n in nodes]
        best = {}
        for part in components(nodes, after):  # what follows comes first
            node = next(iter(part))
            looping = len(part) > 1 or node in after(node)
            here = self.loop(part, nodes, cut, after) if looping else self.cost(node)
            onward = max((best[n] for p in part for n in after(p) if n not in part), default=0)
            for p in part:
                best[p] = here + onward
        return max(best[s] for s in starts)

    def loop(self, part, nodes, cut, after):
        first = self.function.addresses[0]
        entries = {n for n in part if n not in cut and (n == first or any(p not in part for p in self.before[n] if p in nodes))}
        entries |= {n for n in part if n in cut}  # where a turn of the loop around begins
        entries = entries or {min(part)}
        back = [p for p in part if any(n in entries for n in after(p))]
        how, count = self.turns(self.function, back)
        if count == 0:
            return len(part)
        at_end = all(any(n not in part for n in self.function.after[p]) for p in back)
        passed = (count + (0 if at_end else 1)) * len(entries)
        turn = self.way(part, cut | entries, entries)
        if how == "each":
            return passed * turn
        self.in_all += passed * turn
        return 0


def read(program, prefix):
    """{function: ({address: instruction}, {address: byte of data})}"""
    text = subprocess.run([prefix + "objdump", "-d", "--no-show-raw-insn", "-z", program], check=True, capture_output=True, text=True).stdout
    functions, code, data = {}, {}, {}
    sizes = {".word": 4, ".short": 2, ".byte": 1}
    for line in text.splitlines():
        start = SYMBOL.match(line)
        if start:
            code, data = functions.setdefault(start[2], ({}, {}))
            continue
        m = LINE.match(line)
        if m and m[2] in sizes:
            for i in range(sizes[m[2]]):
                data[int(m[1], 16) + i] = int(m[3].split()[0], 16) >> (8 * i) & 0xFF
        elif m:
            code[int(m[1], 16)] = (m[2].strip(), re.split(r"\s*[@;]", m[3] or "")[0])
    return functions


class Bound:
    def __init__(self, program, prefix, turns, never=(), library=(), indirect=stack.INDIRECT):
        self.raw, self.turns, self.indirect = read(program, prefix), turns, indirect
        self.never, self.library = never, library
        self.done, self.on_way, self.problems = {}, [], []

    def called_from(self, function, name):
        if name is not None:
            return [name]
        for caller, patterns in self.indirect:
            if re.search(caller, function):
                return [f for f in self.raw if any(re.search(p, f) for p in patterns)]
        raise Refused(f"{function}: a call through a pointer to nobody knows whom")

    def of(self, name):
        """The bound of a function, calls included."""
        if name in self.done:
            return self.done[name]
        if any(re.search(p, name) for p in self.never):
            return 0
        for pattern, most in self.library:
            if re.search(pattern, name):
                return most
        if name in self.on_way:
            raise Refused("recursion: " + " -> ".join(self.on_way + [name]))
        if name not in self.raw:
            raise Refused(f"{name}: no code")
        self.on_way.append(name)
        try:
            function = Function(name, *self.raw[name])
            calls, ends = {}, set()
            for address, callee in function.calls:
                if callee is not None and any(re.search(p, callee) for p in self.never):
                    ends.add(address)
                calls[address] = calls.get(address, 0) + max((self.of(c) for c in self.called_from(name, callee)), default=0)
            total = Costs(function, lambda address: 1 + calls.get(address, 0), self.turns, ends).whole()
        except Refused as refusal:
            self.problems.append(str(refusal))
            total = 0  # reported among the problems: there is no bound then
        self.on_way.pop()
        self.done[name] = total
        return total
