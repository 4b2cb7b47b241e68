# SPDX-License-Identifier: BSD-3-Clause
"""Recorded cases and their counts: kept in human-readable files, replayed exactly."""
import concurrent.futures
import dataclasses
import json
import pathlib
import re
import statistics
import struct
import subprocess
import tempfile

import flights
import scenes
import stages
import targets

TARGETS = ["mps2_an500", "stm32f405", "armhf", "aarch64"]
COMPILERS = {"mps2_an500": "arm-none-eabi-g++", "stm32f405": "arm-none-eabi-g++", "armhf": "arm-linux-gnueabihf-g++",
             "aarch64": "aarch64-linux-gnu-g++"}
STAGED = "mps2_an500"  # counted per stage; the other targets in total, which takes half the time
# core/base/work_budget.hpp: largest number of instructions per work unit.
MOST_PER_UNIT = 170
# The boards' clocks [MHz]: firmware/*/main.cpp (kRate, kClock). Their updates and steps are counted with the work of these.
CLOCKS = {"mps2_an500": 216, "stm32f405": 168}
REDUCED_SETS = ("stm32f405",)  # these fly the reduced reach sets
NOT_COUNTED = {"stm32h743": 400}  # images that no emulator runs, and their clocks [MHz] (kClock)
FASTER = 480  # of another Cortex-M7, which the same image runs on [MHz]
PER_DECADE = 20  # bins of a histogram; from 10^4 instructions on
DECADES = 4


def short(x):
    """Shortest decimal that gives the same single-precision number."""
    if isinstance(x, (list, tuple)):
        return [short(y) for y in x]
    if not isinstance(x, float):
        return x
    exact = struct.unpack("<f", struct.pack("<f", x))[0]
    for digits in range(1, 10):
        text = f"{exact:.{digits}g}"
        if struct.unpack("<f", struct.pack("<f", float(text)))[0] == exact:
            return float(text)
    return exact


def board(target):
    """Options of jink-sim for flights with a board's work and reach sets."""
    return [*(["--clock", str(CLOCKS[target])] if target in CLOCKS else []), *(["--reduced-sets"] if target in REDUCED_SETS else [])]


def on_board(case, target):
    """The case as the target's image does it: an update has the board's work, and plans go on over several updates."""
    return dataclasses.replace(case, clock=CLOCKS.get(target, 0)) if case.kind == "update" else case


def write_case(path, scene, found, how):
    fields = {f.name: short(getattr(found.case, f.name)) for f in dataclasses.fields(targets.Case)}
    record = {"scene": scene, "how": how, "case": fields}
    text = json.dumps(record, indent=1)
    pathlib.Path(path).write_text(_compact(text) + "\n", encoding="utf-8")


def compact_json(kept):
    """Indented, with the innermost lists on one line."""
    def lines(value, depth):
        if isinstance(value, dict) and any(isinstance(v, (dict, list)) for v in value.values()):
            inner = ",\n".join(f"{' ' * (depth + 1)}{json.dumps(k)}: {lines(v, depth + 1)}" for k, v in value.items())
            return "{\n" + inner + "\n" + " " * depth + "}"
        if isinstance(value, list) and any(isinstance(v, dict) for v in value):
            return "[\n" + ",\n".join(" " * (depth + 1) + json.dumps(v) for v in value) + "\n" + " " * depth + "]"
        return json.dumps(value)
    return lines(kept, 0) + "\n"


def _compact(text):
    """Lists of numbers on one line."""
    out, depth = [], 0
    for line in text.splitlines():
        inner = line.strip()
        if depth:
            out[-1] += inner if inner[0] in "]" else (" " if out[-1][-1] == "," else "") + inner
        else:
            out.append(line)
        if inner.endswith("[") and ("\"tracks\"" not in inner and "\"obstacles\"" not in inner or depth):
            depth += 1
        elif depth and inner[0] == "]":
            depth -= 1
    return "\n".join(out)


def read_case(path):
    record = json.loads(pathlib.Path(path).read_text(encoding="utf-8"))
    values = {k: tuple(tuple(y) if isinstance(y, list) else y for y in v) if isinstance(v, list) else v
              for k, v in record["case"].items()}
    for name in ("tracks", "obstacles"):
        values[name] = [tuple(tuple(y) if isinstance(y, list) else y for y in item) for item in record["case"][name]]
    return record, targets.Case(**values)


def compiler(target):
    """Version of the installed compiler for a target."""
    try:
        return subprocess.run([COMPILERS[target], "-dumpfullversion"], check=True, capture_output=True, text=True).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        return "none"


def emulator():
    return subprocess.run(["qemu-system-arm", "--version"], check=True, capture_output=True, text=True).stdout.splitlines()[0]


