# SPDX-License-Identifier: BSD-3-Clause
"""Candidates of a plan as drawn in the report: an unchecked one must differ from a colliding one."""
import base64
import pathlib
import sys
import types

try:
    import matplotlib  # noqa: F401
except ImportError:
    print("matplotlib is missing: skipped")
    sys.exit(77)
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "toolchain/report"))
import figures  # noqa: E402
import page  # noqa: E402


def flight(*statuses):
    curves = [(status, [[0.0, 0.0, 30.0], [10.0, 1.0 + i, 30.0], [20.0, 0.0, 30.0]]) for i, status in enumerate(statuses)]
    return types.SimpleNamespace(mission=[[0.0, 0.0, 30.0], [100.0, 0.0, 30.0]], fan=curves, first_candidate="")


def behind(status):
    """The picture as SVG text."""
    return base64.b64decode(figures.fan_behind(flight(status)).split(",", 1)[1]).decode()


def check(condition, what):
    if not condition:
        sys.exit(f"FAILED: {what}")


unchecked = behind("not_evaluated")
touching = behind("hits_moving")
check("stroke-dasharray" in unchecked, "an unchecked candidate is drawn dashed")
check(figures.UNAVAILABLE not in unchecked, "an unchecked candidate has not the colour of one that would collide")
check("stroke-dasharray" not in touching and figures.UNAVAILABLE in touching, "a candidate that would collide has that colour")
check(figures.fan_counts(flight("chosen", "hits_static", "not_evaluated", "not_flyable", "available")) == (1, 1, 1, 1, 1),
      "each status is counted once")
words = page.fan_words(flight("chosen", "not_evaluated", "not_evaluated"))
check("2 not checked" in words and "would touch" not in words, "the legend names unchecked candidates as such")
print("report pictures: as expected")
