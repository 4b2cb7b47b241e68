# SPDX-License-Identifier: BSD-3-Clause
"""The log that a flight image streams over its emulated line, received and read: jink_board_log of a scenario.

Usage: log_check.py JINK_BOARD_LOG BUILD_FOLDER IMAGE

Exit status 77 (skipped) if the image or the emulator is missing.
"""
import pathlib
import shutil
import subprocess
import sys

from fly import MACHINES

# The avoidance begins after 5 s.
SCENARIO, SECONDS = "head_on", 12


def main(program, build, image):
    elf = pathlib.Path(build) / "firmware" / image / f"{image}.elf"
    if not elf.exists() or not shutil.which("qemu-system-arm") or not shutil.which("arm-none-eabi-nm"):
        print(f"{elf}, qemu-system-arm or arm-none-eabi-nm is missing: skipped")
        return 77
    scenario = pathlib.Path(__file__).resolve().parents[1] / "scenario" / f"{SCENARIO}.yaml"
    return subprocess.run([program, str(elf), MACHINES[image], str(scenario), str(SECONDS)], check=False).returncode


if __name__ == "__main__":
    if len(sys.argv) != 4:
        print(__doc__, file=sys.stderr)
        sys.exit(2)
    sys.exit(main(*sys.argv[1:]))
