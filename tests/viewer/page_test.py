#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The pages of `jink report` in a headless Chromium: replay, keys, candidates, charts, comparison, narrow screens.

    page_test.py --jink PROGRAM --input FOLDER

FOLDER has run.json and changed.json (jink-sim), board.ulg (a board, candidates missing), flight.ulg and wall.ulg (jinkd), the latter with obstacles and closed areas; pages are written there. What is shown is held
against run.json itself and against the tables of `jink log --csv`. Exit status 77: nothing to test with.
"""
import argparse
import collections
import csv
import json
import pathlib
import subprocess
import sys

import browser

# As docs/guides/flight_page.md names them.
COLOURS = {"chosen": (0x1E, 0x9E, 0x3E), "clear": (0x5B, 0xB8, 0xE8), "contact": (0x8E, 0x3F, 0xA8), "not_flyable": (0xC9, 0xA5, 0xD6),
           "more_expensive": (0x7D, 0x87, 0x94), "budget_spent": (0xD0, 0x8B, 0x00)}
MOST_BYTES_OF_VIEWER = 700_000
failures = []


def expect(condition, what):
    if not condition:
        failures.append(what)
        print(f"FAILED: {what}", flush=True)


def fates(candidates, has_chosen=False):
    """Number of candidates of each fate: (status, has a cost) of the candidates of one plan, of which one is chosen, here or not."""
    names = {"chosen": "chosen", "available": "clear", "hits_static": "contact", "hits_moving": "contact", "hits_airspace": "contact",
             "not_flyable": "not_flyable"}
    found = has_chosen or any(status == "chosen" for status, _ in candidates)
    return dict(collections.Counter(names.get(status, "more_expensive" if found and has_cost else "budget_spent")
                                    for status, has_cost in candidates))


def shown_fates(page):
    return page.run("Object.fromEntries([...document.querySelectorAll('#legend [data-fate]')].map(e => [e.dataset.fate, Number(e.dataset.count)]))")


def lines_by_fate(page):
    """Lines of candidates in space."""
    return page.run("jinkViewer.replay.candidates.children.reduce((n, c) => (n[c.userData.fate] = (n[c.userData.fate] || 0) + 1, n), {})")


def pixels(page, colours):
    return page.pixels("jinkViewer.replay", colours)


def check_run(page, run):
    """Candidates of every flight against the run's own words, in numbers, lines and colours."""
    for index, flight in enumerate(run["flights"]):
        page.run(f"jinkViewer.select(jinkViewer.flights[{index}], null)")
        decisions = page.run("jinkViewer.state().flight.decisions.map(d => d.time)")
        times = [d["t"] for d in flight["decisions"]]
        expect(len(times) == len(decisions) > 0 and all(abs(a - b) < 2e-3 for a, b in zip(times, decisions)), f"{flight['name']}: decisions {decisions}, expected {times}")
        for decision in reversed(flight["decisions"]):  # the first one last: its colours are counted below
            page.run(f"jinkViewer.charts.onTime({decision['t'] + 1e-3})")
            expected = fates([(c["status"], c["cost"] > 0) for c in decision["candidates"]])
            where = f"{flight['name']} at {decision['t']} s"
            expect(shown_fates(page) == expected, f"{where}: legend {shown_fates(page)}, expected {expected}")
            expect(lines_by_fate(page) == expected, f"{where}: lines {lines_by_fate(page)}, expected {expected}")
            expect(decision["text"] in page.run("document.getElementById('decision').textContent"), f"{where}: the text is missing")
        work = page.run("Array.from(jinkViewer.state().flight.work)")
        expect(work == [w for w in flight["series"]["work"]], f"{flight['name']}: work units differ")
        expect(max(w for w in work if w is not None) > 0, f"{flight['name']}: no work was done")
        found = pixels(page, COLOURS)
        expect(found["different"] > 50, f"{flight['name']}: the picture is empty")
        for fate in COLOURS:
            # A fate may be hidden behind others; the chosen one is drawn last, and absent ones have no pixel.
            count = found["found"][fate]
            expect(count > 40 if fate == "chosen" and fate in expected else fate in expected or count < 15,
                   f"{flight['name']}: {count} pixels of {fate}")
        shown = page.run("document.getElementById('title').textContent")
        expect(shown == flight["title"], f"{flight['name']}: the title is {shown}")
        series = page.run("(({flight}) => [flight.t.length, Array.from(flight.t), [0, 1, 2].map(k => Array.from(flight.own[k])), Array.from(flight.separation)])"
                          "(jinkViewer.state())")
        worst = max(abs(a - b) for k in range(3) for a, b in zip(series[2][k], (p[k] for p in flight["series"]["position"])))
        expect(series[0] == len(flight["series"]["t"]) and worst <= 0.0051, f"{flight['name']}: positions differ by {worst}")
        worst = max(abs((a if a is not None else 1e9) - (b if b is not None else 1e9)) for a, b in zip(series[3], flight["series"]["separation"]))
        expect(worst <= 0.0051, f"{flight['name']}: separations differ by {worst}")


