# SPDX-License-Identifier: BSD-3-Clause
"""Deepest stack of a bare-metal image, from the compiler's call graphs (-fcallgraph-info=su).

Usage: stack.py BUILD_FOLDER [ENTRY]

Refuses recursion, frames whose size is not fixed, and calls through pointers that INDIRECT does not explain. Functions of
the C library have no figure of their own and count LIBRARY bytes each.
"""
import pathlib
import re
import subprocess
import sys

NODE = re.compile(r'node: \{ title: "([^"]+)" label: "([^"]*)"')
EDGE = re.compile(r'edge: \{ sourcename: "([^"]+)" targetname: "([^"]+)"')
# A constructor with two names appears to call itself.
CONSTRUCTOR = re.compile(r"C[12]E")
BYTES = re.compile(r"\\n(\d+) bytes \(([^)]+)\)")
# sinf, cosf, memcpy and the like, measured by painting the stack: an upper bound.
LIBRARY = 200
# Functions that a pointer can reach, by the mangled name of the caller.
INDIRECT = [
    (r"12StateMachine12plan_at_once", []),  # an image plans in slices
    (r"10SlicedPlan3run", [r"10Supervisor.*7ask_all"]),
    (r"12StateMachine(12plan_a_slice|9plan_runs|5renew|11find_faster|9drop_plan|9configure|5reset|6update)|10SlicedPlan(5begin|7advance|4drop|4runs|4wait)", [r"N4jink3app9FiberFlow(5begin|6resume|5pause|4drop)"]),
    (r"9WorkSlice4take", [r"10SlicedPlan4wait"]),
    (r"3hal5Fiber4main|jink_fiber_main", [r"10SlicedPlan3run"]),
    (r"^(ccdGJK|ccdMPR|__ccd|discoverPortal|refinePortal|findPenetr|portal|expand|cst|simplex|doSimplex)", [r"support"]),
    (r"3app(11Coprocessor|6Intake|8OwnState|6Outbox|7Picture|16AutopilotControl|13ParamExchange|9Telemetry)",
     [r"link7mavlink8Endpoint", r"9CmsdkUartI", r"5UsartI", r"13CmsdkWatchdogI", r"19IndependentWatchdogI", r"15GuardedWatchdogI", r"3app6CanBus"]),
    (r"3app6CanBus", [r"5BxCanI"]),
    (r"link7mavlink8Endpoint", []),  # consumers of points: none on an image
    (r"3app10ParamFlash", [r"7stm32(f4|h7)5FlashI"]),
    # Raters of cells, ways past obstacles, sensors that look around: none on an image.
    (r"5reach7Planner(4look|7try_set|4plan)|5avoid(7cost_of|.*9lost_from)|3app8Decision", []),
    (r"8dronecan4Node", [r"12ParamService"]),
    (r"jink_reset_handler", [r"_GLOBAL__sub_I"]),
    (r"MemorySerialLink|MemoryLine|memory", []),
]

# Of classes that not every image uses.
LEFT_OUT = r"3app(6CanBus|10ParamFlash)"


def objects(build):
    """The objects that the image of a build is made of: none of other images, none that an earlier set-up has left."""
    folder = pathlib.Path(build).resolve()
    image = f"firmware/{folder.name}/{folder.name}.elf"
    made_of = subprocess.run(["ninja", "-C", str(folder), "-t", "inputs", image], check=True, capture_output=True, text=True).stdout
    return sorted(folder / line for line in made_of.splitlines() if line.endswith(".obj"))


class Graph:
    def __init__(self, build, skip="tests/"):
        self.frames = {}
        self.calls = {}
        self.names = {}
        mine = [file for file in objects(build) if not file.relative_to(pathlib.Path(build).resolve()).as_posix().startswith(skip)]
        self.problems = [f"{file}: no call graph beside it" for file in mine if not file.with_suffix(".ci").exists()]
        for file in (file.with_suffix(".ci") for file in mine if file.with_suffix(".ci").exists()):
            text = file.read_text(encoding="utf-8")
            for title, label in NODE.findall(text):
                title = self.unique(title)
                found = BYTES.search(label)
                if found:
                    self.frames[title] = max(self.frames.get(title, 0), int(found[1]))
                    self.names[title] = label.split("\\n")[0]
                    if found[2] not in ("static", "dynamic,bounded"):
                        self.problems.append(f"{label.split(chr(92))[0]}: {found[2]} frame")
            for pair in EDGE.findall(text):
                source, target = map(self.unique, pair)
                if source != target or not CONSTRUCTOR.search(source):
                    self.calls.setdefault(source, set()).add(target)

    @staticmethod
    def unique(title):
        """Functions of one file only are named with their file in front by the compiler."""
        return title.split(":")[-1] if ":" in title else title

    def targets(self, function):
        for target in sorted(self.calls.get(function, ())):
            if target != "__indirect_call":
                yield target
                continue
            for caller, patterns in INDIRECT:
                if re.search(caller, function):
                    found = {pattern: [f for f in sorted(self.frames) if re.search(pattern, f)] for pattern in patterns}
                    if patterns and not any(found.values()) and not re.search(LEFT_OUT, function):
                        self.problems.append(f"{self.names.get(function, function)}: a call through a pointer to nobody who is there")
                    for each in found.values():
                        yield from each
                    break
            else:
                self.problems.append(f"{self.names.get(function, function)}: a call through a pointer to nobody knows whom")

    def deepest(self, entry):
        """(bytes, chain of functions); a recursion counts as a problem."""
        done = {}
        on_way = []

        def visit(function):
            if function in done:
                return done[function]
            if function in on_way:
                self.problems.append("recursion: " + " -> ".join(on_way[on_way.index(function):] + [function]))
                return 0, []
            on_way.append(function)
            best, chain = 0, []
            for target in self.targets(function):
                depth, below = visit(target)
                if depth > best:
                    best, chain = depth, below
            on_way.pop()
            own = self.frames.get(function, LIBRARY)
            done[function] = (own + best, [(function, own)] + chain)
            return done[function]

        sys.setrecursionlimit(10000)
        return visit(entry)


def main(build, entry="jink_main"):
    graph = Graph(build)
    depth, chain = graph.deepest(entry)
    for function, own in chain:
        print(f"{own:6d}  {graph.names.get(function, function)}")
    print(f"{depth:6d}  bytes in all")
    for problem in sorted(set(graph.problems)):
        print("not bounded: " + problem)
    return 1 if graph.problems else 0


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3):
        print(__doc__, file=sys.stderr)
        sys.exit(2)
    sys.exit(main(*sys.argv[1:]))
