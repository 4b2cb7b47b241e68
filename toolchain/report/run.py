# SPDX-License-Identifier: BSD-3-Clause
"""Reads run.json, the notes of a demo run, as toolchain/sim writes it (layout: tests/scenario/README.md).

What is missing is None or empty, so that an older or a cut-down run still gives a page; what is there but of another
type is refused with BadRun.
"""
import json
import math
import os


class BadRun(Exception):
    """The file is not a valid run; the text says why."""


def _number(value):
    """A finite number, or None."""
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
        return None
    return float(value)


def _point(value):
    """Three finite numbers, or None."""
    if not isinstance(value, list) or len(value) != 3:
        return None
    point = tuple(_number(v) for v in value)
    return None if None in point else point


def _points(value):
    return [p for p in map(_point, value if isinstance(value, list) else []) if p is not None]


def _mapping(value):
    return value if isinstance(value, dict) else {}


def _list(value):
    return value if isinstance(value, list) else []


class Threat:
    def __init__(self, data):
        data = _mapping(data)
        self.name = str(data.get("name", "threat"))
        self.radius = _number(data.get("radius")) or 0.0
        self.half_height = _number(data.get("half_height")) or 0.0
        self.moves = bool(data.get("moves", True))
        self.appeared = _number(data.get("appeared"))
        self.positions = _points(data.get("positions"))

    def at(self, index):
        """Position at a sample; None when it is not known."""
        if not self.positions:
            return None
        return self.positions[min(index, len(self.positions) - 1)] if not self.moves or index < len(
            self.positions) else None


class Flight:
    """One flight of the run."""

    def __init__(self, data):
        if not isinstance(data, dict):
            raise BadRun("a flight is no JSON object")
        get = data.get
        self.name = str(get("name", "flight"))
        self.title = str(get("title") or self.name)
        self.transport = str(get("transport", ""))
        self.stack = str(get("stack", ""))
        self.outcome = str(get("outcome", "unknown"))
        self.expected = [str(e) for e in _list(get("expected"))]
        self.as_expected = bool(get("as_expected", True))
        self.unmet = [str(u) for u in _list(get("unmet"))]
        self.faults = [str(f) for f in _list(get("faults"))]
        self.promise = _number(get("promise"))
        self.duration = _number(get("duration"))
        self.given_back = bool(get("given_back"))
        self.takeovers = int(_number(get("takeovers")) or 0)
        self.final_mode = str(get("final_mode", ""))
        least = _mapping(get("least"))
        self.least = _number(least.get("surface"))
        self.alone = _number(least.get("alone"))
        self.least_time = _number(least.get("t"))
        self.least_threat = str(least.get("threat") or "")
        self.least_own = _point(least.get("own"))
        self.least_centre = _point(least.get("centre"))
        self.judge = _mapping(get("judge"))
        self.random = bool(self.judge) or self.name.startswith("random")
        self.texts = [(_number(t.get("t")) or 0.0, str(t.get("text", ""))) for t in map(_mapping, _list(
            _mapping(get("link")).get("texts")))]
        self.mission = _points(get("mission"))
        self.threats = [Threat(t) for t in _list(get("threats"))]
        self._read_series(_mapping(get("series")))
        inside = _mapping(get("inside"))
        plan = _mapping(inside.get("plan_steps"))
        self.plans = int(_number(plan.get("count")) or 0)
        self.plan_mean_us = _number(plan.get("mean_us")) if self.plans else None
        self.plan_worst_us = _number(plan.get("worst_us")) if self.plans else None
        self.plan_times_us = [t for t in map(_number, _list(plan.get("times_us"))) if t is not None]
        self.first_candidate = str(inside.get("first_candidate") or "")
        self.fan = [(str(c.get("status", "")), _points(c.get("points"))) for c in map(_mapping, _list(get("fan")))]
        self.fan = [c for c in self.fan if len(c[1]) >= 2]

    def _read_series(self, series):
        self.t = [_number(t) for t in _list(series.get("t"))]
        self.own = [_point(p) for p in _list(series.get("position"))]
        self.mode = [str(m) for m in _list(series.get("mode"))]
        self.separation = [_number(s) for s in _list(series.get("separation"))]
        count = min(len(self.t), len(self.own), len(self.mode), len(self.separation))
        keep = [i for i in range(count) if self.t[i] is not None and self.own[i] is not None]
        self.samples = keep
        self.t = [self.t[i] for i in keep]
        self.own = [self.own[i] for i in keep]
        self.mode = [self.mode[i] for i in keep]
        self.separation = [self.separation[i] for i in keep]

    def kept(self):
        """True when the promise was kept, None when unknown."""
        return None if self.least is None or self.promise is None else self.least >= self.promise

    def spans(self, wanted):
        """Intervals of time in which the mode satisfies `wanted`."""
        spans = []
        for i, t in enumerate(self.t):
            if not wanted(self.mode[i]):
                continue
            end = self.t[i + 1] if i + 1 < len(self.t) else t
            if spans and spans[-1][1] == t:
                spans[-1][1] = end
            else:
                spans.append([t, end])
        return [(a, b) for a, b in spans if b > a]

    def first_text(self, *words):
        """Time of the first message that has all words, or None."""
        for t, text in self.texts:
            if all(word in text for word in words):
                return t
        return None

    def closest_index(self):
        """Sample nearest to the closest approach, or None."""
        if self.least_time is None or not self.t:
            return None
        return min(range(len(self.t)), key=lambda i: abs(self.t[i] - self.least_time))

    def threat_at(self, threat, index):
        """Position of a threat at one of the kept samples."""
        return threat.at(self.samples[index])


def read(path):
    """The flights of a run file, in its order."""
    if os.path.exists(path) and not os.path.isfile(path):
        raise BadRun(f"{path}: is not a regular file")  # reading a FIFO would wait for a writer
    try:
        with open(path, encoding="utf-8") as file:
            data = json.load(file)
    except OSError as error:
        raise BadRun(f"{path}: {error.strerror}") from error
    except (ValueError, RecursionError) as error:
        raise BadRun(f"{path}: is not JSON: {error}") from error
    if not isinstance(data, dict) or not isinstance(data.get("flights"), list):
        raise BadRun(f"{path}: holds no list of flights")
    try:
        return [Flight(flight) for flight in data["flights"]]
    except BadRun as error:
        raise BadRun(f"{path}: {error}") from error
