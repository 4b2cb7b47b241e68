#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Flies a recorded encounter with libjink.so.0 and prints what jink believes in each second, as JSON.

    believe.py RECORDING.wire[.xz] [NAME=VALUE ...]

NAME=VALUE sets a parameter. The lines are those of `jink-sim replay --json`, without the names of modes.
"""
import json
import math
import sys

import jink
import recording

STEP = 20_000  # [us]


def rounded(value, per_unit=1e3):
    return math.copysign(math.floor(abs(value) * per_unit + 0.5) / per_unit, value)


def belief(status, time):
    known = status.flags
    own = known & jink.FLAG_OWN_STATE
    heard = known & jink.FLAG_AUTOPILOT_HEARD
    silent = status.faults & jink.FAULT_AUTOPILOT_SILENT
    vector = lambda v: [rounded(x) for x in v]  # noqa: E731
    return {
        "t": time,
        "stack": jink.STACKS[status.stack],
        "armed": bool(known & jink.FLAG_ARMED) if heard and not silent else None,
        "control": jink.CONTROLS[status.control],
        "position": vector(status.position) if own else None,
        "velocity": vector(status.velocity) if own else None,
        "home": [rounded(status.home_lat * 1e-7, 1e7), rounded(status.home_lon * 1e-7, 1e7), rounded(status.home_alt * 1e-3)]
                if known & jink.FLAG_HOME else None,
        "nominal": {"kind": "route" if known & jink.FLAG_NOMINAL_IS_LEG else "motion", "end": vector(status.nominal_end),
                    "speed": rounded(status.nominal_speed)} if own else None,
        "tracks": status.tracks,
        "conflict": bool(known & jink.FLAG_CONFLICT),
    }


def fly(records, parameters):
    start = recording.clock_start(records)
    autopilot = recording.Autopilot(records, start)
    with jink.Coprocessor() as coprocessor:
        for name, _, value in parameters:
            coprocessor.set_parameter(name, float(value))
        system, waiting = 0, iter(records)
        record = next(waiting, None)
        for now in range(0, records[-1][0] + 1, STEP):
            while record and record[0] <= now:
                if record[1] == recording.FROM_AUTOPILOT:
                    coprocessor.feed(record[2])
                    autopilot.hear_recorded(record[0], record[2], system)
                record = next(waiting, None)
            coprocessor.feed(autopilot.answers(now, system))
            coprocessor.step(start + now)
            autopilot.hear_jink(coprocessor.take())  # a real program sends these bytes to the autopilot
            status = coprocessor.status()
            system = status.system_id
            if now > 0 and now % 1_000_000 == 0:
                print(json.dumps(belief(status, now / 1e6)))


def main():
    if len(sys.argv) < 2:
        print(__doc__, file=sys.stderr)
        return 2
    try:
        fly(recording.read(sys.argv[1]), [argument.partition("=") for argument in sys.argv[2:]])
    except (OSError, ValueError, jink.Error) as error:
        print(f"believe.py: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
