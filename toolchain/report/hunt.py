# SPDX-License-Identifier: BSD-3-Clause
"""The search for the most expensive case: hill climbing from random starts and from crossings of the best so far.

Deterministic for a seed, a number of evaluations and a number of workers. Each worker keeps its own best ones.
"""
import dataclasses
import multiprocessing
import os
import random
import time

import records
import scenes
import targets

STARTS = 40  # random cases; the climb starts from the most expensive
PATIENCE = 500  # evaluations without a gain before a new start
MEMORY = 15  # a step is accepted if it is no cheaper than the case this many steps ago: crosses small dips only
ELITES = 12
GAIN = 100  # instructions; a smaller one does not count as one


@dataclasses.dataclass
class Found:
    count: int
    case: targets.Case
    worker: int
    evaluation: int  # of the worker
    seed: int


class Counter:
    """What is hunted, of one case on one target."""

    def __init__(self, target, build, plugin, by_price=False):
        self.target, self.by_price = target, by_price
        self.probe = targets.open_probe(target, build, plugin)
        self.evaluations = 0

    def __call__(self, case):
        self.evaluations += 1
        case.seed = self.evaluations & 0xFFFFFFFF
        answer = self.probe.ask(records.on_board(case, self.target))
        if answer.status == "bad_input":
            return 0
        return records.by_weight(answer, self.by_price)


def climb(scene, count, r, start, patience, on_best, left):
    """Late-acceptance hill climbing. Returns the best (count, case)."""
    now = best = start
    memory = [start[0]] * MEMORY
    idle = 0
    step = 0
    while idle < patience and left() > 0:
        case = scene.neighbour(now[1], r)
        cost = count(case)
        if cost >= now[0] or cost >= memory[step % MEMORY]:
            now = (cost, case)
        memory[step % MEMORY] = now[0]
        step += 1
        idle += 1
        if cost > best[0]:
            idle = 0 if cost > best[0] + GAIN else idle
            best = (cost, case)
            on_best(best)
    return best


def search(scene, count, seed, worker, most, seconds, start=(), report=None):
    """`most` evaluations at most, or as long as `seconds` last. `start`: cases to begin with."""
    r = random.Random(f"{seed}.{worker}")
    until = time.monotonic() + seconds if seconds else None
    elites = []

    def left():
        return 0 if until and time.monotonic() > until else most - count.evaluations

    best = [0]

    def on_best(found):
        if found[0] > best[0]:
            best[0] = found[0]
            if report:
                report(Found(found[0], found[1], worker, count.evaluations, seed))

    def keep(found):
        elites.append(found)
        elites.sort(key=lambda e: -e[0])
        del elites[ELITES:]

    for case in start:
        found = (count(case), case)
        on_best(found)
        keep(climb(scene, count, r, found, PATIENCE, on_best, left))
    while left() > 0:
        way = r.random()
        if len(elites) < 4 or way < 0.4:
            first = max(((count(c), c) for c in (scene.random(r) for _ in range(STARTS))), key=lambda e: e[0])
        else:
            a, b = r.sample(elites, 2)
            child = scene.cross(a[1], b[1], r) if way < 0.8 else scene.neighbour(a[1], r)
            first = (count(child), child)
        on_best(first)
        keep(climb(scene, count, r, first, PATIENCE, on_best, left))
    return elites


def at_random(scene, count, seed, worker, most, seconds, start=(), report=None):
    """The result of random search with the same number of evaluations."""
    r = random.Random(f"{seed}.{worker}")
    until = time.monotonic() + seconds if seconds else None
    best = (0, None)
    while count.evaluations < most and not (until and time.monotonic() > until):
        case = scene.random(r)
        found = (count(case), case)
        if found[0] > best[0]:
            best = found
            if report:
                report(Found(found[0], case, worker, count.evaluations, seed))
    return [best]


def _worker(arguments):
    how, scene, target, build, plugin, seed, worker, most, seconds, start, by_price = arguments
    os.nice(5)
    count = Counter(target, build, plugin, by_price)
    best = []
    (at_random if how == "random" else search)(scenes.SCENES[scene], count, seed, worker, most, seconds, start, best.append)
    count.probe.close()
    return best[-1] if best else None, count.evaluations


def hunt(scene, target, build, plugin, seed, evaluations, seconds, workers, start=(), how="hunt", by_price=False):
    """The most expensive case found (Found), and the number of tried cases. By price: that whose units pay for least."""
    jobs = [(how, scene, target, build, plugin, seed, w, -(-evaluations // workers), seconds, start[w::workers], by_price)
            for w in range(workers)]
    with multiprocessing.Pool(workers) as pool:
        results = pool.map(_worker, jobs, chunksize=1)
    found = [best for best, _ in results if best is not None]
    return max(found, key=lambda f: f.count), sum(n for _, n in results)
