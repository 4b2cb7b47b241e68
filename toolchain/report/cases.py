# SPDX-License-Identifier: BSD-3-Clause
"""Random cases for the probe, by seed, and small changes to them for a search."""
import copy
import math
import random

import targets


def _vector(r, size):
    return tuple(r.uniform(-size, size) for _ in range(3))


def _add(*vectors):
    return tuple(sum(parts) for parts in zip(*vectors))


def _scale(vector, factor):
    return tuple(factor * x for x in vector)


def _track(r, case, miss, time):
    """A track that passes the leg within `miss` metres, after `time` seconds."""
    along = _scale(_add(case.leg_end, _scale(case.leg_start, -1.0)), case.leg_speed * time / leg_length(case))
    velocity = _vector(r, r.choice([0.0, 1.0, 4.0, 10.0]))
    meeting = _add(case.own_position, along, _vector(r, miss))
    return (_add(meeting, _scale(velocity, -time)), velocity, r.uniform(0.2, 3.0), r.uniform(0.0, 0.5),
            r.uniform(0.0, 0.3), r.choice([0.0, 0.0, 0.5]))


def leg_length(case):
    return max(1e-3, math.dist(case.leg_start, case.leg_end))


def _obstacle(r, case):
    kind = r.randrange(4)
    centre = _add(case.own_position, (r.uniform(3.0, 40.0), r.uniform(-12.0, 12.0), r.uniform(-8.0, 8.0)))
    if kind == 0:
        return (0, centre, (0.0, 0.0, 0.0), r.uniform(0.3, 3.0), 0.0)
    if kind == 1:
        return (1, centre, tuple(r.uniform(0.2, 4.0) for _ in range(3)), 0.0, r.uniform(-3.0, 3.0))
    return (kind, centre, _add(centre, _vector(r, 6.0)), r.uniform(0.2, 2.0), 0.0)


def random_case(seed, kind="plan", tracks=3, obstacles=0, offsets=2, retries=8):
    """A leg in any direction, a threat on it, and the others near it."""
    r = random.Random(seed)
    heading = r.uniform(-math.pi, math.pi)
    climb = r.uniform(-0.3, 0.3)
    start = (r.uniform(-200.0, 200.0), r.uniform(-200.0, 200.0), r.uniform(20.0, 80.0))
    direction = (math.cos(heading) * math.cos(climb), math.sin(heading) * math.cos(climb), math.sin(climb))
    case = targets.Case(seed, kind, offsets=offsets, retries=retries)
    case.leg_speed = r.uniform(2.0, 8.0)
    case.own_position = case.leg_start = start
    case.leg_end = _add(start, _scale(direction, 100.0))
    case.own_velocity = _scale(direction, case.leg_speed)
    case.own_sigma = r.uniform(0.0, 0.3)
    case.half = tuple(r.uniform(0.3, 1.2) for _ in range(3))
    if r.random() < 0.3:
        case.bounds, case.floor, case.ceiling, case.keep_in = 7, start[2] - r.uniform(3.0, 15.0), start[2] + r.uniform(3.0, 15.0), 400.0
    for i in range(tracks):
        case.tracks.append(_track(r, case, 0.8 if i == 0 else 8.0, r.uniform(1.5, 7.0)))
    for _ in range(obstacles):
        case.obstacles.append(_obstacle(r, case))
    return case


def neighbour(case, r):
    """The case with a few of its numbers changed, slightly or strongly; its composition stays."""
    new = copy.deepcopy(case)
    size = 10.0 ** r.uniform(-2.0, 0.7)
    for _ in range(r.randint(1, 3)):
        what = r.randrange(8)
        if what <= 3 and new.tracks:
            i = r.randrange(len(new.tracks))
            position, velocity, radius, sigma_p, sigma_v, acceleration = new.tracks[i]
            if what == 0:
                position = _add(position, _vector(r, size))
            elif what == 1:
                velocity = _add(velocity, _vector(r, size))
            elif what == 2:
                radius = min(3.0, max(0.1, radius + r.uniform(-size, size)))
            else:
                sigma_p, sigma_v = r.uniform(0.0, 0.5), r.uniform(0.0, 0.3)
            new.tracks[i] = (position, velocity, radius, sigma_p, sigma_v, acceleration)
        elif what == 4 and new.obstacles:
            i = r.randrange(len(new.obstacles))
            kind, a, b, radius, yaw = new.obstacles[i]
            shift = _vector(r, size)
            new.obstacles[i] = (kind, _add(a, shift), b if kind == 1 else _add(b, shift), radius, yaw + r.uniform(-0.3, 0.3))
        elif what == 5:
            new.own_velocity = _add(new.own_velocity, _vector(r, min(size, 2.0)))
        elif what == 6:
            new.leg_speed = min(8.0, max(1.0, new.leg_speed + r.uniform(-size, size)))
        else:
            new.half = tuple(min(1.5, max(0.2, h + r.uniform(-0.2, 0.2))) for h in new.half)
    return new
