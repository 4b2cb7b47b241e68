# SPDX-License-Identifier: BSD-3-Clause
"""The probe (tests/target) on each target: records in, answers and instruction counts out."""
import dataclasses
import os
import pathlib
import struct
import subprocess
import tempfile

MAGIC = 0x4A504205
TRACKS = 32
OBSTACLES = 96
HEADER = struct.Struct("<13I20f2I8f2I")
TRACK = struct.Struct("<10f")
OBSTACLE = struct.Struct("<I8f")
ANSWER = struct.Struct("<8I5fI")
KINDS = {"plan": 0, "update": 1, "info": 2, "reach": 3, "reciprocal": 4, "slices": 5}
STATUS = ["found", "no_conflict", "too_close", "none_available", "budget_spent", "bad_input", "running"]


@dataclasses.dataclass
class Case:
    """One case of tests/target/probe_record.hpp, in SI units."""

    seed: int
    kind: str = "plan"
    offsets: int = 4
    extra_planes: int = 3
    families: int = 3
    retries: int = 8
    bounds: int = 0
    reduced_sets: int = 0
    shared: int = 0  # bit i: track i is cooperative
    clock: int = 0  # of an update: its work is for this clock [MHz], in slices; 0: the default, at once
    updates: int = 1  # of an update: how many, 20 ms apart; the last one is counted
    methods: int = 0  # of an update: sum of 1 geometric, 2 reach sets, 4 reciprocal; 0: all
    own_position: tuple = (0.0, 0.0, 30.0)
    own_velocity: tuple = (5.0, 0.0, 0.0)
    own_sigma: float = 0.1
    leg_start: tuple = (0.0, 0.0, 30.0)
    leg_end: tuple = (100.0, 0.0, 30.0)
    leg_speed: float = 5.0
    half: tuple = (1.0, 1.0, 1.0)
    floor: float = 0.0
    ceiling: float = 120.0
    keep_in: float = 500.0
    waypoints: int = 25
    swept: int = 0
    lookahead: float = 8.0
    k_sigma: float = 3.0
    limits: tuple = (5.0, 3.0, 3.0, 5.0, 3.0, 0.25)  # cruise, climb, descent, acceleration, vertical acceleration, lag
    tracks: list = dataclasses.field(default_factory=list)  # (position, velocity, radius, sigma p, sigma v, acceleration)
    obstacles: list = dataclasses.field(default_factory=list)  # (kind, a, b, radius, yaw)

    def pack(self):
        out = HEADER.pack(MAGIC, self.seed, KINDS[self.kind], self.offsets, self.extra_planes, self.families, self.retries,
                          self.bounds, self.reduced_sets, self.shared, self.clock, self.updates, self.methods, *self.own_position, *self.own_velocity, self.own_sigma, *self.leg_start,
                          *self.leg_end, self.leg_speed, *self.half, self.floor, self.ceiling, self.keep_in,
                          self.waypoints, self.swept, self.lookahead, self.k_sigma, *self.limits, len(self.tracks), len(self.obstacles))
        for position, velocity, *rest in self.tracks:
            out += TRACK.pack(*position, *velocity, *rest)
        out += bytes(TRACK.size * (TRACKS - len(self.tracks)))
        for kind, a, b, radius, yaw in self.obstacles:
            out += OBSTACLE.pack(kind, *a, *b, radius, yaw)
        return out + bytes(OBSTACLE.size * (OBSTACLES - len(self.obstacles)))


@dataclasses.dataclass
class Answer:
    seed: int
    status: str
    candidates: int
    chosen: int
    work: int
    kind: int
    stack_used: int
    cost: float
    velocity: tuple
    margin: float
    cut_short: int
    instructions: int = 0
    by_stage: list = dataclasses.field(default_factory=list)  # in the order of the plugin's stages, if any


class Probe:
    """The probe running on a target, for any number of cases. Counts instructions if `plugin` is given."""

    PROGRAM = "jink_probe"

    def __init__(self, name, command, program, plugin=None, symbols="nm", stages=None):
        self.name = name
        self.folder = tempfile.TemporaryDirectory()
        self.counts = None
        if plugin:
            pipe = os.path.join(self.folder.name, "counts")
            os.mkfifo(pipe)
            begin, end = addresses(program, symbols, ["jink_window_begin", "jink_window_end"])
            told = f"{plugin},begin={begin:#x},end={end:#x},out={pipe}" + (f",stages={stages}" if stages else "")
            command = command[:1] + ["-plugin", told] + command[1:]
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        if plugin:
            self.counts = open(pipe, encoding="ascii")

    def ask(self, case):
        self.process.stdin.write(case.pack())
        self.process.stdin.flush()
        data = self.process.stdout.read(ANSWER.size)
        if len(data) < ANSWER.size:
            raise RuntimeError(f"{self.name}: ended with status {self.process.wait()} in case {case.seed}")
        magic, seed, status, candidates, chosen, work, kind, stack, cost, vx, vy, vz, margin, cut_short = ANSWER.unpack(data)
        if magic != MAGIC or seed != case.seed:
            raise RuntimeError(f"{self.name}: refuses case {case.seed}")
        count, *stages = map(int, self.counts.readline().split()) if self.counts and case.kind != "info" else (0,)
        return Answer(seed, STATUS[status], candidates, chosen, work, kind, stack, cost, (vx, vy, vz), margin, cut_short, count,
                      stages)

    def close(self):
        self.process.stdin.close()
        self.process.wait(timeout=10)
        self.folder.cleanup()


def addresses(program, nm, names):
    text = subprocess.run([nm, program], check=True, capture_output=True, text=True).stdout
    table = {line.split()[2]: int(line.split()[0], 16) for line in text.splitlines() if len(line.split()) == 3}
    return [table[name] for name in names]


def program_of(target, build, program="jink_probe"):
    bare = target in ("mps2_an500", "stm32f405")
    return pathlib.Path(build) / target / "tests" / "target" / (program + ".elf" if bare else program)


def is_there(target, build, kind=Probe):
    return os.sep in target or program_of(target, build, kind.PROGRAM).exists()


def bring_up_to_date(names, build):
    """Builds the presets `names` in their folders of `build`: what is recorded is what the present sources give."""
    for name in names:
        subprocess.run(["cmake", "--build", str(pathlib.Path(build) / name)], check=True, stdout=subprocess.DEVNULL)


def open_probe(target, build, plugin=None, stages=None, kind=Probe):
    """`target`: a preset's name, or a program's path; `build`: the folder that holds the presets' builds."""
    if os.sep in target:  # a program of this machine
        return kind("host", [target], target)
    program = program_of(target, build, kind.PROGRAM)
    if target in ("mps2_an500", "stm32f405"):
        machine = {"mps2_an500": "mps2-an500", "stm32f405": "netduinoplus2"}[target]
        command = ["qemu-system-arm", "-M", machine, "-display", "none", "-monitor", "none", "-serial", "null",
                   "-semihosting-config", "enable=on,target=native", "-kernel", str(program)]
    else:
        emulator = {"armhf": ["qemu-arm"], "aarch64": ["qemu-aarch64"]}.get(target, [])
        command = emulator + [str(program)]
    return kind(target, command, str(program), plugin, stages=stages)
