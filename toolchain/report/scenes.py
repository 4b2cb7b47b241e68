# SPDX-License-Identifier: BSD-3-Clause
"""Counted scenes and their variation: random members, small changes, crossings. All from one random generator."""
import copy
import dataclasses
import math
import random

import cases
import targets

# (offsets, extra planes, families) with 16 candidates: l (n + 1) per family.
SIXTEEN = [(2, 3, 3), (4, 1, 3), (8, 0, 3), (2, 7, 1), (4, 3, 1), (8, 1, 1), (16, 0, 1), (2, 7, 2), (4, 3, 2), (8, 1, 2), (16, 0, 2)]
THIRTY_TWO = [(4, 3, 3), (2, 7, 3), (8, 1, 3), (16, 0, 3), (4, 7, 1), (8, 3, 2), (2, 15, 1), (32, 0, 2)]
DEFAULT = targets.Case(0)
# Sets of methods (JNK_METHODS), other than all.
METHODS = {1: "geometric", 2: "reach sets", 3: "geometric and reach sets", 4: "reciprocal", 5: "geometric and reciprocal", 6: "reach sets and reciprocal"}


@dataclasses.dataclass(frozen=True)
class Scene:
    name: str
    title: str
    kind: str
    threats: tuple  # least and most
    obstacles: tuple
    choices: list  # of candidates
    retries: int
    free: bool  # parameters other than those of the candidates as well
    solids: bool = False  # obstacles of any shape; otherwise the co-processor's obstacles of scan returns
                          # (firmware/app/range_return.cpp)
    mixed: bool = False  # `threats` counts tracks and obstacles together
    study: bool = False  # Pinheiro's run-time study: 5 m/s along a level leg, a static threat of 1 m on the leg 10 m
                         # ahead
    methods: int = 0  # of an update, held fixed: JNK_METHODS; 0: as free as the rest

    def random(self, r):
        tracks = r.randint(*self.threats)
        obstacles = r.randint(*self.obstacles)
        if self.mixed:
            obstacles = r.randint(0, tracks)
            tracks -= obstacles
        case = cases.random_case(r.getrandbits(31), self.kind, tracks, obstacles, retries=self.retries)
        case.offsets, case.extra_planes, case.families = r.choice(self.choices)
        if r.random() < 0.5:
            case.half = tuple(round(10 ** r.uniform(-0.7, 0.3), 3) for _ in range(3))
        for i in range(len(case.tracks)):
            if r.random() < 0.3:  # static
                p, v, *rest = case.tracks[i]
                t = r.uniform(1.0, 7.0)
                case.tracks[i] = (tuple(a + t * b for a, b in zip(p, v)), (0.0, 0.0, 0.0), *rest)
        if self.kind == "reciprocal":
            case.shared = r.getrandbits(32)
        if self.free:
            for _ in range(r.randint(0, 3)):
                _parameter(case, r, 1.0)
        return tidy(case, self)

    def neighbour(self, case, r):
        new = copy.deepcopy(case)
        size = 10.0 ** r.uniform(-2.5, 1.0)
        for _ in range(r.choice((1, 1, 1, 2, 2, 3, 5))):
            r.choice(self.moves)(new, r, size, self)
        return tidy(new, self)

    @property
    def moves(self):
        return MOVES + ([_share] * 2 if self.kind == "reciprocal" else []) + ([_course] * 2 if self.kind == "update" else []) + ([_more, _fewer] if self.threats[0] != self.threats[1] or self.obstacles[1] else []) + (
            [lambda c, r, s, scene: _parameter(c, r, s)] * 3 if self.free else [])

    def cross(self, a, b, r):
        """The first with some of the second's threats, moved from its start to this one's."""
        new = copy.deepcopy(a)
        shift = tuple(x - y for x, y in zip(a.own_position, b.own_position))
        for mine, theirs, places in ((new.tracks, b.tracks, (0,)), (new.obstacles, b.obstacles, (1, 2))):
            for i in range(min(len(mine), len(theirs))):
                if r.random() < 0.4:
                    item = list(theirs[i])
                    for place in places:
                        if place == 2 and item[0] == 1:  # a box's half extents
                            continue
                        item[place] = tuple(x + y for x, y in zip(item[place], shift))
                    mine[i] = tuple(item)
        return tidy(new, self)