def check_keys(page):
    """Steps, plays and pauses by keyboard; things move."""
    place = "jinkViewer.replay.vehicle.position.toArray().concat(Number(document.querySelector('#charts .cursor').getAttribute('x1')))"
    state = "(s => [s.time, s.isPlaying])(jinkViewer.state())"
    page.run("jinkViewer.select(jinkViewer.flights[0]); document.activeElement.blur(); null")
    decision = page.run("jinkViewer.state().flight.decisions[0].time")
    expect(page.run(state) == [decision, False], "a flight opens at its first decision")
    before, (time, _) = page.run(place), page.run(state)
    page.press("ArrowRight")
    after, (later, _) = page.run(place), page.run(state)
    expect(abs(later - time - 0.1) < 1e-6, f"an arrow steps 0.1 s: {time} to {later}")
    expect(sum((a - b) ** 2 for a, b in zip(before[:3], after[:3])) > 0.01 and after[3] > before[3], "a step moves the vehicle and the cursor")
    page.press("ArrowLeft", shift=True)
    expect(abs(page.run(state)[0] - later + 1.0) < 1e-6, "with shift 1 s back")
    page.press("Home")
    expect(page.run(state)[0] == 0.0, "Home goes to the start")
    page.press("n")
    expect(abs(page.run(state)[0] - decision) < 1e-6, "n goes to the decision")
    page.press("End")
    page.press("ArrowRight")
    expect(page.run("jinkViewer.state().time == Number(document.getElementById('time').max)"), "the replay ends at its end")
    page.press("p")
    expect(abs(page.run(state)[0] - decision) < 1e-6, "p goes back to the decision")
    page.press(" ")
    expect(page.run(state)[1], "space plays")
    # A machine that is busy draws no frame for a while.
    moved, took = page.run("new Promise(done => { const began = performance.now(); const look = () => { const took = (performance.now() - began) / 1000,"
                           " time = jinkViewer.state().time; if (time > %f + 0.3 || took > 20) done([time, took]); else setTimeout(look, 50); }; look(); })" % decision)
    expect(decision + 0.3 < moved < decision + took + 0.6, f"playing for {took} s goes from {decision} to {moved}")
    page.press(" ")
    stopped = page.run(state)
    expect(not stopped[1] and page.run("new Promise(done => setTimeout(() => done(jinkViewer.state().time), 300))") == stopped[0], "space pauses")
    page.click("#events li:last-child button")
    expect(abs(page.run(state)[0] - page.run("Number(document.querySelector('#events li:last-child').dataset.time)")) < 1e-6, "an event takes the cursor along")
    page.click("#flights tr[data-index='1'] button")
    expect(page.run("jinkViewer.flights.indexOf(jinkViewer.state().flight)") == 1, "one click selects a flight")
    page.click("#charts")
    expect(page.run("Math.abs(jinkViewer.state().time - jinkViewer.state().flight.t.at(-1) / 2)") < 3.0, "a press in the charts moves the cursor")
    camera = "jinkViewer.replay.camera.position.toArray()"
    seen = page.run(camera)
    page.click("[data-view=above]")
    expect(page.run(camera)[1] > seen[1], "the view from above is higher")


