# SPDX-License-Identifier: BSD-3-Clause
"""The page around the pictures: text and tables for readers new to the project."""
import html

import figures

OUTCOMES = {
    "clear": ("good", "control was not taken: nothing was in the way, or the autopilot refused and was asked to hold"),
    "avoided": ("good", "jink took control and kept the distance it promises"),
    "braked": ("good", "the same, and it held still for a while"),
    "breach": ("bad", "nearer than the promise, no contact"),
    "collision": ("bad", "the bodies touched"),
    "failed": ("bad", "a rule of the link or of the airspace was broken"),
}

STYLE = """
:root { --ink:#2b2f36; --soft:#5d6673; --line:#d9dde3; --good:#1e7d34; --bad:#c62828; --blue:#1d5fa8; }
* { box-sizing:border-box } html { scroll-behavior:smooth }
body { margin:0; font:16px/1.5 system-ui,"Segoe UI","DejaVu Sans",sans-serif; color:var(--ink); background:#f4f6f8 }
main { max-width:1080px; margin:0 auto; padding:28px 24px 80px }
h1 { font-size:30px; margin:6px 0 4px } h2 { font-size:21px; margin:44px 0 8px } h3 { font-size:18px; margin:0 0 2px }
p { margin:8px 0; max-width:78ch } .soft { color:var(--soft) } .small { font-size:13.5px }
.cards { display:grid; grid-template-columns:repeat(auto-fit,minmax(190px,1fr)); gap:12px; margin:20px 0 }
.card { background:#fff; border:1px solid var(--line); border-radius:10px; padding:14px 16px }
.card b { display:block; font-size:26px; line-height:1.2 } .card span { color:var(--soft); font-size:13.5px }
table { border-collapse:collapse; width:100%; background:#fff; border:1px solid var(--line); border-radius:10px; font-size:14px }
th,td { text-align:left; padding:7px 10px; border-bottom:1px solid var(--line); vertical-align:top }
th { font-weight:600; color:var(--soft); font-size:12.5px } tr:last-child td { border-bottom:0 }
td.n,th.n { text-align:right; font-variant-numeric:tabular-nums; white-space:nowrap } a { color:var(--blue) }
.badge { display:inline-block; padding:1px 9px; border-radius:99px; font-size:13px; font-weight:600; color:#fff; background:var(--soft); white-space:nowrap }
.badge.good { background:var(--good) } .badge.bad { background:var(--bad) } .bad-text { color:var(--bad) }
section.flight,.panel { background:#fff; border:1px solid var(--line); border-radius:12px; padding:20px 22px; margin:22px 0 }
.flight header { display:flex; gap:12px; align-items:baseline; flex-wrap:wrap } img { width:100%; height:auto; display:block }
figure { margin:16px 0 4px } figcaption { color:var(--soft); font-size:13.5px; margin-top:2px }
.pair { display:grid; grid-template-columns:1fr 1fr; gap:6px 22px; align-items:center }
ol.time { list-style:none; margin:10px 0; padding:0; font-size:14.5px } ol.time li { padding:1px 0 }
ol.time b { display:inline-block; min-width:62px; font-variant-numeric:tabular-nums; color:var(--blue) }
.key { display:flex; gap:10px; margin:3px 0; font-size:15px } .key i { flex:0 0 26px; height:5px; border-radius:2px; margin-top:9px }
details { margin:12px 0 } summary { cursor:pointer; color:var(--blue) }
@media (max-width:760px) { .pair { grid-template-columns:1fr } .wide { overflow-x:auto } }
@media print { body { background:#fff } section.flight { break-inside:avoid } }
"""


def text(value):
    return html.escape(str(value), quote=True)


def metres(value):
    return "\u2013" if value is None else f"{value:.2f} m".replace("-", "\u2212")


def milliseconds(value_us):
    if value_us is None:
        return "\u2013"
    return f"{value_us / 1000.0:.2f} ms" if value_us < 10000 else f"{value_us / 1000.0:.0f} ms"


def badge(flight):
    kind, meaning = OUTCOMES.get(flight.outcome, ("", "unknown outcome"))
    return f'<span class="badge {kind}" title="{text(meaning)}">{text(flight.outcome)}</span>'


def picture(uri, words, caption=""):
    below = f"<figcaption>{caption}</figcaption>" if caption else ""
    return f'<figure><img src="{uri}" alt="{text(words)}">{below}</figure>'


def alone(flight):
    if flight.alone is None:
        return "\u2013"
    return f"{metres(flight.alone)}{' (collision)' if flight.alone <= 0 else ''}"


def when_and_where(flight):
    if flight.least_time is None or flight.least is None:
        return "\u2013"
    where = ""
    if flight.least_own is not None:
        x, y, z = (f"{round(v):d}".replace("-", "\u2212") for v in flight.least_own)
        where = f", {x} m east, {y} m north, {z} m up"
    return f"{flight.least_time:.1f} s, {text(flight.least_threat)}{where}"


