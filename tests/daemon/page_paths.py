# SPDX-License-Identifier: BSD-3-Clause
"""Candidates and nominal paths on the live page: in its events, against the simulator's own record, and in the browser."""
import math


def distance_to_path(path, point):
    """From a point to a line through points."""
    def to_piece(a, b):
        ab, ap = [y - x for x, y in zip(a, b)], [y - x for x, y in zip(a, point)]
        square = sum(v * v for v in ab)
        share = min(1.0, max(0.0, sum(x * y for x, y in zip(ab, ap)) / square)) if square else 0.0
        return math.dist(point, [x + share * v for x, v in zip(a, ab)])
    return min(to_piece(a, b) for a, b in zip(path, path[1:]))


def check_decisions(events, flight):
    """Each decision comes once; of several between two events the newest. Its candidates begin where the vehicle was, and end on the line to the collision point, which is the mission's."""
    path, decisions = flight["series"]["position"], [e["decision"] for e in events if e["decision"]]
    numbers = [d["number"] for d in decisions]
    assert decisions and numbers == sorted(set(numbers)) and numbers[-1] == events[-1]["decisions"], (numbers, events[-1]["decisions"])
    for decision in decisions:
        candidates = decision["candidates"]
        assert len(candidates) == decision["candidates_known"] > 8, decision["candidates_known"]
        assert sum(c["fate"] == "chosen" for c in candidates) <= 1, [c["fate"] for c in candidates]
        for c in candidates:
            x, y, z = c["points"]
            assert len(x) == len(y) == len(z) == 25 and distance_to_path(path, (x[0], y[0], z[0])) < 1.0, c
            assert all(b > a for a, b in zip(x, x[1:])), "the mission leads east"
            assert max(map(abs, y)) > 0.5 or max(abs(v - z[0]) for v in z) > 0.5, "nothing is avoided"
        assert any(t["time"] == decision["time"] and "new manoeuvre" in t["text"] for e in events for t in e["texts"]), decision["time"]
    assert any(c["fate"] == "chosen" for c in decisions[0]["candidates"]), "the first plan finds a way"
    controlled = min(e["time"] for e in events if e["in_control"])
    assert numbers[0] > 1 or abs(controlled - decisions[0]["time"]) < 1, f"decided at {decisions[0]['time']} s, flown from {controlled} s on"


def check_nominal(events, flight):
    """Until the first decision the link's route and the motion lead along the mission, as far as 8 s of flight do: JNK_LOOKAHEAD."""
    first = min(e["decision"]["time"] for e in events if e["decision"])
    start, end = flight["mission"]
    compared = 0
    for event in (e for e in events if e["own"] and e["nominal"] and 1.0 < e["time"] < first):
        assert sorted(p["kind"] for p in event["nominal"]) == ["motion", "route"], event["nominal"]
        for path in event["nominal"]:
            points = list(zip(*path["points"]))
            assert math.dist(points[0], event["own"]["position"]) < 1.5, (path, event["own"])
            assert all(distance_to_path([start, end], p) < 1.0 for p in points), path
            assert abs(path["speed"] - math.hypot(*event["own"]["velocity"])) < 0.5, (path["speed"], event["own"])
            length = sum(math.dist(a, b) for a, b in zip(points, points[1:]))
            assert abs(length - 8.0 * path["speed"]) < 0.5 and points[-1][0] > points[0][0] + 0.9 * length, path
            compared += 1
    assert compared > 20, f"{compared} nominal paths"


LINES = "[...jinkLive.replay.%s.children].map(c => c.userData.%s)"


def check_paths(page):
    """Nominal paths and candidates in space, when no event comes any more, and the legend: what the events said."""
    colours = {"nominal": (0x0F, 0x9A, 0xA0), "chosen": (0x1E, 0x9E, 0x3E), "more_expensive": (0x7D, 0x87, 0x94)}
    page.run("jinkLive.replay.follow(true); jinkLive.replay.setTime(jinkLive.flight.t.at(-1)); jinkLive.replay.view('oblique'); null")
    moving = page.run("jinkLive.state().nominal.filter(n => Math.hypot(...n.points.map(c => c.at(-1) - c[0])) > 1).map(n => n.kind)")
    assert moving and page.run(LINES % ("nominal", "kind")) == moving, f"lines {page.run(LINES % ('nominal', 'kind'))}, expected {moving}"
    assert (found := page.pixels("jinkLive.replay", colours)["found"])["nominal"] > 20, found
    decided = page.run("jinkLive.flight.decisions.at(-1)")
    fates = [c["fate"] for c in decided["candidates"]]
    page.run(f"jinkLive.replay.setTime({decided['time'] + 1}); jinkLive.showDecision({decided['time'] + 1}); null")
    assert sorted(page.run(LINES % ("candidates", "fate"))) == sorted(fates) != [], fates
    legend = page.run("Object.fromEntries([...document.querySelectorAll('#legend [data-fate]')].map(e => [e.dataset.fate, Number(e.dataset.count)]))")
    assert legend == {fate: fates.count(fate) for fate in set(fates)}, (legend, fates)
    assert "new manoeuvre" in page.run("document.getElementById('decision').textContent"), decided
    with_them = page.pixels("jinkLive.replay", colours)["found"]
    page.run("(box => { box.checked = false; box.onchange(); })(document.getElementById('show-candidates'))")
    without = page.pixels("jinkLive.replay", colours)["found"]
    assert page.run(LINES % ("candidates", "fate")) == [] and with_them["chosen"] > without["chosen"] + 20, (with_them, without)
    page.run(f"jinkLive.showDecision({decided['time'] + 11}); null")
    assert page.run("document.getElementById('legend').children.length") == 0, "a decision of long ago has a legend"