# Elements that stand out of the page, and texts that are cut: by their element, or by the drawing.
CUT = """(() => {
  const wrong = [], width = document.documentElement.clientWidth;
  if (document.documentElement.scrollWidth > width) wrong.push('page is ' + document.documentElement.scrollWidth + ' wide');
  for (const e of document.querySelectorAll('main *')) {
    const box = e.getBoundingClientRect(), style = getComputedStyle(e);
    if (!box.width || e.closest('select') || style.visibility == 'hidden') continue;
    const name = e.tagName + '#' + e.id + ' ' + (e.textContent || '').slice(0, 30);
    if (e.tagName == 'text') {
      const svg = e.ownerSVGElement.getBoundingClientRect();
      if (box.left < svg.left - 1 || box.right > svg.right + 1 || box.top < svg.top - 1 || box.bottom > svg.bottom + 1) wrong.push('cut: ' + name);
    } else if (!e.closest('svg')) {
      if (box.right > width + 1 || box.left < -1) wrong.push('outside: ' + name);
      const scrolls = style.overflowX == 'auto' && style.overflowY == 'auto';
      if (e.scrollWidth > e.clientWidth + 1 && e.clientWidth && style.display != 'inline' && (scrolls || style.overflowX != 'visible') && e.id != 'canvas')
        wrong.push('cut: ' + name);
    }
  }
  const lines = [...document.querySelectorAll('#charts text')].map(e => e.getBoundingClientRect());
  for (let i = 0; i < lines.length; ++i) for (let k = i + 1; k < lines.length; ++k) {
    const a = lines[i], b = lines[k];
    if (a.left < b.right - 1 && b.left < a.right - 1 && a.top < b.bottom - 3 && b.top < a.bottom - 3) wrong.push('texts ' + i + ' and ' + k + ' overlap');
  }
  return wrong.slice(0, 8);
})()"""


def check_widths(page, name):
    for width in (1000, 360):
        page.resize(width, 500)
        page.run("new Promise(done => setTimeout(() => requestAnimationFrame(() => requestAnimationFrame(done)), 80))")
        wrong = page.run(CUT)
        expect(not wrong, f"{name} at {width} px: {wrong}")
    page.resize(*browser.SIZE)


def check_comparison(page):
    page.run("jinkViewer.select(jinkViewer.flights[0]); null")
    both = page.run("(s => s.other !== null && s.other !== s.flight && s.other.name == s.flight.name)(jinkViewer.state())")
    expect(both, "flights of the same name are compared")
    curves = "document.querySelectorAll('#charts .curve').length"
    two = page.run(curves)
    page.run("jinkViewer.replay.otherVehicle.visible = false; null")
    colour = pixels(page, {"other": (0xA8, 0x32, 0x7D)})["found"]["other"]
    expect(colour > 40, f"the second path is drawn: {colour} pixels")
    # Where the second flight's curves begin, and where its first sample belongs.
    starts = ("[Math.min(...[...document.querySelectorAll('#charts .curve[stroke=\"#a8327d\"]')].map(e => e.getBBox().x)),"
              " jinkViewer.charts.x(jinkViewer.state().shift + jinkViewer.state().other.t[0])]")
    for shift in (0, 5):
        page.run(f"(e => {{ e.value = {shift}; e.onchange(); }})(document.getElementById('shift'))")
        drawn, expected = page.run(starts)
        expect(abs(drawn - expected) < 1.0, f"shifted by {shift} s the second curves begin at {drawn}, expected {expected}")
    expect(page.run("jinkViewer.charts.x(5) - jinkViewer.charts.x(0)") > 10 and page.run("jinkViewer.state().shift") == 5, "the shift is visible")
    page.run("(e => { e.value = -1; e.onchange(); })(document.getElementById('other'))")
    one = page.run(curves)
    expect(two == 2 * one and pixels(page, {"other": (0xA8, 0x32, 0x7D)})["found"]["other"] == 0, f"{two} curves of two flights, {one} of one")


