# SPDX-License-Identifier: BSD-3-Clause
"""The stack that a flight image used in flights, against the bound of its call graph.

Usage: stack_check.py JINK_BOARD_STACK BUILD_FOLDER IMAGE

Exit status 77 (skipped) if the image or the emulator is missing.
"""
import concurrent.futures
import pathlib
import re
import shutil
import subprocess
import sys

import image_check
from fly import MACHINES

# Plans that fail, plans that succeed, obstacles by the dozen, rejoining.
SCENARIOS = ["wall", "scan_wall", "pillar", "scenario_2", "scenario_1_160_r10", "head_on"]


def main(program, build, image):
    elf = pathlib.Path(build) / "firmware" / image / f"{image}.elf"
    if not elf.exists() or not shutil.which("qemu-system-arm"):
        print(f"{elf} or qemu-system-arm is missing: skipped")
        return 77
    folder = pathlib.Path(__file__).resolve().parents[1] / "scenario"

    def used(name):
        run = subprocess.run([program, str(elf), MACHINES[image], str(folder / f"{name}.yaml")], capture_output=True, text=True)
        found = re.search(r"^stack (\d+)\nplan stack (\d+)$", run.stdout, re.M)
        print(f"{image}: {name}: {' '.join(run.stdout.split())}")
        return tuple(map(int, found.groups())) if found and run.returncode == 0 else None

    with concurrent.futures.ThreadPoolExecutor(len(SCENARIOS)) as pool:
        measured = list(pool.map(used, SCENARIOS))
    if None in measured:
        return 1
    most, bounds = list(map(max, zip(*measured))), image_check.stack_bounds(build)
    for name, used_most, bound in zip(("stack", "stack of a plan"), most, bounds):
        print(f"{image}: {name}: used in flight {used_most} bytes, bound by call graph {bound} bytes")
    return 0 if all(a <= b for a, b in zip(most, bounds)) else 1


if __name__ == "__main__":
    if len(sys.argv) != 4:
        print(__doc__, file=sys.stderr)
        sys.exit(2)
    sys.exit(main(*sys.argv[1:]))