def _shift(vector, r, size):
    return tuple(x + r.gauss(0.0, size) for x in vector)


def _own(case, r, size, scene):
    case.own_velocity = _shift(case.own_velocity, r, min(size, 3.0))


def _speed(case, r, size, scene):
    case.leg_speed += r.gauss(0.0, min(size, 3.0))


def _leg(case, r, size, scene):
    case.leg_end = _shift(case.leg_end, r, 3.0 * size)


def _half(case, r, size, scene):
    case.half = tuple(h * math.exp(r.gauss(0.0, min(size, 0.5))) for h in case.half)


def _sigma(case, r, size, scene):
    case.own_sigma = r.choice((0.0, r.uniform(0.0, 0.3), case.own_sigma + r.gauss(0.0, 0.1 * size)))


def _bounds(case, r, size, scene):
    if r.random() < 0.5:
        case.bounds = r.randrange(8)
        case.keep_in = 400.0
    height = case.own_position[2]
    case.floor = r.choice((case.floor + r.gauss(0.0, size), height - r.uniform(0.5, 15.0)))
    case.ceiling = r.choice((case.ceiling + r.gauss(0.0, size), height + r.uniform(0.5, 15.0)))


def _candidates(case, r, size, scene):
    case.offsets, case.extra_planes, case.families = r.choice(scene.choices)


def _track(case, r, size, scene):
    if not case.tracks:
        return
    i = r.randrange(len(case.tracks))
    position, velocity, radius, sigma_p, sigma_v, acceleration = case.tracks[i]
    what = r.randrange(9)
    if what <= 1:
        position = _shift(position, r, size)
    elif what == 2:
        velocity = _shift(velocity, r, size)
    elif what == 3:  # another speed, the same place after t
        t = r.uniform(0.5, 8.0)
        changed = _shift(velocity, r, size)
        position = tuple(p + t * (v - w) for p, v, w in zip(position, velocity, changed))
        velocity = changed
    elif what == 4:
        radius *= math.exp(r.gauss(0.0, min(size, 1.0)))
    elif what == 5:
        sigma_p, sigma_v = r.choice(((0.0, 0.0), (r.uniform(0.0, 0.5), r.uniform(0.0, 0.3)), (sigma_p, 0.0)))
    elif what == 6:
        acceleration = r.choice((0.0, 0.5, r.uniform(0.0, 2.0)))
    elif what == 7:
        velocity = r.choice(((0.0, 0.0, 0.0), case.own_velocity, tuple(-v for v in velocity)))
    else:
        j = r.randrange(len(case.tracks))
        case.tracks[j], case.tracks[i] = case.tracks[i], case.tracks[j]
        return
    case.tracks[i] = (position, velocity, radius, sigma_p, sigma_v, acceleration)


def _obstacle(case, r, size, scene):
    if not case.obstacles:
        return _track(case, r, size, scene)
    i = r.randrange(len(case.obstacles))
    kind, a, b, radius, yaw = case.obstacles[i]
    what = r.randrange(6)
    if what <= 1:
        move = _shift((0.0, 0.0, 0.0), r, size)
        a = tuple(x + y for x, y in zip(a, move))
        b = b if kind == 1 else tuple(x + y for x, y in zip(b, move))
    elif what == 2:
        b = _shift(b, r, size)
    elif what == 3:
        radius *= math.exp(r.gauss(0.0, min(size, 1.0)))
    elif what == 4:
        yaw += r.gauss(0.0, size)
    else:
        new = cases.random_case(r.getrandbits(31), case.kind, 0, 1)
        kind, a, b, radius, yaw = new.obstacles[0]
        move = tuple(x - y for x, y in zip(case.own_position, new.own_position))
        a = tuple(x + y for x, y in zip(a, move))
        b = b if kind == 1 else tuple(x + y for x, y in zip(b, move))
    case.obstacles[i] = (kind, a, b, radius, yaw)