def check_log(page, tables):
    """The page of a flight log against the log's tables."""
    with open(tables / "jink_candidate.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    with open(tables / "jink_step.csv", encoding="utf-8") as file:
        steps = list(csv.DictReader(file))
    names = ["available", "chosen", "hits_static", "hits_moving", "hits_airspace", "not_flyable", "not_evaluated"]
    by_decision = collections.defaultdict(list)
    for row in rows:
        by_decision[int(row["decision"])].append((names[int(row["status"])], float(row["time"]) > 0))
    decisions = page.run("jinkViewer.state().flight.decisions.map(d => d.time)")
    manoeuvres = [(int(s["timestamp"]) - int(steps[0]["timestamp"])) * 1e-6 for s in steps if s["new_manoeuvre"] == "1"]
    expect(len(decisions) == len(manoeuvres) > 0 and all(abs(a - b) < 2e-3 for a, b in zip(decisions, manoeuvres)), f"decisions {decisions}, expected {manoeuvres}")
    for time, number in zip(decisions, sorted(by_decision)):
        page.run(f"jinkViewer.charts.onTime({time})")
        expect(shown_fates(page) == fates(by_decision[number]), f"decision {number}: legend {shown_fates(page)}, expected {fates(by_decision[number])}")
        expect(sum(lines_by_fate(page).values()) == len(by_decision[number]), f"decision {number}: every candidate is a line")
    with open(tables / "jink_nominal.csv", encoding="utf-8") as file:
        logged = list(csv.DictReader(file))
    shown = page.run("jinkViewer.state().flight.nominal.t")
    times = sorted({(int(n["timestamp"]) - int(steps[0]["timestamp"])) * 1e-6 for n in logged})
    expect(len(shown) == len(times) > 20 and all(abs(a - b) < 2e-3 for a, b in zip(shown, times)), f"{len(shown)} times of nominal paths, logged {len(times)}")
    page.run(f"jinkViewer.charts.onTime({decisions[0] - 0.5})")
    nominal = page.pixels("jinkViewer.replay", {"nominal": (0x0F, 0x9A, 0xA0)})["found"]["nominal"]
    expect(nominal > 20 and page.run("jinkViewer.replay.nominal.children.length") > 0, f"nominal paths are drawn: {nominal} pixels")
    work = page.run("Math.max(...jinkViewer.state().flight.work.filter(v => v == v))")
    expect(work == max(int(s["work"]) for s in steps), f"most work units {work}")
    expect(page.run("document.querySelectorAll('#charts .control').length") > 0, "times of control are marked")
    with open(tables / "texts.csv", encoding="utf-8") as file:
        texts = [row["text"] for row in csv.DictReader(file)]
    shown = page.run("[...document.querySelectorAll('#events span')].map(e => e.textContent)")
    expect(texts and not [t for t in texts if t not in shown and t != "jinkd starts"], f"all texts are among the events: {len(texts)} of {len(shown)}")


def check_board(page, tables):
    """The page of a board's log: candidates that the log lacks are missing, and nothing else is said of the others."""
    names = ["available", "chosen", "hits_static", "hits_moving", "hits_airspace", "not_flyable", "not_evaluated"]
    rows = {}
    for topic in ("decision", "candidate"):
        with open(tables / f"jink_{topic}.csv", encoding="utf-8") as file:
            rows[topic] = list(csv.DictReader(file))
    decisions = page.run("jinkViewer.state().flight.decisions.map(d => d.time)")
    expect(len(decisions) == len(rows["decision"]) > 0, f"board: decisions {decisions}")
    lacking = 0
    for time, decision in zip(decisions, rows["decision"]):
        page.run(f"jinkViewer.charts.onTime({time})")
        found = [c for c in rows["candidate"] if c["decision"] == decision["decision"]]
        expected = fates([(names[int(c["status"])], float(c["time"]) > 0) for c in found], decision["chosen"] != "65535")
        expect(shown_fates(page) == expected, f"board: legend {shown_fates(page)}, expected {expected}")
        expect(sum(lines_by_fate(page).values()) == len(found), "board: every candidate is a line")
        text, known = page.run("document.getElementById('decision').textContent"), int(decision["candidates"])
        said = f"{len(found)} of {known} candidates" in text and f"{known - len(found)} are missing" in text
        expect(said == (len(found) < known), f"board: {len(found)} of {known} candidates, and the page says: {text}")
        lacking += len(found) < known
    expect(lacking > 0, "board: the log lacks candidates")


def turned(q, v):
    """v turned by the unit quaternion w, x, y, z."""
    w, x, y, z = q
    rows = [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)], [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]
    return [sum(r * c for r, c in zip(row, v)) for row in rows]


