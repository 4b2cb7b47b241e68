#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Flights through libjink.so.0 against the same flights of the co-processor in C++.

    flights_test.py --simulator JINK-SIM --program FLY_STEPS --library LIBJINK --work FOLDER [--recordings FOLDER]

Without recordings: the simulator flies and records what each step read and wrote; fly_steps compares every byte, two
flights at once. Their streams, or the recordings, go through docs/example/c_interface and through `jink-sim replay`,
which must believe the same in each second. Exit status 77: there are no recordings.
"""
import argparse
import json
import os
import pathlib
import re
import struct
import subprocess
import sys

TOP = pathlib.Path(__file__).resolve().parents[2]
EXAMPLE = TOP / "docs/example/c_interface/believe.py"
PAIRS = (("head_on", "crossing"), ("scan_wall", "storm_crossing"), ("plane_head_on", "px4_documented"), ("autopilot_reboots", "clear_pass"))
RECORDINGS = ("arducopter_three_encounters", "arducopter_reboot", "px4_multirotor_overtaking_items_in_order")
STEP = struct.Struct("<IIqII")


def run(*command, status=0, **options):
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, **options)
    assert done.returncode == status, f"{command}: {done.returncode}\n{done.stdout}{done.stderr}"
    return done.stdout


def wire_of(steps):
    """The stream of a recorded flight, as a recording of a real line has it."""
    data, at, first, out = steps.read_bytes(), 0, None, b""
    while at < len(data):
        _, _, now, read, wrote = STEP.unpack_from(data, at)
        at += STEP.size
        first = now if first is None else first
        for direction, length in ((0, read), (1, wrote)):
            if length:
                out += struct.pack("<dBI", (now - first) * 1e-6, direction, length) + data[at : at + length]
            at += length
    return out


def with_damage(data):
    """The same steps with one bit less in the last byte that the flight wrote."""
    at, last = 0, None
    while at < len(data):
        *_, read, wrote = STEP.unpack_from(data, at)
        at += STEP.size + read + wrote
        last = at - 1 if wrote else last
    return data[:last] + bytes([data[last] ^ 1]) + data[last + 1 :]


def beliefs(text):
    return [json.loads(line) for line in text.splitlines()]


def compare(arguments, file, *parameters):
    """Differences between the example and the simulator, and what the example believes."""
    environment = {**os.environ, "JINK_LIBRARY": str(arguments.library)}
    ours = beliefs(run(sys.executable, "-B", EXAMPLE, file, *parameters, env=environment))
    theirs = beliefs(run(arguments.simulator, "replay", "--json", file))
    assert len(ours) == len(theirs) > 10, f"{file}: {len(ours)} and {len(theirs)} seconds"
    assert all(set(t) - set(o) == {"vehicle", "mode"} for o, t in zip(ours, theirs)), "other keys"
    return [(o["t"], key, o[key], t[key]) for o, t in zip(ours, theirs) for key in o if o[key] != t[key]], ours


def fly(arguments):
    for number, pair in enumerate((*PAIRS, PAIRS[0])):
        clock = ("--clock", 216) if number == len(PAIRS) else ()  # plans that go on over several steps
        files = [arguments.work / f"{name}.steps" for name in pair]
        run(arguments.simulator, "fly", *(TOP / f"tests/scenario/{name}.yaml" for name in pair), "--record-steps", arguments.work, *clock)
        said = run(arguments.program, *files)
        print(said, end="")
        assert sum(int(n) for n in re.findall(r"(\d+) in control", said)) > 100, "nothing was flown"
    damaged = arguments.work / "damaged.steps"
    damaged.write_bytes(with_damage((arguments.work / f"{PAIRS[0][0]}.steps").read_bytes()))
    assert " 1 steps differ" in run(arguments.program, damaged, status=1), "a planted difference is not found"
    for name in (*PAIRS[0], "clear_pass"):
        file = arguments.work / f"{name}.wire"
        file.write_bytes(wire_of(arguments.work / f"{name}.steps"))
        yield file


def own_sensors(arguments, file):
    """What the caller's own sensors see ahead of a vehicle becomes a conflict; the same on its other side does not."""
    sys.path.insert(0, str(EXAMPLE.parent))
    import jink
    import recording
    records = recording.read(file)
    start = recording.clock_start(records)

    def fly(side, kind):
        with jink.Coprocessor(str(arguments.library)) as coprocessor:
            waiting = iter(records)
            record = next(waiting)
            for now in range(0, 4_000_000, 20_000):
                while record[0] <= now:
                    if record[1] == recording.FROM_AUTOPILOT:
                        coprocessor.feed(record[2])
                    record = next(waiting)
                status = coprocessor.status()
                ahead = [side * v for v in status.velocity]
                place = [p + 6 * v for p, v in zip(status.position, ahead)]
                stamp = start + now
                if now > 2_000_000 and kind == "track":
                    coprocessor.report_track(id=9, source=jink.OWN_SENSOR, stamp_us=stamp, position=tuple(place), has_velocity=1)
                elif now > 2_000_000 and kind == "range":
                    coprocessor.report_range(stamp_us=stamp, direction=(ahead[0], ahead[1], 0.0), range=20.0, max_range=40.0, half_angle=0.1)
                elif now > 2_000_000 and kind == "area":
                    coprocessor.set_closed_areas(stamp, {"centre": tuple(place[:2]), "radius": 8.0, "bottom": -10.0, "top": 200.0})
                coprocessor.step(stamp)
                coprocessor.take()
            return coprocessor.status()

    quiet = fly(1, None)
    assert not quiet.flags & jink.FLAG_CONFLICT and quiet.flags & jink.FLAG_OWN_STATE, "no quiet flight to begin with"
    for kind, threat, count in (("track", jink.THREAT_TRACK, "tracks"), ("range", jink.THREAT_OBSTACLE, "obstacles"),
                                ("area", jink.THREAT_CLOSED_AREA, "closed_areas")):
        ahead, behind = fly(1, kind), fly(-1, kind)
        assert ahead.flags & jink.FLAG_CONFLICT and ahead.threat == threat, f"{kind} ahead: flags {ahead.flags}, threat {ahead.threat}"
        assert not behind.flags & jink.FLAG_CONFLICT, f"{kind} behind"
        assert getattr(behind, count) > getattr(quiet, count), f"{kind} behind is not known"
    print("own sensors: track, range and closed area ahead are conflicts, behind they are not")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    for name in ("simulator", "program", "library", "work"):
        parser.add_argument(f"--{name}", type=pathlib.Path, required=True)
    parser.add_argument("--recordings", type=pathlib.Path)
    arguments = parser.parse_args()
    if arguments.recordings:
        files = [arguments.recordings / f"{name}.wire.xz" for name in RECORDINGS]
        if not all(file.exists() for file in files):
            print(f"skipped: {arguments.recordings} has no recordings")
            sys.exit(77)
    else:
        files = list(fly(arguments))
    conflicts = 0
    for file in files:
        differences, believed = compare(arguments, file)
        assert not differences, f"{file}: {len(differences)} differences, the first {differences[0]}"
        conflicts += sum(b["conflict"] for b in believed)
        print(f"{file.name}: the same belief in each of {len(believed)} seconds, {sum(b['conflict'] for b in believed)} with a conflict")
    assert conflicts > 0, "nothing came near"
    if not arguments.recordings:
        assert compare(arguments, files[0], "JNK_LOOKAHEAD=2")[0], "another look-ahead makes no difference"
        own_sensors(arguments, files[-1])


if __name__ == "__main__":
    main()