def _share(case, r, size, scene):
    case.shared ^= 1 << r.randrange(max(1, len(case.tracks)))


def _more(case, r, size, scene):
    """One more: a copy of another, moved a little."""
    if case.tracks and len(case.tracks) < scene.threats[1] and not scene.mixed:
        case.tracks.insert(r.randrange(len(case.tracks) + 1), r.choice(case.tracks))
        _track(case, r, size, scene)
    if case.obstacles and len(case.obstacles) < scene.obstacles[1]:
        for _ in range(r.choice((1, 1, 4))):
            case.obstacles.insert(r.randrange(len(case.obstacles) + 1), r.choice(case.obstacles))
            _obstacle(case, r, size, scene)


def _fewer(case, r, size, scene):
    if len(case.tracks) > max(1, scene.threats[0]) and not scene.mixed:
        case.tracks.pop(r.randrange(len(case.tracks)))
    if len(case.obstacles) > scene.obstacles[0] and r.random() < 0.5:
        case.obstacles.pop(r.randrange(len(case.obstacles)))


def _course(case, r, size, scene):
    """Of an update: which one of a row, so that a plan has begun before it, and the methods."""
    if r.random() < 0.6:
        case.updates = r.choice((1, 2, 3, case.updates + 1, max(1, case.updates - 1)))
    else:
        case.methods = r.randrange(8)


def _parameter(case, r, size):
    """One of the co-processor's parameters, within its range (firmware/app/parameters.cpp), or near its default."""
    what = r.randrange(6)
    if what == 0:
        case.waypoints = r.choice((8, 25, 64, min(64, max(8, case.waypoints + r.randint(-6, 6)))))
    elif what == 1:
        case.swept = r.randrange(2)
    elif what == 2:
        case.lookahead = r.choice((8.0, 60.0, r.uniform(1.0, 60.0)))
    elif what == 3:
        case.k_sigma = r.choice((3.0, 0.0, 6.0, r.uniform(0.0, 6.0)))
    else:
        i = r.randrange(6)
        limits = list(case.limits)
        limits[i] *= math.exp(r.gauss(0.0, min(size, 1.0)))
        if r.random() < 0.1:
            limits[i] = DEFAULT.limits[i]
        case.limits = tuple(limits)


MOVES = [_track] * 8 + [_obstacle] * 4 + [_own] * 2 + [_speed] * 2 + [_leg, _half, _sigma, _bounds, _candidates]
LIMITS = ((0.5, 100.0), (0.1, 50.0), (0.1, 50.0), (0.2, 50.0), (0.2, 50.0), (0.0, 2.0))


def _within(x, low, high):
    return min(high, max(low, x)) if math.isfinite(x) else low


