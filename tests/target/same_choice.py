# SPDX-License-Identifier: BSD-3-Clause
"""The same planning problems on every target: the choice must be the same, costs and velocities may differ by rounding.

Usage: same_choice.py BUILD_FOLDER COUNT [TARGET ...]

BUILD_FOLDER holds one build per preset. The first target is the reference. A choice that differs is accepted, and
counted, only as a tie (both targets' costs of their choices within TIE of each other); where it is what the reference
chooses too when the own state is disturbed by as much as rounding does (a trajectory of a reach set that only just
touches something is left out as a whole); and on a target with doubles in software where solids that go through libccd are near and work has ended a plan (core/base/work_units.hpp).
"""
import collections
import copy
import math
import pathlib
import random
import re
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "toolchain" / "report"))
import cases  # noqa: E402
import targets  # noqa: E402

TIE = 1e-4
SOFT_DOUBLES = ("stm32f405",)
# ProbeShape: box, capsule (one that leans and overlaps the start), cylinder.
THROUGH_LIBCCD = (1, 2, 3)
KINDS = ("plan", "plan", "reach", "plan", "update", "reciprocal")
SAME_VELOCITY = 1e-3  # [m/s], of a decision that is a velocity
REDUCED_ONLY = ("stm32f405",)
CLOCK = 168  # of every second update [MHz]: the work of the slowest board, in slices, on every target
DISTURBED = 32
ROUNDINGS = 4 * 2.0**-24
SETTINGS = pathlib.Path(__file__).resolve().parents[2] / "core/avoid/settings.hpp"
PLAN_BUDGET = int(re.search(r"\bplan_budget = (\d+);", SETTINGS.read_text(encoding="utf-8"))[1])


def ran_out(probe, case, *answers):
    """Whether the budget ended a plan on the target or the reference, which weight libccd's doubles differently."""
    return (probe.name in SOFT_DOUBLES and any(a.cut_short or a.work >= PLAN_BUDGET for a in answers) and
            any(obstacle[0] in THROUGH_LIBCCD for obstacle in case.obstacles))


def case_of(seed):
    kind = KINDS[seed % len(KINDS)]
    case = cases.random_case(seed, kind, tracks=1 + seed % 6, obstacles=(seed // 6) % 4, offsets=2 + 2 * (seed % 2))
    if kind == "reciprocal":
        case.shared = random.Random(seed).getrandbits(6)
    case.clock = CLOCK if kind == "update" and seed // len(KINDS) % 2 else 0
    case.reduced_sets = int(seed // len(KINDS) % 2 == 0)
    return case


def is_comparable(probe, case):
    """An image without memory for the large sets always flies the reduced sets."""
    return case.kind in ("plan", "reciprocal") or case.reduced_sets or probe.name not in REDUCED_ONLY


def disturbed(case):
    """The case with the own position and velocity a few roundings away."""
    r = random.Random(case.seed)
    for _ in range(DISTURBED):
        other = copy.deepcopy(case)
        other.own_position = tuple(x + r.uniform(-1.0, 1.0) * ROUNDINGS * max(abs(x), 1.0) for x in case.own_position)
        other.own_velocity = tuple(x + r.uniform(-1.0, 1.0) * ROUNDINGS * max(abs(x), 1.0) for x in case.own_velocity)
        yield other


def choice(answer):
    return answer.status, answer.kind, answer.chosen


def is_same(case, a, b):
    if case.kind == "reciprocal":  # chooses a velocity, no candidate
        return a.status == b.status and (a.status != "found" or math.dist(a.velocity, b.velocity) <= SAME_VELOCITY)
    return choice(a) == choice(b)


def main(build, count, names):
    missing = [name for name in names if not targets.is_there(name, build)]
    if missing:
        print(f"not built: {', '.join(missing)}: skipped")
        return 77
    probes = [targets.open_probe(name, build) for name in names]
    names = [probe.name for probe in probes]
    ties, differing, largest, found, spent, unsteady = 0, [], 0.0, collections.Counter(), 0, 0
    for seed in range(count):
        case = case_of(seed)
        asked = [probe for probe in probes if is_comparable(probe, case)]
        answers = [probe.ask(case) for probe in asked]
        reference = answers[0]
        found[case.kind] += reference.status == "found"
        for probe, answer in zip(asked[1:], answers[1:]):
            difference = abs(answer.cost - reference.cost)
            if is_same(case, answer, reference):
                largest = max(largest, difference)
                continue
            if ran_out(probe, case, answer, reference):
                spent += 1
                continue
            largest = max(largest, difference)
            if case.kind != "reciprocal" and answer.status == reference.status == "found" and difference <= TIE:
                ties += 1
            elif any(is_same(case, probes[0].ask(other), answer) for other in disturbed(case)):
                unsteady += 1
            else:
                differing.append(f"case {seed} on {probe.name}: {answer} against {reference}")
    for probe in probes:
        probe.close()
    print(f"{count} problems on {', '.join(names)}: found on {names[0]}: {', '.join(f'{n} of {kind}' for kind, n in sorted(found.items()))}; largest difference of costs {largest:.3g}; "
          f"{ties} ties within {TIE:g} chosen otherwise, {unsteady} as the reference does after a disturbance by rounding; {spent} where doubles in software have spent the budget; {len(differing)} others chosen otherwise")
    print("\n".join(differing[:20]))
    return 1 if differing else 0


if __name__ == "__main__":
    if len(sys.argv) < 5:
        print(__doc__, file=sys.stderr)
        sys.exit(2)
    sys.exit(main(sys.argv[1], int(sys.argv[2]), sys.argv[3:]))
