# SPDX-License-Identifier: BSD-3-Clause
"""Repeats every scenario's flight on every target from its recorded line: the same decisions step by step.

Usage: same_flight.py JINK_SIM BUILD_FOLDER TARGET ...

The flights are flown in process and recorded. The first target (the host program), armhf and aarch64 (SAME_BYTES) must
write identical bytes. On images, which have another C library, every state, fault, plan, chosen candidate and work
count must be equal in every step; commands and margins may differ by rounding (TOLERANCE), and the largest difference
is printed.

Each board is compared with a flight of its work and its reach sets (RUNS). Flights without an input on images (fly.py)
are excluded.

If two candidates' costs are equal within TIE, as left and right of a wall straight ahead, rounding may decide. Such a
choice is counted, and the flight is not compared further on that target, since later steps follow the other choice.
"""
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "toolchain" / "report"))
import flights  # noqa: E402
from fly import NO_INPUT  # noqa: E402
import targets  # noqa: E402

TOLERANCE = 1e-3  # [m/s], [m]
TIE = 1e-4  # of costs, as for same_choice.py
SAME_BYTES = ("armhf", "aarch64")
# Options of the flights, and who is compared there. Plans go on over several steps: as many as the board's clock [MHz] makes.
RUNS = ((["--clock", "168"], ("armhf", "aarch64")), (["--clock", "216"], ("mps2_an500",)), (["--clock", "168", "--reduced-sets"], ("stm32f405",)))
FOUND = targets.STATUS.index("found")


class Comparison:
    def __init__(self, name):
        self.name, self.differing, self.velocity, self.margin, self.same_bytes = name, [], 0.0, 0.0, 0
        self.ties, self.left, self.steps = [], None, 0

    @staticmethod
    def is_tie(answer, reference):
        return (answer.plan_status == reference.plan_status == FOUND and answer.plans == reference.plans and
                answer.chosen != reference.chosen and abs(answer.cost - reference.cost) <= TIE)

    def add(self, flight, where, answer, reference):
        if self.left == flight:
            return
        if self.is_tie(answer, reference):
            self.left = flight
            self.ties.append(f"{where} on {self.name}: candidate {answer.chosen} at {answer.cost:.6f}, {reference.chosen} at "
                             f"{reference.cost:.6f}")
            return
        self.steps += 1
        self.velocity = max(self.velocity, *(abs(a - b) for a, b in zip(answer.velocity, reference.velocity)))
        self.margin = max(self.margin, abs(answer.margin - reference.margin))
        self.same_bytes += answer.bytes_out == reference.bytes_out
        if answer.discrete != reference.discrete or len(answer.bytes_out) != len(reference.bytes_out):
            other = [f"{name} {a} against {b}" for name, a, b in
                     zip(flights.DISCRETE, answer.discrete, reference.discrete) if a != b]
            self.differing.append(f"{where} on {self.name}: {', '.join(other) or 'another number of bytes'}")
        elif self.name in SAME_BYTES and answer.bytes_out != reference.bytes_out:
            self.differing.append(f"{where} on {self.name}: other bytes")


def record(sim, options, folder):
    files = sorted(str(f) for f in pathlib.Path(__file__).resolve().parents[1].joinpath("scenario").glob("*.yaml")
                   if not NO_INPUT.search(f.read_text(encoding="utf-8")))
    subprocess.run([sim, "fly", *files, *options, "--record-steps", folder, "--quiet"], check=True)
    return {path.stem: flights.read(path) for path in sorted(pathlib.Path(folder).glob("*.steps"))}


def compare(sim, build, names, options):
    """What differs in flights with these options, in words."""
    with tempfile.TemporaryDirectory() as folder:
        recorded = record(sim, options, folder)
    probes = [targets.open_probe(name, build, kind=flights.StepProbe) for name in names]
    others = [Comparison(probe.name) for probe in probes[1:]]
    steps = plans = manoeuvres = 0
    faults = []
    for name, flight in recorded.items():
        reference = None
        for i, step in enumerate(flight):
            where = f"{name}, step {i}"
            reference, *answers = [probe.ask(step) for probe in probes]
            if reference.bytes_out != step.bytes_out:
                faults.append(f"{where}: {probes[0].name} does not write what it wrote in the flight")
            for comparison, answer in zip(others, answers):
                comparison.add(name, where, answer, reference)
        steps += len(flight)
        plans += reference.plans
        manoeuvres += reference.manoeuvres
    for probe in probes:
        probe.close()
    print(f"{' '.join(options)}: {len(recorded)} flights, {steps} steps, {plans} plans, {manoeuvres} manoeuvres")
    for c in others:
        print(f"{c.name}: {c.steps} steps compared, {len(c.differing)} decided otherwise; {len(c.ties)} flights left at a tie; largest difference of a command {c.velocity:.3g} m/s, "
              f"of a margin {c.margin:.3g} m; {c.same_bytes} steps wrote the same bytes")
        for tie in c.ties:
            print(tie)
        faults += c.differing
        if max(c.velocity, c.margin) > TOLERANCE:
            faults.append(f"{c.name}: differs by more than {TOLERANCE:g}")
    if plans == 0 or manoeuvres == 0:
        faults.append("nothing was decided in any flight")
    return faults


def main(sim, build, names):
    missing = [name for name in names if not targets.is_there(name, build, flights.StepProbe)]
    if missing:
        print(f"not built: {', '.join(missing)}: skipped")
        return 77
    faults = [f"{name}: nothing says what it is compared with" for name in names[1:] if not any(name in there for _, there in RUNS)]
    for options, there in RUNS:
        others = [name for name in names[1:] if name in there]
        faults += compare(sim, build, names[:1] + others, options) if others else []
    print("\n".join(faults[:20]))
    return 1 if faults else 0


if __name__ == "__main__":
    if len(sys.argv) < 5:
        print(__doc__, file=sys.stderr)
        sys.exit(2)
    sys.exit(main(sys.argv[1], sys.argv[2], sys.argv[3:]))