def tidy(case, scene):
    """Within the ranges that the link, the track table and the parameters let through, and exact in single precision."""
    case.retries = scene.retries
    case.limits = tuple(_within(x, *bounds) for x, bounds in zip(case.limits, LIMITS))
    cruise, climb, descent = case.limits[:3]
    level = math.hypot(*case.own_velocity[:2])
    share = min(1.0, 1.6 * cruise / level) if level > 0.0 else 1.0  # a mission or the wind may be faster than cruise speed
    case.own_velocity = (share * case.own_velocity[0], share * case.own_velocity[1], _within(case.own_velocity[2], -descent, climb))
    case.leg_speed = _within(case.leg_speed, min(1.0, cruise), 1.6 * cruise)
    case.own_sigma = _within(case.own_sigma, 0.0, 0.5)
    case.half = tuple(_within(h, 0.1, 3.0) for h in case.half)
    case.floor, case.ceiling = _within(case.floor, -500.0, 5000.0), _within(case.ceiling, -500.0, 5000.0)
    if case.bounds & 3 == 3 and case.ceiling - case.floor < 4.0 * case.half[2]:  # refused as a parameter
        case.ceiling = case.floor + 4.0 * case.half[2]
    case.lookahead = _within(case.lookahead, 1.0, 60.0)
    del case.tracks[targets.TRACKS:], case.obstacles[targets.OBSTACLES:]
    case.tracks = [(tuple(_within(x, -1000.0, 1000.0) for x in p), tuple(_within(x, -30.0, 30.0) for x in v), _within(radius, 0.05, 10.0),
                    _within(sp, 0.0, 1.0), _within(sv, 0.0, 1.0), _within(a, 0.0, 2.0)) for p, v, radius, sp, sv, a in case.tracks]
    case.obstacles = [(kind, tuple(_within(x, -1000.0, 1000.0) for x in a), tuple(_within(x, 0.1, 20.0) for x in b) if kind == 1
                       else tuple(_within(x, -1000.0, 1000.0) for x in b), _within(radius, 0.05, 10.0) if kind != 1 else 0.0, yaw)
                      for kind, a, b, radius, yaw in case.obstacles]
    case.shared &= (1 << len(case.tracks)) - 1
    if scene.methods:
        case.methods = scene.methods
    if scene.study:
        _as_studied(case)
    if not scene.solids:
        case.obstacles = [_echo(*o) for o in case.obstacles]
    return case


def _as_studied(case):
    """Pinheiro tab. 5.1: free are the two other threats, and the shape of the candidates."""
    case.own_position = case.leg_start = (0.0, 0.0, 50.0)
    case.leg_end, case.own_velocity, case.leg_speed, case.own_sigma = (100.0, 0.0, 50.0), (5.0, 0.0, 0.0), 5.0, 0.0
    case.half, case.bounds = (1.0, 1.0, 1.0), 0
    case.tracks[0] = ((10.0, 0.0, 50.0), (0.0, 0.0, 0.0), 1.0, 0.0, 0.0, 0.0)
    case.tracks[1:] = [(tuple(_within(x, *b) for x, b in zip(p, ((-60.0, 100.0), (-60.0, 60.0), (0.0, 110.0)))), *rest)
                       for p, *rest in case.tracks[1:]]


def _echo(kind, a, b, radius, yaw):
    """A sphere, or an upright capsule: the obstacle of a scan's return."""
    return (0, a, (0.0, 0.0, 0.0), radius, 0.0) if kind == 0 else (2, a, (a[0], a[1], a[2] + 20.0), max(radius, 0.3), 0.0)


SCENES = {scene.name: scene for scene in (
    Scene("plan_16_3", "plan, 16 candidates, 3 threats", "plan", (3, 3), (0, 0), SIXTEEN, 0, False),
    Scene("plan_16_3_retries", "plan, 16 candidates, 3 threats, up to 9 further attempts", "plan", (3, 3), (0, 0), SIXTEEN, 8, False),
    Scene("plan_16_3_study", "plan, 16 candidates, 3 threats, one standing 10 m ahead as in the source's run-time study", "plan", (3, 3), (0, 0), SIXTEEN,
          0, False, study=True),
    Scene("plan_16_3_solids", "plan, 16 candidates, 3 threats of any shape", "plan", (3, 3), (0, 0), SIXTEEN, 0, False, True, True),
    Scene("plan_full", "plan at full capacity", "plan", (1, 32), (0, 96), THIRTY_TWO, 8, True),
    Scene("reach_full", "decision with reach sets, 32 tracks and 96 obstacles at most", "reach", (1, 32), (0, 96), SIXTEEN, 0, False),
    Scene("orca_16_16", "reciprocal decision, 16 tracks and 16 obstacles", "reciprocal", (16, 16), (16, 16), SIXTEEN, 0, False, True),
    Scene("orca_full", "reciprocal decision, 32 tracks and 96 obstacles at most", "reciprocal", (1, 32), (0, 96), SIXTEEN, 0, False, True),
    Scene("update_full", "update at full capacity", "update", (1, 32), (0, 96), THIRTY_TWO, 8, True),
    Scene("update_solids", "update, solids of any shape", "update", (1, 32), (0, 96), THIRTY_TWO, 8, True, True),
    *(Scene(f"update_set_{n}", f"update at full capacity, {of}", "update", (1, 32), (0, 96), THIRTY_TWO, 8, True, methods=n) for n, of in METHODS.items()),
)}