def distribution(counts):
    ordered = sorted(counts)
    bins = [0] * (PER_DECADE * DECADES)
    for count in counts:
        i = 0
        while i + 1 < len(bins) and count >= 10 ** (4 + (i + 1) / PER_DECADE):
            i += 1
        bins[i] += 1
    return {"cases": len(counts), "least": ordered[0], "median": ordered[len(counts) // 2], "mean": round(statistics.mean(counts)),
            "p99": ordered[-1 - len(counts) // 100], "most": ordered[-1], "most_seed": counts.index(ordered[-1]), "bins": bins}


class Bench:
    """Everything that is recorded, counted on the targets."""

    def __init__(self, build, plugin, folder, sim):
        self.build, self.plugin, self.folder, self.sim = build, plugin, pathlib.Path(folder), sim
        self.files = sorted(self.folder.glob("*.*.json"))

    def one(self, target, case, stage_file=None):
        """Always in a fresh probe: counts must not depend on earlier counts."""
        probe = targets.open_probe(target, self.build, self.plugin, stage_file)
        answer = probe.ask(on_board(case, target))
        probe.close()
        return answer

    def steps(self, target, scene, crowd, stage_file=None):
        """The answers to all steps of a crowd, flown with the methods of a scene and the work of a target."""
        with tempfile.TemporaryDirectory() as folder:
            # The ending of a crowd is irrelevant here.
            subprocess.run([self.sim, "crowd", "--seed", str(crowd), "--count", "1", "--set", f"JNK_METHODS={scenes.CROWDS[scene]}", *board(target),
                            "--record-steps", folder, "--quiet"], check=False, stdout=subprocess.DEVNULL)
            probe = targets.open_probe(target, self.build, self.plugin, stage_file, kind=flights.StepProbe)
            answers = [probe.ask(step) for step in flights.read(pathlib.Path(folder) / f"crowd_{crowd}.steps")]
            probe.close()
        return answers

    def step(self, target, record, stage_file=None):
        """The most expensive step of the crowd that a record names, and its number."""
        answers = self.steps(target, record["scene"], record["crowd"], stage_file)
        return max(((a, i) for i, a in enumerate(answers)), key=lambda item: item[0].instructions)

    def fly(self, folder, target):
        """Flies the scenarios whose steps are counted, in process with the work of a target, and writes the line's traffic to `folder`."""
        scenario = pathlib.Path(__file__).resolve().parents[2] / "tests/scenario"
        files = [str(scenario / f"{name}.yaml") for name in scenes.FLIGHTS]
        subprocess.run([self.sim, "fly", *files, *board(target), "--record-steps", folder, "--quiet"], check=True, stdout=subprocess.DEVNULL)

    def _records(self, target, result, stage_files):
        for path in self.files:
            record = json.loads(path.read_text(encoding="utf-8"))
            if "case" in record:
                answer = self.one(target, read_case(path)[1], stage_files[0])
                status = answer.status
            elif target in (record["target"], *(t for t in TARGETS if t not in CLOCKS)):
                answer, number = self.step(target, record, stage_files[1])
                status = f"step {number}: {answer.tracks} tracks, {answer.obstacles} obstacles"
            else:  # the crowd of another board, whose flight is another one
                continue
            result["records"][path.stem] = {"instructions": answer.instructions, "status": status, "work": answer.work}
            if answer.by_stage:
                result["stages"][path.stem] = {n: c for n, c in zip(stages.NAMES, answer.by_stage) if c}

    def _sample(self, name, answers, result):
        counts = len(answers)
        result["typical"][name] = distribution([a.instructions for a in answers])
        # Instructions that the work budget does not count, or counts too low: excess over the largest number per work
        # unit.
        result["typical"][name]["uncounted"] = max(0, *(a.instructions - MOST_PER_UNIT * a.work for a in answers))
        if not answers[0].by_stage:
            return
        sums = [sum(c) for c in zip(*(a.by_stage for a in answers))]
        result["typical_stages"][name] = {n: round(c / counts) for n, c in zip(stages.NAMES, sums) if c >= counts}

    def of_target(self, target):
        result = {"records": {}, "stages": {}, "typical": {}, "typical_stages": {}}
        with tempfile.TemporaryDirectory() as folder, tempfile.TemporaryDirectory() as flown:
            self.fly(flown, target)
            stage_files = [str(pathlib.Path(folder) / name) for name in ("plan", "step")]
            if target == STAGED:
                stages.write(targets.program_of(target, self.build), target, stage_files[0])
                stages.write(targets.program_of(target, self.build, flights.StepProbe.PROGRAM), target, stage_files[1])
            else:
                stage_files = [None, None]
            self._records(target, result, stage_files)
            for name, (_, count, case_of) in scenes.SAMPLES.items():
                probe = targets.open_probe(target, self.build, self.plugin, stage_files[0])
                self._sample(name, [probe.ask(on_board(case_of(seed), target)) for seed in range(count)], result)
                probe.close()
            probe = targets.open_probe(target, self.build, self.plugin, stage_files[1], kind=flights.StepProbe)
            flown_steps = [probe.ask(step) for flight in scenes.FLIGHTS for step in flights.read(pathlib.Path(flown) / f"{flight}.steps")]
            probe.close()
            for name, answers in zip(scenes.STEPS, (flown_steps, self.steps(target, "step_full", scenes.CROWD, stage_files[1]))):
                self._sample(name, answers, result)
        return result

    def all(self, names):
        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            return dict(zip(names, pool.map(self.of_target, names)))

    def _assigned(self, target, name, write):
        """The answer to a record, its instructions assigned to code as `write` does (stages.py), and what that returns."""
        with tempfile.TemporaryDirectory() as folder:
            file = str(pathlib.Path(folder) / "assigned")
            path = self.folder / f"{name}.json"
            record = json.loads(path.read_text(encoding="utf-8"))
            kind = targets.Probe if "case" in record else flights.StepProbe
            names = write(targets.program_of(target, self.build, kind.PROGRAM), target, file)
            return self.one(target, read_case(path)[1], file) if "case" in record else self.step(target, record, file)[0], names

    def by_function(self, target, name, most=15):
        """The functions that a record executes most instructions in, their own alone: [name, instructions], and the rest."""
        answer, names = self._assigned(target, name, stages.write_functions)
        first = sorted(zip(answer.by_stage, names), reverse=True)[:most]
        rows = [[name, count] for count, name in first if name]
        return [*rows, ["all others", answer.instructions - sum(count for _, count in rows)]]

    def by_stage(self, target, name):
        """{stage: instructions} of a record."""
        answer, _ = self._assigned(target, name, stages.write)
        return {n: c for n, c in zip(stages.NAMES, answer.by_stage) if c}

    def flags(self, target):
        """The compiler's options for core, without paths, warnings and what only reports."""
        commands = json.loads((pathlib.Path(self.build) / target / "compile_commands.json").read_text(encoding="utf-8"))
        words = next(c["command"] for c in commands if "/jink_core.dir/" in c["command"]).split()
        kept = [w for w in words if re.match(r"-(m|f|O|std|g|DJINK|DEIGEN|DNDEBUG)", w) and not re.match(r"-f(stack-usage|callgraph)", w)]
        return " ".join(sorted(set(kept), key=kept.index))

    def sheet(self, target, worst):
        """What the sheet of a board says beside the counts: the record `worst` by function, flags, interrupts, loops of a plan."""
        import bound_loops
        import memory_sizes
        return {"record": worst, "functions": self.by_function(target, worst), "stages": self.by_stage(target, worst), "flags": self.flags(target),
                "interrupts": bound_loops.interrupts(memory_sizes.image_of(self.build, target)),
                "loops": bound_loops.loops_of_plan(targets.program_of(target, self.build), "plan_16_3")}

    def rates(self):
        """{clock [MHz]: instructions of a tick, work units of a step, and of those of its slice} (firmware/app/work_rate.hpp)."""
        clocks = sorted({*CLOCKS.values(), *NOT_COUNTED.values(), FASTER})
        lines = subprocess.run([self.sim, "rates", *map(str, clocks)], check=True, capture_output=True, text=True).stdout.splitlines()
        return {line.split()[0]: dict(zip(("instructions", "units", "slice"), map(int, line.split()[1:]))) for line in lines}

    def hunt_steps(self, target, scene, seeds, workers, by_price=False):
        """The most expensive step of many crowds, or the one of the dearest units: (its answer, crowd, step), and the number of all steps."""
        def of_crowd(seed):
            answers = self.steps(target, scene, seed)
            return max((by_weight(a, by_price), seed, i, a) for i, a in enumerate(answers)), len(answers)
        with concurrent.futures.ThreadPoolExecutor(workers) as pool:
            found = list(pool.map(of_crowd, seeds))
        _, crowd, step, answer = max(most for most, _ in found)
        return (answer, crowd, step), sum(count for _, count in found)


def by_weight(answer, by_price):
    """What hunts look for: instructions; by price thousandths of them per work unit, of which there are counted 1000 at least."""
    return 1000 * answer.instructions // max(answer.work, 1000) if by_price else answer.instructions


def write_crowd(folder, scene, target, crowd, how):
    path = pathlib.Path(folder) / f"{scene}.{target}.json"
    path.write_text(json.dumps({"scene": scene, "how": how, "target": target, "crowd": crowd}, indent=1) + "\n", encoding="utf-8")
    return path


def note_hunt(folder, scene, target, evaluations, command, answer):
    """Keeps of each scene and target the hunt with most evaluations, whether it beat the record or not, and what its costliest case took."""
    path = pathlib.Path(folder) / "hunts.json"
    kept = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
    name = f"{scene}.{target}"
    if evaluations >= kept.get(name, {}).get("evaluations", 0):
        kept[name] = {"evaluations": evaluations, "most": answer.instructions, "work": answer.work, "command": command}
        path.write_text(compact_json(dict(sorted(kept.items()))), encoding="utf-8")