# Points of the first solid's surface, in the world's axes from its centre on.
SURFACE = """(() => {
  const mesh = jinkViewer.replay.shapes.children[0], at = mesh.geometry.attributes.position, points = [];
  mesh.updateMatrixWorld();
  const e = mesh.matrixWorld.elements;
  for (let i = 0; i < at.count; ++i) {
    const [x, y, z] = [0, 1, 2].map(k => e[k] * at.getX(i) + e[4 + k] * at.getY(i) + e[8 + k] * at.getZ(i));
    points.push([x, -z, y]);
  }
  return points;
})()"""


def check_turns(page):
    """A turned box has its corners where they belong, and a capsule and a cylinder their axes."""
    for turn in ([1, 0, 0, 0], [0.5, 0.5, 0.5, 0.5], [0.8, 0.6, 0, 0], [0.8, 0, 0.6, 0], [0.8, 0, 0, -0.6], [0.1, -0.7, 0.5, 0.5]):
        for kind in ("box", "hull", "capsule", "cylinder"):
            shape = {"kind": kind, "half": [1, 2, 4], "radius": 0.5, "turn": turn, "centre": [0, 0, 0], "velocity": [0, 0], "time": 0}
            page.run(f"jinkViewer.replay.drawShapes([{json.dumps(shape)}]); null")
            points = page.run(SURFACE)
            if kind in ("box", "hull"):
                wanted = [turned(turn, [a, b, c]) for a in (-1, 1) for b in (-2, 2) for c in (-4, 4)]
            else:
                wanted = [turned(turn, [0, 0, c * (4.5 if kind == "capsule" else 4)]) for c in (-1, 1)]
            for corner in wanted:
                nearest = min(sum((a - b) ** 2 for a, b in zip(corner, p)) for p in points) ** 0.5
                expect(nearest < 0.02, f"{kind} turned by {turn}: no point at {corner}, the nearest is {nearest} m away")
            farthest = max(sum(a * a for a in p) for p in points) ** 0.5
            expected = max(sum(a * a for a in p) for p in wanted) ** 0.5
            expect(abs(farthest - expected) < 0.05, f"{kind} turned by {turn}: {farthest} m, expected {expected} m")


