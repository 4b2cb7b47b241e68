# SPDX-License-Identifier: BSD-3-Clause
"""Scenarios against an image on an emulated board: each ends as its file expects, and within the envelope of the same
flights in process with the board's work and many phases of ticks and line (toolchain/sim/envelope.hpp).

The STM32F405 flies its reduced reach sets, flights in process the full ones: another way of the same cost may lead to the
other side. A flight that says that it is by reach sets is held to the promise there, and to all of the envelope but the
least separation.

Usage: fly.py JINK_SIM BUILD_FOLDER IMAGE [all]

The scenarios of BOTH_BOARDS fly on every board, every second one of the others on one of the boards, in turn. With `all`:
all scenarios (toolchain/long_forms boards). same_flight.py compares the decisions of all scenarios on all boards.

Exit status 77 (skipped) if the image or the emulator is missing.
"""
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "toolchain" / "report"))
import records  # noqa: E402

MACHINES = {"mps2_an500": "mps2-an500", "stm32f405": "netduinoplus2"}
# Scenarios that need an input which images lack.
NO_INPUT = re.compile(r"^lidar:", re.M)
# Where boards differ: clock, line and restart, reduced reach sets, scans; and the most threats at once.
BOTH_BOARDS = ("autopilot_reboots", "cable_pulled", "clock_jumps", "four_converging", "head_on", "reach_sets_head_on",
               "scan_wall")
AT_ONCE = 8  # each board takes a quarter of a processor


def flown_by(image, names):
    """Those of all scenarios' names that fly on this image."""
    alone = [name for name in names if name not in BOTH_BOARDS][::2]
    own = set(alone[sorted(MACHINES).index(image)::len(MACHINES)])
    return [name for name in names if name in own or name in BOTH_BOARDS]


def main(sim, build, image, extent=""):
    elf = pathlib.Path(build) / "firmware" / image / f"{image}.elf"
    if not elf.exists() or not shutil.which("qemu-system-arm"):
        print(f"{elf} or qemu-system-arm is missing: skipped")
        return 77
    folder = pathlib.Path(__file__).resolve().parents[1] / "scenario"
    names = sorted(f.stem for f in folder.glob("*.yaml") if not NO_INPUT.search(f.read_text(encoding="utf-8")))
    files = [str(folder / f"{name}.yaml") for name in (names if extent == "all" else flown_by(image, names))]
    with tempfile.TemporaryDirectory() as folder:
        run = subprocess.run([sim, "fly", *files, "--image", str(elf), "--machine", MACHINES[image], "--at-once", str(AT_ONCE),
                              "--within-phases", *records.board(image), "--out", folder, "--quiet"], check=False)
        with open(pathlib.Path(folder) / "run.json", encoding="utf-8") as file:
            flights = json.load(file)["flights"]
    good = len(flights) == len(files) and run.returncode in (0, 1)
    for flight in flights:
        fault = "; ".join(flight["unmet"] + flight["faults"])
        good = good and not fault
        surface = flight["least"]["surface"]  # None where the only threats are closed areas: they have no surface to keep from
        least = "      -" if surface is None else f"{surface:7.2f} m"
        print(f"{flight['name']:24s} {flight['outcome']:10s} {least}{'  WRONG: ' + fault if fault else ''}")
    return 0 if good else 1


if __name__ == "__main__":
    if len(sys.argv) not in (4, 5) or sys.argv[4:] not in ([], ["all"]):
        print(__doc__, file=sys.stderr)
        sys.exit(2)
    sys.exit(main(*sys.argv[1:]))
