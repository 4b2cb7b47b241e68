# SPDX-License-Identifier: BSD-3-Clause
"""Plans in random slices against the same plans in one piece, on each target: the same to the last bit.

Usage: same_slices.py BUILD_FOLDER PROBLEMS SLICINGS TARGET ...

BUILD_FOLDER holds one build per preset. The first slicing of a problem pauses at every piece of work. Problems have up to 6
tracks and 3 obstacles, any set of methods, and on a third of them a budget that ends most plans.
"""
import collections
import pathlib
import random
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "toolchain" / "report"))
import cases  # noqa: E402
import targets  # noqa: E402


def problem(seed, slicings):
    case = cases.random_case(seed, "slices", tracks=1 + seed % 6, obstacles=(seed // 6) % 4, offsets=2 + 2 * (seed % 2))
    r = random.Random(seed)
    case.methods = r.randint(1, 7)
    case.shared = r.getrandbits(6)
    case.reduced_sets = 1
    case.updates = slicings
    return case


def main(build, count, slicings, names):
    missing = [name for name in names if not targets.is_there(name, build)]
    if missing:
        print(f"not built: {', '.join(missing)}: skipped")
        return 77
    wrong = 0
    for name in names:
        probe = targets.open_probe(name, build)
        status, slices = collections.Counter(), 0
        for seed in range(count):
            answer = probe.ask(problem(seed, slicings))
            status[answer.status] += 1
            slices += answer.candidates
            if answer.chosen:
                wrong += 1
                print(f"problem {seed} on {probe.name}: {answer.chosen} of {slicings} slicings differ: {answer}")
        probe.close()
        print(f"{count} problems on {probe.name}, {slicings} slicings each, {slices} pauses: "
              f"{', '.join(f'{n} {what}' for what, n in status.most_common())}; {wrong} with a slicing that differs")
        if status["found"] < count // 4 or slices < 10 * count * slicings:
            print("too few plans found, or too few pauses")
            wrong += 1
    return 1 if wrong else 0


if __name__ == "__main__":
    if len(sys.argv) < 5:
        print(__doc__, file=sys.stderr)
        sys.exit(2)
    sys.exit(main(sys.argv[1], int(sys.argv[2]), int(sys.argv[3]), sys.argv[4:]))
