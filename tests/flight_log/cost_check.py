#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What the flight log and the live page cost the control loop, in instructions of a step.

    cost_check.py [--flights N] [--crowded] [--limit MODE=PERCENT ...] PROGRAM

PROGRAM is flight_log_cost. valgrind (callgrind) counts the instructions of the same flights without a log, with a log,
with a live page, and with both; the difference is the cost. --crowded: flights among many obstacles and tracks. Instruction counts do not depend on the machine's load.
Exit status 1: a cost is above its limit; 77: valgrind is not installed. Python 3 standard library only.
"""
import argparse
import re
import shutil
import subprocess
import sys

MODES = {"none": "no log", "log": "log", "page": "live page", "both": "log and live page"}


def count(valgrind, program, mode, flights, crowded):
    """(instructions below counted_step, steps)"""
    ran = subprocess.run([valgrind, "--tool=callgrind", "--callgrind-out-file=/dev/null", "--toggle-collect=*counted_step*", program, mode, str(flights), *(["crowded"] if crowded else [])],
                         capture_output=True, text=True, check=False)
    collected = re.search(r"Collected : (\d+)", ran.stderr)
    steps = re.search(r"(\d+) steps", ran.stdout)
    if ran.returncode != 0 or not collected or not steps:
        sys.exit(f"cost_check: {mode}: exit status {ran.returncode}\n{ran.stdout}{ran.stderr}")
    return int(collected.group(1)), int(steps.group(1))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--flights", type=int, default=3)
    parser.add_argument("--crowded", action="store_true")
    parser.add_argument("--limit", action="append", default=[], metavar="MODE=PERCENT")
    parser.add_argument("program")
    arguments = parser.parse_args()
    limits = {mode: float(percent) for mode, percent in (limit.split("=") for limit in arguments.limit)}
    if unknown := limits.keys() - MODES.keys():
        parser.error(f"no such mode: {', '.join(sorted(unknown))}")
    valgrind = shutil.which("valgrind")
    if valgrind is None:
        print("valgrind is not installed: skipped")
        return 77
    plain, steps = count(valgrind, arguments.program, "none", arguments.flights, arguments.crowded)
    print(f"{steps} steps of {plain / steps:.0f} instructions without a log")
    status = 0
    for mode in ("log", "page", "both"):
        with_it, same_steps = count(valgrind, arguments.program, mode, arguments.flights, arguments.crowded)
        if same_steps != steps:
            sys.exit(f"cost_check: {mode}: {same_steps} steps, {steps} without: these are other flights")
        percent = 100.0 * (with_it - plain) / plain
        print(f"{MODES[mode]}: {(with_it - plain) / steps:.0f} instructions of a step, {percent:.2f} %")
        if percent <= 0.0 or percent > limits.get(mode, 100.0):
            print(f"FAILED: {MODES[mode]}: {percent:.2f} %, expected above 0 and at most {limits.get(mode, 100.0):.2f} %")
            status = 1
    return status


if __name__ == "__main__":
    sys.exit(main())