def _sample(scene, seed, tracks, obstacles, offsets, retries):
    case = cases.random_case(seed, SCENES[scene].kind, tracks, obstacles, offsets, retries)
    if SCENES[scene].kind == "reciprocal":
        case.shared = random.Random(seed).getrandbits(32)
    if SCENES[scene].kind == "update":
        case.updates = 1 + seed % 4
    return tidy(case, SCENES[scene])


# Random problems whose counts are a distribution: (title, how many, case of a seed).
SAMPLES = {
    "plan_16_3": ("plan, 16 candidates, 3 threats", 800, lambda seed: _sample("plan_16_3", seed, 3, 0, 2, 0)),
    "plan_typical": ("plan, 32 candidates, 1 to 6 tracks, up to 3 obstacles, up to 9 further attempts", 300,
                     lambda seed: _sample("plan_full", seed, 1 + seed % 6, seed // 6 % 4, 4, 8)),
    "update_typical": ("update, the same; the first to fourth of a row", 300, lambda seed: _sample("update_full", seed, 1 + seed % 6, seed // 6 % 4, 4, 8)),
    "plan_full": ("plan, 32 candidates, 32 tracks, 96 obstacles", 80, lambda seed: _sample("plan_full", seed, 32, 96, 4, 8)),
    "reach_typical": ("decision with reach sets, 1 to 6 tracks, up to 3 obstacles", 300,
                      lambda seed: _sample("reach_full", seed, 1 + seed % 6, seed // 6 % 4, 2, 0)),
    "reach_full": ("decision with reach sets, 32 tracks, 96 obstacles", 80, lambda seed: _sample("reach_full", seed, 32, 96, 2, 0)),
    "orca_typical": ("reciprocal decision, 1 to 6 tracks, up to 3 obstacles", 300,
                     lambda seed: _sample("orca_full", seed, 1 + seed % 6, seed // 6 % 4, 2, 0)),
    "orca_16_16": ("reciprocal decision, 16 tracks and 16 obstacles", 300, lambda seed: _sample("orca_16_16", seed, 16, 16, 2, 0)),
    "update_full": ("update, the same; the first to fourth of a row", 80, lambda seed: _sample("update_full", seed, 32, 96, 4, 8)),
}

# Scenarios whose flown steps are counted.
FLIGHTS = ["clear_pass", "crossing", "head_on", "pillar", "px4_documented_short", "scan_wall", "tuning_3", "tuning_4"]
STEPS = {"step_flights": "step, 8 of the named scenarios", "step_crowd": "step, a crowd of 32 intruders in a ring of pillars"}
CROWD = 1  # whose steps are counted as typical ones
# Crowds, of which the most expensive step counts: {scene: JNK_METHODS}.
CROWDS = {"step_full": 7, **{f"step_set_{n}": n for n in METHODS}}
TITLES = {**{name: scene.title for name, scene in SCENES.items()}, "step_full": "step, 32 tracks at once in a ring of pillars",
          **{f"step_set_{n}": f"step, the same, {of}" for n, of in METHODS.items()}}