def draw(flight):
    """All pictures of one flight; runs in a process of its own."""
    drawn = {}
    if flight.t:
        drawn["separation"] = figures.separation(flight)
        drawn["views"] = figures.views(flight)
        drawn["space"] = figures.space(flight)
    if flight.fan:
        drawn["fan"] = figures.fan(flight)
        drawn["behind"] = figures.fan_behind(flight)
    return drawn


def cards(flights):
    told = [f for f in flights if f.kept() is not None]
    kept = sum(1 for f in told if f.kept())
    least = min((f.least for f in told), default=None)
    crashes = sum(1 for f in flights if f.alone is not None and f.alone <= 0)
    longest = max((f.plan_worst_us for f in flights if f.plan_worst_us), default=None)
    return "".join(f'<div class="card"><b>{number}</b><span>{words}</span></div>' for number, words in (
        (len(flights), "flights with something in the way"),
        (f"{kept} of {len(told)}", "kept the promised distance"),
        (crashes, "of them would have collided without jink"),
        (metres(least), "smallest distance of any flight with jink"),
        (milliseconds(longest), "longest step that planned"),
    ))


def summary_row(flight):
    expected = "" if flight.as_expected else '<br><span class="bad-text small">not as expected</span>'
    return (f'<tr><td><a href="#{text(flight.name)}">{text(flight.title)}</a></td><td>{text(flight.stack)}<br>'
            f'<span class="soft small" style="white-space:nowrap">{text(flight.transport)}</span></td><td>{badge(flight)}{expected}</td>'
            f'<td class="n">{metres(flight.least)}</td><td class="n">{alone(flight)}</td>'
            f'<td>{when_and_where(flight)}</td><td class="n">{milliseconds(flight.plan_worst_us)}</td></tr>')


HEAD = ('<tr><th>encounter</th><th>autopilot</th><th>outcome</th><th class="n">least distance<br>with jink</th>'
        '<th class="n">least distance<br>without</th><th>when, to what, where</th><th class="n">longest<br>planning step'
        '</th></tr>')


def story(flight):
    """The events in order of time, one line each."""
    events = []
    for threat in flight.threats:
        if threat.appeared is not None and threat.appeared > 0:
            kind = "flies into sight" if threat.moves else "comes into sight"
            events.append((threat.appeared, f"{text(threat.name)} {kind} (radius {threat.radius:.2g} m)"))
    said = set()
    for t, words in flight.texts:
        key = words.split(",")[0]
        if key not in said:
            said.add(key)
            events.append((t, f"message to the pilot: \u201c{text(words)}\u201d"))
    for start, end in flight.spans(lambda m: m == "external"):
        if not any(abs(t - start) < 0.3 and "has control" in words for t, words in flight.texts):
            events.append((start, "jink has control"))
        if flight.t and end < flight.t[-1] and not any(abs(t - end) < 0.3 and "resumed" in w for t, w in flight.texts):
            events.append((end, "jink no longer has control; the autopilot is in mode "
                           + text(flight.mode[min(flight.t.index(end), len(flight.mode) - 1)])))
    if flight.least is not None and flight.least_time is not None:
        events.append((flight.least_time, f"closest to {text(flight.least_threat)}: {metres(flight.least)}"))
    events.sort(key=lambda e: e[0])
    return '<ol class="time">' + "".join(f"<li><b>{t:.1f} s</b> {words}</li>" for t, words in events) + "</ol>"


def fan_words(flight):
    chosen, available, touching, stiff, unseen = figures.fan_counts(flight)
    parts = ["<div><p>jink planned this manoeuvre by weighing these paths against each other, from where the vehicle was "
             "then. All of them leave the leg and come back to it; each lies in a plane of its own.</p>"]
    for colour, count, words in ((figures.CHOSEN, chosen, "chosen: the cheapest one available"),
                                 (figures.AVAILABLE, available, "available, but dearer: longer, less smooth, or nearer to traffic"),
                                 (figures.UNAVAILABLE, touching, "unavailable: would touch something"),
                                 (figures.NOT_FLYABLE, stiff, "unavailable: more than the vehicle can fly"),
                                 (figures.LEG, unseen, "not checked (dashed): the work units were used up")):
        if count:
            parts.append(f'<span class="key"><i style="background:{colour}"></i><span>{count} {words}</span></span>')
    if flight.first_candidate:
        parts.append(f'<p class="soft small">Chosen: {text(flight.first_candidate)}</p>')
    return "".join(parts) + "</div>"


