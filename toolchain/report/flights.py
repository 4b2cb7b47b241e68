# SPDX-License-Identifier: BSD-3-Clause
"""Recorded flights (jink-sim fly --record-steps) and the program that repeats them on a target (jink_step_probe)."""
import dataclasses
import struct

import targets

MAGIC = 0x4A535201
RECORD = struct.Struct("<IIqII")
ANSWER = struct.Struct("<16I5f")
DISCRETE = ("state", "faults", "control", "guidance", "kind", "plan_status", "plans", "chosen", "candidates", "manoeuvres",
            "work", "tracks", "obstacles")


@dataclasses.dataclass
class Step:
    """toolchain/sim/step_record.hpp"""

    start: int  # 0, or 1, or 2 for a start with the reduced reach sets; and 0x10000 times the clock [MHz], if any
    now_us: int
    bytes_in: bytes
    bytes_out: bytes  # in the recorded flight

    def pack(self):
        return RECORD.pack(MAGIC, self.start, self.now_us, len(self.bytes_in), len(self.bytes_out)) + self.bytes_in


@dataclasses.dataclass
class StepAnswer:
    discrete: tuple  # as DISCRETE names them
    stack_used: int
    velocity: tuple  # command [m/s]
    margin: float  # [m]
    cost: float  # of the chosen candidate in the last plan
    bytes_out: bytes
    instructions: int = 0
    by_stage: list = dataclasses.field(default_factory=list)

    def __getattr__(self, name):
        try:
            return self.discrete[DISCRETE.index(name)]
        except ValueError:
            raise AttributeError(name) from None


def read(path):
    """The steps of one flight."""
    data = path.read_bytes()
    steps, at = [], 0
    while at < len(data):
        magic, start, now, size_in, size_out = RECORD.unpack_from(data, at)
        if magic != MAGIC:
            raise ValueError(f"{path}: no step record at byte {at}")
        at += RECORD.size
        steps.append(Step(start, now, data[at:at + size_in], data[at + size_in:at + size_in + size_out]))
        at += size_in + size_out
    return steps


class StepProbe(targets.Probe):
    """jink_step_probe running on a target; steps must be requested in the order of their flight."""

    PROGRAM = "jink_step_probe"

    def ask(self, step):
        self.process.stdin.write(step.pack())
        self.process.stdin.flush()
        data = self.process.stdout.read(ANSWER.size)
        if len(data) < ANSWER.size:
            raise RuntimeError(f"{self.name}: ended with status {self.process.wait()} in the step at {step.now_us} us")
        magic, *numbers = ANSWER.unpack(data)
        if magic != MAGIC:
            raise RuntimeError(f"{self.name}: refuses the step at {step.now_us} us")
        stack, size = numbers[13:15]
        count, *stages = map(int, self.counts.readline().split()) if self.counts else (0,)
        return StepAnswer(tuple(numbers[:13]), stack, tuple(numbers[15:18]), numbers[18], numbers[19], self.process.stdout.read(size), count, stages)
