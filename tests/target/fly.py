# SPDX-License-Identifier: BSD-3-Clause
"""All scenarios against an image on an emulated board: each ends as its file expects, and within the envelope of the
same flights in process with many phases of ticks and line (toolchain/sim/envelope.hpp).

Usage: fly.py JINK_SIM BUILD_FOLDER IMAGE

Exit status 77 (skipped) if the image or the emulator is missing.
"""
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

MACHINES = {"mps2_an500": "mps2-an500", "stm32f405": "netduinoplus2"}
# Scenarios that need an input which images lack.
NO_INPUT = re.compile(r"^lidar:", re.M)
AT_ONCE = 6  # each board takes a quarter of a processor


def main(sim, build, image):
    elf = pathlib.Path(build) / "firmware" / image / f"{image}.elf"
    if not elf.exists() or not shutil.which("qemu-system-arm"):
        print(f"{elf} or qemu-system-arm is missing: skipped")
        return 77
    files = sorted(str(f) for f in pathlib.Path(__file__).resolve().parents[1].joinpath("scenario").glob("*.yaml")
                   if not NO_INPUT.search(f.read_text(encoding="utf-8")))
    with tempfile.TemporaryDirectory() as folder:
        run = subprocess.run([sim, "fly", *files, "--image", str(elf), "--machine", MACHINES[image], "--at-once", str(AT_ONCE),
                              "--within-phases", "--out", folder, "--quiet"], check=False)
        with open(pathlib.Path(folder) / "run.json", encoding="utf-8") as file:
            flights = json.load(file)["flights"]
    for flight in flights:
        fault = "; ".join(flight["unmet"] + flight["faults"])
        surface = flight["least"]["surface"]  # None where the only threats are closed areas: they have no surface to keep from
        least = "      -" if surface is None else f"{surface:7.2f} m"
        print(f"{flight['name']:24s} {flight['outcome']:10s} {least}{'  WRONG: ' + fault if fault else ''}")
    return 0 if run.returncode == 0 and len(flights) == len(files) else 1


if __name__ == "__main__":
    if len(sys.argv) != 4:
        print(__doc__, file=sys.stderr)
        sys.exit(2)
    sys.exit(main(*sys.argv[1:]))