def flight_section(flight, drawn):
    parts = [f'<section class="flight" id="{text(flight.name)}"><header><h3>{text(flight.title)}</h3>{badge(flight)}</header>']
    parts.append(f'<p class="soft small">{text(flight.name)}, {text(flight.stack)}, {text(flight.transport)}'
                 f'{", expected: " + text(" or ".join(flight.expected)) if flight.expected else ""}</p>')
    for words in flight.unmet + flight.faults:
        parts.append(f'<p class="bad-text">{text(words)}</p>')
    parts.append(story(flight))
    if "separation" in drawn:
        parts.append(picture(drawn["separation"], f"separation over time, {flight.title}",
                             "Distance from the vehicle\u2019s centre to the nearest surface of anything in its way. "
                             "Far distances are cut off."))
        parts.append(picture(drawn["views"], f"views from above and from the side, {flight.title}",
                             "Everything is drawn where it was at the closest moment; the dotted red line is that distance."))
    cells = []
    if "space" in drawn:
        cells.append(picture(drawn["space"], f"view in space, {flight.title}", "The same in space."))
    if "fan" in drawn:
        cells.append(picture(drawn["fan"], f"candidates of the first plan, {flight.title}", "What the first plan had to choose from, "
                             "in space \u2026"))
        cells.append(fan_words(flight))
        cells.append(picture(drawn["behind"], f"candidates from behind, {flight.title}",
                             "\u2026 and seen from behind. Black: the vehicle; dots: where each path is farthest out."))
    if cells:
        parts.append('<div class="pair">' + "".join(cells) + "</div>")
    return "".join(parts) + "</section>"


def random_section(flights):
    if not flights:
        return ""
    counts = {}
    for flight in flights:
        counts[flight.outcome] = counts.get(flight.outcome, 0) + 1
    outcomes = ", ".join(f"{n} {text(name)}" for name, n in counts.items())
    parts = [f'<h2 id="random">{len(flights)} random encounters</h2><div class="panel"><p>Drawn by chance, with sensor '
             f"noise: speeds, directions and number of intruders differ. {outcomes}.</p>"]
    if any(f.least is not None for f in flights):
        parts.append(picture(figures.random_flights(flights), "least separation of the random flights",
                             "Left: every flight twice, orange without jink and blue with it; below zero the bodies "
                             "overlap. Right: how the distances with jink are spread."))
    broken = [f for f in flights if f.kept() is False]
    for flight in broken:
        judged = flight.judge.get("avoidable")
        words = "" if judged is None else (" \u2013 a way out was found afterwards" if judged else
                                           " \u2013 no manoeuvre that was tried afterwards would have kept it")
        parts.append(f'<p class="bad-text">{text(flight.name)}: {metres(flight.least)} at {flight.least_time or 0:.1f} s{words}</p>')
    rows = "".join(f'<tr><td>{text(f.name)}</td><td>{badge(f)}</td><td class="n">{metres(f.least)}</td><td class="n">'
                   f'{alone(f)}</td><td>{when_and_where(f)}</td><td class="n">{milliseconds(f.plan_worst_us)}</td></tr>'
                   for f in flights)
    parts.append('<details><summary>all of them in numbers</summary><div class="wide"><table><tr><th>flight</th><th>outcome'
                 '</th><th class="n">with jink</th><th class="n">without</th><th>when, to what, where</th><th class="n">'
                 f"longest planning step</th></tr>{rows}</table></div></details></div>")
    return "".join(parts)


def build(flights, mapper=map):
    """The page as text. `mapper` draws the flights, e.g. Pool.map."""
    named = [f for f in flights if not f.random]
    drawn = list(mapper(draw, named))
    promise = sorted({f.promise for f in flights if f.promise is not None})
    promised = " or ".join(f"{p:g} m" for p in promise) or "the promised distance"
    parts = ["<!DOCTYPE html><html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" content=\"width=device-width,"
             f"initial-scale=1\"><title>jink: flight report</title><style>{STYLE}</style></head><body><main>",
             "<h1>jink: flight report</h1>",
             "<p>jink sits beside a drone\u2019s autopilot and watches for collisions. When one is ahead it takes control, flies "
             "around what is in the way, and gives control back. Each flight below was simulated: a drone on its mission, and "
             "other aircraft or obstacles put in its way. The same flight was also flown without jink.</p>",
             f"<p>jink\u2019s promise: the drone\u2019s centre never comes nearer than <b>{promised}</b> to the true surface of "
             "anything, though its sensors are noisy and late.</p>",
             f'<div class="cards">{cards(flights)}</div>']
    if named:
        parts.append(f'<h2>Encounters</h2><div class="wide"><table>{HEAD}{"".join(map(summary_row, named))}</table></div>')
        kinds = sorted({f.outcome for f in flights} & set(OUTCOMES))
        parts.append('<p class="small soft">' + "; ".join(f"<b>{k}</b>: {OUTCOMES[k][1]}" for k in kinds) + ".</p>")
    parts.append(random_section([f for f in flights if f.random]))
    if any(f.plan_worst_us for f in flights):
        parts.append('<h2 id="times">How long planning takes</h2><div class="panel">'
                     + picture(figures.plan_times(flights), "histogram of planning times",
                               "Wall time on the machine that ran this demo, which does other things besides; the worst case of "
                               "a target is in its timing report.") + "</div>")
    if named:
        parts.append("<h2>Flight by flight</h2>")
        parts.extend(flight_section(f, d) for f, d in zip(named, drawn))
    if not flights:
        parts.append("<p><b>The run holds no flights.</b></p>")
    return "".join(parts) + "</main></body></html>\n"