def check_shapes(page, tables):
    """Obstacles and closed areas of a log: at any time those of the newest round in its tables, where they were or had moved to."""
    steps, rounds = [], {}
    with open(tables / "jink_step.csv", encoding="utf-8") as file:
        steps = [int(row["timestamp"]) for row in csv.DictReader(file)]
    for topic in ("obstacle", "area"):
        with open(tables / f"jink_{topic}.csv", encoding="utf-8") as file:
            for row in csv.DictReader(file):
                rounds.setdefault((int(row["known"]) - steps[0]) * 1e-6, []).append((topic, row))
    known = sorted(rounds)
    expect(len(known) > 5 and {t for all in rounds.values() for t, _ in all} == {"obstacle", "area"}, f"{len(known)} rounds")
    # The last round may have been cut by the end. Scene axes: east, up, south.
    drawn = ("(r => r.shapes.children.map(c => [c.userData.shape.kind, c.position.x + r.origin[0], r.origin[1] - c.position.z, c.position.y + r.origin[2], c.userData.shape.radius]))"
             "(jinkViewer.replay)")
    kinds = ["sphere", "box", "capsule", "cylinder", "hull"]
    for at in known[:-1]:
        later = min([k for k in known if k > at] + [at + 2.0])
        for time in (at + 0.002, at + 0.6 * (later - at)):
            page.run(f"jinkViewer.replay.setTime({time}); null")
            expected = []
            for topic, row in rounds[at]:
                v = {key: float(value) for key, value in row.items()}
                if topic == "obstacle":
                    expected.append((kinds[int(v["kind"])], v["centre[0]"], v["centre[1]"], v["centre[2]"], v["radius"]))
                else:
                    expected.append(("area", v["centre[0]"] + v["velocity[0]"] * (time - at), v["centre[1]"] + v["velocity[1]"] * (time - at),
                                     (v["bottom"] + v["top"]) / 2, v["radius"]))
            found = page.run(drawn)
            left = list(found)
            for solid in expected:  # solids that go on unchanged stand before new ones
                match = [f for f in left if f[0] == solid[0] and all(abs(x - y) < 0.03 for x, y in zip(f[1:], solid[1:]))]
                expect(match, f"at {time} s: no {solid} among {left}")
                left = [f for f in left if not match or f is not match[0]]
            expect(not left, f"at {time} s: {left} beside what is believed")
    page.run(f"jinkViewer.replay.setTime({known[0] - 0.01}); null")
    expect(known[0] < 0.05 or page.run(drawn) == [], "nothing is believed before the first round")
    page.run(f"jinkViewer.charts.onTime({known[-2] + 0.01}); jinkViewer.replay.view('oblique'); null")
    picture = "(r => { r.render(); return r.canvas.toDataURL(); })(jinkViewer.replay)"
    with_them = page.run(picture)
    page.run("jinkViewer.replay.shapes.visible = false; null")
    expect(page.run(picture) != with_them, "they are in the picture")
    page.run("jinkViewer.replay.shapes.visible = true; null")
    check_turns(page)
    words = page.run("document.getElementById('paths').textContent")
    expect("obstacles, as jink believes them" in words and "closed areas, as jink believes them" in words, f"the legend is {words}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--jink", required=True, type=lambda path: pathlib.Path(path).resolve())
    parser.add_argument("--input", required=True, type=pathlib.Path)
    arguments = parser.parse_args()
    if browser.find_chromium() is None:
        print("chromium is not installed: skipped")
        return 77
    folder = arguments.input

    def jink(*words):
        ran = subprocess.run([arguments.jink, *map(str, words)], capture_output=True, text=True, cwd=folder)
        if "toolchain/viewer/setup.sh" in ran.stderr:
            print(ran.stderr.strip() + ": skipped")
            sys.exit(77)
        if ran.returncode != 0:
            sys.exit(f"FAILED: {words}: {ran.stderr}")

    jink("report", "run.json", "--out", "run.html")
    jink("report", "run.json", "changed.json", "--out", "two.html")
    jink("report", "flight.ulg")
    jink("log", "--csv", "tables", "flight.ulg")
    jink("report", "board.ulg")
    jink("log", "--csv", "board_tables", "board.ulg")
    jink("report", "wall.ulg")
    jink("log", "--csv", "wall_tables", "wall.ulg")
    run = json.loads((folder / "run.json").read_text(encoding="utf-8"))
    size = (folder / "run.html").stat().st_size
    flown = sum(len(f["series"]["t"]) for f in run["flights"])
    # 5 MB for the 83 flights of the demo: 50 KB each, beside the viewer.
    expect(size < MOST_BYTES_OF_VIEWER + 50_000 * len(run["flights"]), f"{size} bytes for {len(run['flights'])} flights of {flown} samples")
    page = browser.Browser()
    try:
        # Every page with WebGL costs seconds of shader compilation.
        for name, check in (("two", lambda: (check_run(page, run), check_keys(page), check_comparison(page))),
                            ("flight", lambda: check_log(page, folder / "tables")),
                            ("board", lambda: check_board(page, folder / "board_tables")),
                            ("wall", lambda: check_shapes(page, folder / "wall_tables"))):
            page.open(folder / f"{name}.html")
            check()
            check_widths(page, name)
            expect(not page.errors, f"{name}: console: {page.errors}")
            expect(all(r.startswith(("file://", "data:", "blob:")) for r in page.requests), f"{name}: fetched {page.requests}")
        page.call("Page.addScriptToEvaluateOnNewDocument",
                  source="const of = HTMLCanvasElement.prototype.getContext;"
                         "HTMLCanvasElement.prototype.getContext = function(kind, ...more) { return kind.startsWith('webgl') ? null : of.call(this, kind, ...more); };")
        page.open(folder / "run.html")
        expect(page.run("document.getElementById('no-webgl').offsetHeight > 0 && document.getElementById('canvas').offsetHeight == 0"), "without WebGL the page says so")
        page.press("ArrowRight")
        expect(page.run("document.querySelectorAll('#charts .curve').length") > 2 and page.run("jinkViewer.state().time") > 0, "charts and keys work without WebGL")
        expect(not page.errors, f"without WebGL: console: {page.errors}")
    finally:
        page.close()
    print(f"{len(failures)} failures; {len(run['flights'])} flights, {size} bytes")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
