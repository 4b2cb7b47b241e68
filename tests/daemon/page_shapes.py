# SPDX-License-Identifier: BSD-3-Clause
"""Obstacles and closed areas on the live page: in its events, against the flight log of the same jinkd and the true wall, and in the browser."""
import csv
import math

SCENARIO = """title: A wall beside the leg that a range scan sees, and a closed area that drifts on the other side
stack: px4
duration: 14
mission: [[0, 0, 30], [100, 0, 30]]
threats:
  - name: wall
    radius: 1.0
    half_height: 8
    position: [45, -14, 30]
    grid: {across: 5, up: 1, step: 2.0, direction: [0, 1, 0]}
    sensed_by: scan
scan: {rate: 10, range: 25}
closed_areas:
  - {name: drifts, centre: [30, 90, 0], velocity: [0, 1, 0], radius: 12, bottom: 0, top: 120, margin: 6}
expect: {outcome: clear}
"""
PILLARS = [(45.0, y) for y in (-18.0, -16.0, -14.0, -12.0, -10.0)]


def read(tables, topic):
    with open(tables / f"jink_{topic}.csv", encoding="utf-8") as file:
        return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]


def rounds_of(tables):
    """Complete rounds of a log: (time known, obstacles, areas), each with its rows in order."""
    start, rounds = read(tables, "step")[0]["timestamp"], {}
    for topic in ("obstacle", "area"):
        for row in read(tables, topic):
            rounds.setdefault(row["known"], {"obstacle": [], "area": []})[topic].append(row)
    complete = []
    for known, rows in sorted(rounds.items()):
        one = (rows["obstacle"] + rows["area"])[0]
        if len(rows["obstacle"]) == one["obstacles"] and len(rows["area"]) == one["areas"]:
            complete.append(((known - start) * 1e-6, rows["obstacle"], rows["area"]))
    return complete


def vector(row, name, size=3):
    return [row[f"{name}[{k}]"] for k in range(size)]


def are_near(a, b, most=1.1e-3):
    return all(abs(x - y) <= most for x, y in zip(a, b, strict=True))


def check_shapes(events, tables):
    """Every change of what is shown is a round of the log, value by value; nothing is shown before the first one."""
    rounds = rounds_of(tables)
    assert len(rounds) > 8, f"{len(rounds)} rounds in the log"
    shown = [e["shapes"] for e in events if e["shapes"] and (e["shapes"]["obstacles"] or e["shapes"]["closed_areas"])]
    kinds = ["sphere", "box", "capsule", "cylinder", "hull"]
    for shapes in shown:
        time, obstacles, areas = min(rounds, key=lambda r: abs(r[0] - shapes["time"]))
        assert abs(time - shapes["time"]) < 2e-3, f"no round was known at {shapes['time']} s"
        assert [o["id"] for o in shapes["obstacles"]] == [row["id"] for row in obstacles]
        for o, row in zip(shapes["obstacles"], obstacles):
            assert o["kind"] == kinds[int(row["kind"])] and o["of_map"] == bool(row["of_map"]) and o["is_bound"] == bool(row["is_bound"]), (o, row)
            assert are_near(o["position"], vector(row, "centre")) and are_near(o["half"], vector(row, "half")) and are_near(o["turn"], vector(row, "turn", 4)), (o, row)
            assert are_near([o["radius"], o["uncertainty"]], [row["radius"], row["uncertainty"]]), (o, row)
        for a, row in zip(shapes["closed_areas"], areas, strict=True):
            assert are_near(a["position"] + a["velocity"], vector(row, "centre", 2) + vector(row, "velocity", 2)), (a, row)
            assert are_near([a[k] for k in ("radius", "bottom", "top", "margin")], [row[k] for k in ("radius", "bottom", "top", "margin")]), (a, row)
    # The area drifts: every round is a change. The last one may have come behind the last event; a page that waits for a processor may miss one.
    times = {s["time"] for s in shown}
    assert len(shown) == len(times) and len(rounds) - 3 <= len(times) <= len(rounds), f"{len(shown)} changes, {len(rounds)} rounds"
    check_truth(shown)


def check_truth(shown):
    """The wall is where it is, and the area drifts north with 1 m/s."""
    seen = [o for shapes in shown for o in shapes["obstacles"]]
    assert len(seen) > 10, f"{len(seen)} obstacles"
    for o in seen:
        away = min(math.dist(o["position"][:2], pillar) for pillar in PILLARS) - 1.0
        assert away < o["radius"] + o["uncertainty"] + math.hypot(*o["half"][:2]) + 1.0, f"{away} m beside the wall: {o}"
    areas = [(s["time"], a) for s in shown for a in s["closed_areas"]]
    assert len(areas) > 5, f"{len(areas)} areas"
    for (t0, a), (t1, b) in zip(areas, areas[1:]):
        assert are_near(b["position"], [a["position"][0], a["position"][1] + (t1 - t0)], 0.05), (a, b)
        assert a["radius"] == 12 and a["margin"] == 6 and abs(a["position"][0] - 30) < 1, a


PICTURE = "(r => { r.render(); return r.canvas.toDataURL(); })(jinkLive.replay)"


def check_drawn(page):
    """Solids in space, when no event comes any more: those of the last change, where they are."""
    drawn = page.run("jinkLive.replay.shapes.children.map(c => [c.userData.shape.kind, c.position.x + jinkLive.replay.origin[0], jinkLive.replay.origin[1] - c.position.z, c.position.y + jinkLive.replay.origin[2]])")
    believed = page.run("jinkLive.flight.shapes.lists[0]")
    time = page.run("jinkLive.replay.time")
    assert len(drawn) == len(believed) > 1 and {s["kind"] for s in believed} > {"area"}, believed
    for (kind, *place), shape in zip(drawn, believed):
        moved = [c + v * (time - shape["time"]) for c, v in zip(shape["centre"], shape["velocity"] + [0])]
        assert kind == shape["kind"] and are_near(place, moved, 0.02), (kind, place, shape)
    page.run("jinkLive.replay.follow(true); jinkLive.replay.view('oblique'); null")
    with_them = page.run(PICTURE)
    page.run("jinkLive.replay.shapes.visible = false; null")
    assert page.run(PICTURE) != with_them, "they are not in the picture"
    legend = page.run("document.getElementById('paths').textContent")
    assert "obstacles, as jink believes them" in legend and "closed areas, as jink believes them" in legend, legend
