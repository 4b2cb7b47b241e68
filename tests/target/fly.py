# SPDX-License-Identifier: BSD-3-Clause
"""All scenarios against an image in an emulated board, beside the same flights in process: the same outcomes.

Usage: fly.py JINK_SIM BUILD_FOLDER IMAGE

Exit status 77 (skipped) where the image or the emulator is not there. Least separations may lie 0.5 m + 15 % apart, as
for jinkd (tests/scenario/daemon_test.cpp): in real time sightings and ticks meet in another phase.
"""
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile

MACHINES = {"mps2_an500": "mps2-an500", "stm32f405": "netduinoplus2"}
AT_ONCE = 6  # each board takes a quarter of a processor
ATTEMPTS = 2  # on a machine with other work one may come late


def fly(command, folder):
    subprocess.run(command + ["--out", folder, "--quiet"], check=False, stdout=subprocess.DEVNULL)
    with open(pathlib.Path(folder) / "run.json", encoding="utf-8") as file:
        return {flight["name"]: flight for flight in json.load(file)["flights"]}


def wrong(flight, inside):
    """What is wrong with a flight, or nothing."""
    if not flight["as_expected"]:
        return f"{flight['outcome']}: {'; '.join(flight['unmet'] + flight['faults'])}"
    if flight["outcome"] != inside["outcome"]:
        return f"{flight['outcome']}, {inside['outcome']} in process"
    here, there = flight["least"]["surface"], inside["least"]["surface"]
    if abs(here - there) > 0.5 + 0.15 * max(0.0, there):
        return f"least {here:.2f} m, {there:.2f} m in process"
    return None


def main(sim, build, image):
    elf = pathlib.Path(build) / "firmware" / image / f"{image}.elf"
    if not elf.exists() or not shutil.which("qemu-system-arm"):
        print(f"{elf} or qemu-system-arm is missing: skipped")
        return 77
    files = sorted(str(f) for f in pathlib.Path(__file__).resolve().parents[1].joinpath("scenario").glob("*.yaml"))
    with tempfile.TemporaryDirectory() as folder:
        inside = fly([sim, "fly", *files], folder)
    failed = files
    for attempt in range(ATTEMPTS):
        with tempfile.TemporaryDirectory() as folder:
            flights = fly([sim, "fly", *failed, "--image", str(elf), "--machine", MACHINES[image], "--at-once", str(AT_ONCE)], folder)
        again = []
        for name, flight in flights.items():
            fault = wrong(flight, inside[name])
            print(f"{name:24s} {flight['outcome']:10s} {flight['least']['surface']:7.2f} m, in process "
                  f"{inside[name]['least']['surface']:7.2f} m{'' if fault is None else '  WRONG: ' + fault}")
            if fault:
                again += [f for f in failed if pathlib.Path(f).stem == name]
        failed = again
        if not failed:
            return 0
        print(f"attempt {attempt + 1}: {len(failed)} not as expected")
    return 1


if __name__ == "__main__":
    if len(sys.argv) != 4:
        print(__doc__, file=sys.stderr)
        sys.exit(2)
    sys.exit(main(*sys.argv[1:]))
