# SPDX-License-Identifier: BSD-3-Clause
"""The pictures of a report, each as a data URI. Drawn with matplotlib; nothing is fetched from anywhere."""
import base64
import io
import math

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402 (the backend must be chosen first)
import numpy as np  # noqa: E402
from matplotlib.lines import Line2D  # noqa: E402
from matplotlib.patches import Circle, Patch  # noqa: E402
from matplotlib.patheffects import withStroke  # noqa: E402

OWN, THREAT, INK, GRID, LEG = "#1d5fa8", "#e07b1a", "#2b2f36", "#d9dde3", "#8a93a0"
PROMISE, CONTROL, CONFLICT, OTHER = "#c62828", "#d7ecd9", "#fdf0cf", "#e6e3f3"
# Colours as in Pinheiro 4.5.1: purple unavailable, light blue available, green chosen.
UNAVAILABLE, NOT_FLYABLE, AVAILABLE, CHOSEN = "#8e3fa8", "#c9a5d6", "#5bb8e8", "#1e9e3e"
WIDTH = 9.4  # of full-width pictures [in]
LATE_MS = 20.0  # a co-processor step is due every 20 ms

plt.rcParams.update({
    "font.family": "sans-serif", "font.size": 9, "axes.edgecolor": LEG, "axes.labelcolor": INK, "text.color": INK,
    "xtick.color": INK, "ytick.color": INK, "axes.grid": True, "grid.color": GRID, "grid.linewidth": 0.6,
    "axes.axisbelow": True, "axes.spines.top": False, "axes.spines.right": False, "legend.frameon": False,
    "svg.fonttype": "none", "svg.hashsalt": "jink", "figure.facecolor": "white",
})


def _data(kind, content):
    return f"data:image/{kind};base64,{base64.b64encode(content).decode()}"


def _svg(figure):
    buffer = io.BytesIO()
    figure.savefig(buffer, format="svg", metadata={"Date": None})
    plt.close(figure)
    return _data("svg+xml", buffer.getvalue())


def _png(figure):
    """A 3D picture with its wide white margin removed."""
    figure.set_dpi(130)
    figure.canvas.draw()
    pixels = np.asarray(figure.canvas.buffer_rgba())[:, :, :3]
    plt.close(figure)
    dark = np.argwhere(pixels.min(axis=2) < 250)
    (top, left), (bottom, right) = dark.min(axis=0), dark.max(axis=0) + 1
    buffer = io.BytesIO()
    plt.imsave(buffer, np.ascontiguousarray(pixels[top:bottom, left:right]), format="png")
    return _data("png", buffer.getvalue())


class Frame:
    """Coordinates relative to the vehicle's leg: along, to the left, and height."""

    def __init__(self, mission):
        ends = (mission[0], mission[-1]) if len(mission) >= 2 else ((0, 0, 0), (1, 0, 0))
        dx, dy = ends[1][0] - ends[0][0], ends[1][1] - ends[0][1]
        length = math.hypot(dx, dy)
        self.origin = ends[0]
        self.ux, self.uy = (dx / length, dy / length) if length > 1e-6 else (1.0, 0.0)

    def array(self, points):
        """(n, 3): along, left, height."""
        p = np.asarray(points, dtype=float).reshape(-1, 3)
        x, y = p[:, 0] - self.origin[0], p[:, 1] - self.origin[1]
        return np.column_stack([x * self.ux + y * self.uy, y * self.ux - x * self.uy, p[:, 2]])


def separation(flight):
    """Distance to the nearest threat over time, with events."""
    figure, axes = plt.subplots(figsize=(WIDTH, 2.9))
    figure.subplots_adjust(left=0.07, right=0.985, bottom=0.17, top=0.87)
    t = np.array(flight.t)
    s = np.array([math.nan if v is None else v for v in flight.separation])
    top = max(3.0 * (flight.least or 0.0), 12.0, 8.0 * (flight.promise or 0.0))
    if np.any(np.isfinite(s)):
        top = min(top, 1.1 * np.nanmax(s) + 1.0)
    seen = flight.first_text("conflict")
    control = flight.spans(lambda m: m == "external")
    handles = []
    if seen is not None:
        until = min((a for a, _ in control if a >= seen), default=min(seen + 0.5, t[-1]))
        axes.axvspan(seen, until, color=CONFLICT, lw=0)
        handles.append(Patch(color=CONFLICT, label="conflict seen"))
    for start, end in control:
        axes.axvspan(start, end, color=CONTROL, lw=0)
    if control:
        handles.append(Patch(color=CONTROL, label="jink in control"))
    others = flight.spans(lambda m: m not in ("external", "mission"))
    for start, end in others:
        axes.axvspan(start, end, color=OTHER, lw=0)
    if others:
        names = sorted({m for m in flight.mode if m not in ("external", "mission")})
        handles.append(Patch(color=OTHER, label="autopilot in mode " + ", ".join(names)))
    axes.plot(t, s, color=OWN, lw=1.8)
    handles.append(Line2D([], [], color=OWN, lw=1.8, label="with jink"))
    if flight.promise is not None:
        axes.axhline(flight.promise, color=PROMISE, lw=1.2, ls="--")
        handles.append(Line2D([], [], color=PROMISE, lw=1.2, ls="--", label=f"promise: at least {flight.promise:g} m"))
    bottom = 0.0
    if flight.alone is not None:
        bottom = min(0.0, flight.alone)
        axes.axhline(flight.alone, color=THREAT, lw=1.2, ls=":")
        label = "without jink: " + ("collision" if flight.alone <= 0 else f"{flight.alone:.1f} m at the least")
        handles.append(Line2D([], [], color=THREAT, lw=1.2, ls=":", label=label))
    if flight.least is not None and flight.least_time is not None:
        axes.plot([flight.least_time], [flight.least], "o", color=OWN, ms=6, mec="white")
        below = flight.least > 0.3 * top
        axes.annotate(f"{flight.least:.2f} m at {flight.least_time:.1f} s", (flight.least_time, flight.least),
                      (0, -15 if below else 9), textcoords="offset points", ha="center", weight="bold",
                      path_effects=[withStroke(linewidth=3, foreground="white")])
    axes.set_ylim(bottom - 0.06 * top, top)
    axes.set_xlim(t[0], t[-1] if t[-1] > t[0] else t[0] + 1)
    axes.set_xlabel("time [s]")
    axes.set_ylabel("to the nearest surface [m]")
    axes.legend(handles=handles, loc="upper center", bbox_to_anchor=(0.5, 1.18), ncol=len(handles))
    return _svg(figure)


def _window(flight, frame):
    """Extent of a view: the manoeuvre and the closest approach, with a margin."""
    own = frame.array(flight.own)
    moving = [i for i, m in enumerate(flight.mode) if m != "mission"]
    index = flight.closest_index()
    keep = set(moving)
    if index is not None:
        keep.update(range(max(0, index - 40), min(len(own), index + 41)))
    shown = own[sorted(keep)] if keep else own
    if flight.least_centre is not None:
        shown = np.vstack([shown, frame.array([flight.least_centre])])
    low, high = shown.min(axis=0), shown.max(axis=0)
    margin = np.maximum(0.12 * (high - low), [6.0, 4.0, 4.0])
    return low - margin, high + margin


def _flown(axes, own, flight, i, j):
    """The track, thick and blue under jink's control, grey under the mission's."""
    axes.plot(own[:, i], own[:, j], color=LEG, lw=1.6, zorder=3)
    for start, end in flight.spans(lambda m: m == "external"):
        part = [k for k, t in enumerate(flight.t) if start <= t <= end]
        axes.plot(own[part, i], own[part, j], color=OWN, lw=2.6, zorder=4, solid_capstyle="round")


def _view(axes, flight, frame, i, j, low, high, names):
    own = frame.array(flight.own)
    if len(flight.mission) >= 2:
        leg = frame.array(flight.mission)
        axes.plot(leg[:, i], leg[:, j], color=INK, lw=0.9, ls=(0, (6, 4)), zorder=2)
    index = flight.closest_index()
    for threat in flight.threats:
        track = frame.array(threat.positions) if threat.positions else np.zeros((0, 3))
        if threat.moves and len(track) > 1:
            axes.plot(track[:, i], track[:, j], color=THREAT, lw=1.2, alpha=0.8, zorder=2)
            inside = np.all((track >= low) & (track <= high), axis=1).nonzero()[0]
            at = inside[len(inside) // 4] if len(inside) > 4 else len(track) // 2
            step = track[min(at + 1, len(track) - 1)] - track[at]
            if np.hypot(step[i], step[j]) > 1e-6:
                axes.annotate("", (track[at, i] + step[i], track[at, j] + step[j]), (track[at, i], track[at, j]),
                              arrowprops={"arrowstyle": "-|>", "color": THREAT, "lw": 1.2, "mutation_scale": 16}, zorder=3, annotation_clip=True)
        place = flight.threat_at(threat, index) if index is not None else None
        if place is None:
            continue
        p = frame.array([place])[0]
        if threat.half_height > 0 and j == 2:
            axes.add_patch(plt.Rectangle((p[i] - threat.radius, p[2] - threat.half_height), 2 * threat.radius,
                                         2 * threat.half_height, color=THREAT, alpha=0.55, lw=0, zorder=5))
        axes.add_patch(Circle((p[i], p[j]), threat.radius, color=THREAT, alpha=0.75, lw=0, zorder=5))
        if np.all(p >= low) and np.all(p <= high):
            axes.annotate(threat.name, (p[i], p[j]), (6, -11), textcoords="offset points", fontsize=8, color="#9a4f08",
                          zorder=7, annotation_clip=True)
    _flown(axes, own, flight, i, j)
    if flight.least_own is not None and flight.least_centre is not None:
        a, b = frame.array([flight.least_own])[0], frame.array([flight.least_centre])[0]
        axes.plot([a[i], b[i]], [a[j], b[j]], color=PROMISE, lw=1.0, ls=":", zorder=6)
        axes.plot([a[i]], [a[j]], "o", color=OWN, mec="white", ms=7, zorder=7)
    axes.set_xlim(low[i], high[i])
    axes.set_ylim(low[j], high[j])
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_xlabel(names[i])
    axes.set_ylabel(names[j])


NAMES = ("along the planned leg [m]", "to the left of it [m]", "height [m]")


def views(flight):
    """Plan and side view at the closest approach."""
    frame = Frame(flight.mission)
    low, high = _window(flight, frame)
    spans = np.maximum(high - low, 1.0)
    wide = 0.9 * WIDTH
    heights = [min(max(wide * spans[1] / spans[0], 1.5), 4.2), min(max(wide * spans[2] / spans[0], 1.2), 3.0)]
    total = sum(heights) + 1.75
    figure = plt.figure(figsize=(WIDTH, total))
    top = figure.add_axes([0.07, (heights[1] + 1.2) / total, 0.915, heights[0] / total])
    side = figure.add_axes([0.07, 0.45 / total, 0.915, heights[1] / total])
    _view(top, flight, frame, 0, 1, low, high, NAMES)
    _view(side, flight, frame, 0, 2, low, high, NAMES)
    top.set_title("seen from above", loc="left", fontsize=9, weight="bold")
    side.set_title("seen from the side", loc="left", fontsize=9, weight="bold")
    top.legend(handles=[
        Line2D([], [], color=INK, lw=0.9, ls=(0, (6, 4)), label="planned leg"),
        Line2D([], [], color=LEG, lw=1.6, label="flown by the mission"),
        Line2D([], [], color=OWN, lw=2.6, label="flown by jink"),
        Line2D([], [], color=THREAT, lw=1.2, label="threat and its way"),
        Line2D([], [], color=OWN, marker="o", ls="", mec="white", ms=7, label="at the closest moment"),
    ], loc="lower right", bbox_to_anchor=(1.01, 1.0), ncol=5, fontsize=8, handlelength=1.6, columnspacing=1.1)
    return _svg(figure)


def _sphere(axes, centre, radius, colour):
    u, v = np.mgrid[0:2 * math.pi:17j, 0:math.pi:9j]
    axes.plot_surface(centre[0] + radius * np.cos(u) * np.sin(v), centre[1] + radius * np.sin(u) * np.sin(v),
                      centre[2] + radius * np.cos(v), color=colour, alpha=0.65, lw=0, shade=True)


def _deep(low, high):
    """The window, no flatter than 0.3 of its longest side, so that a 3D box has space for its labels."""
    span = high - low
    short = np.maximum(0.3 * span.max() - span, 0.0)
    return low - short / 2, high + short / 2


def _box(axes, low, high):
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
    axes.set_zlim(low[2], high[2])
    axes.set_box_aspect(np.maximum(high - low, 1e-3), zoom=1.05)
    axes.tick_params(labelsize=8, pad=-1)
    for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
        axis.set_pane_color((1, 1, 1, 0))
        axis.set_major_locator(matplotlib.ticker.MaxNLocator(4, steps=[1, 2, 5, 10]))


def _label(axes):
    axes.set_xlabel("along [m]", labelpad=4)
    axes.set_ylabel("left [m]", labelpad=2)
    axes.set_zlabel("height [m]", labelpad=0)


def _inside(points, low, high):
    """The points, with points outside blanked: 3D axes do not clip."""
    out = np.array(points, dtype=float)
    out[np.any((out < low) | (out > high), axis=1)] = math.nan
    return out


def space(flight):
    """The same in space."""
    frame = Frame(flight.mission)
    low, high = _deep(*_window(flight, frame))
    figure = plt.figure(figsize=(5.4, 4.4))
    axes = figure.add_axes([0, 0, 1, 1], projection="3d")
    own = _inside(frame.array(flight.own), low, high)
    axes.plot(*own.T, color=LEG, lw=1.4)
    for start, end in flight.spans(lambda m: m == "external"):
        part = [k for k, t in enumerate(flight.t) if start <= t <= end]
        axes.plot(*own[part].T, color=OWN, lw=2.4)
    leg = frame.array(flight.mission)
    if len(leg) >= 2:
        fine = np.vstack([np.linspace(a, b, 200) for a, b in zip(leg[:-1], leg[1:])])
        axes.plot(*_inside(fine, low, high).T, color=INK, lw=0.8, ls=(0, (6, 4)))
    index = flight.closest_index()
    for threat in flight.threats:
        if threat.moves and len(threat.positions) > 1:
            axes.plot(*_inside(frame.array(threat.positions), low, high).T, color=THREAT, lw=1.1)
        place = flight.threat_at(threat, index) if index is not None else None
        if place is not None:
            p = frame.array([place])[0]
            if np.all(p >= low) and np.all(p <= high):
                _sphere(axes, p, threat.radius, THREAT)
    if flight.least_own is not None:
        axes.scatter(*frame.array([flight.least_own]).T, color=OWN, s=28, depthshade=False)
    _box(axes, low, high)
    axes.view_init(elev=24, azim=-118)
    _label(axes)
    return _png(figure)


FAN = {"chosen": (CHOSEN, 2.6, 4), "available": (AVAILABLE, 1.5, 3), "not_flyable": (NOT_FLYABLE, 0.9, 1),
       "not_evaluated": (LEG, 0.9, 0)}


def _fan_style(status):
    return FAN.get(status, (UNAVAILABLE, 1.0, 2))


def _dashes(status):
    """Unchecked candidates are dashed: their state is unknown."""
    return (0, (4, 3)) if status == "not_evaluated" else "solid"


def fan_counts(flight):
    """Number of candidates per group: (chosen, available, in contact, not flyable, not evaluated)."""
    status = [s for s, _ in flight.fan]
    known = {name: status.count(name) for name in ("chosen", "available", "not_flyable", "not_evaluated")}
    return (known["chosen"], known["available"], len(status) - sum(known.values()), known["not_flyable"],
            known["not_evaluated"])


def _candidates(flight):
    frame = Frame(flight.mission)
    curves = [(status, frame.array(points)) for status, points in flight.fan]
    return sorted(curves, key=lambda c: _fan_style(c[0])[2])


def fan(flight):
    """Candidates of the first plan in 3D."""
    curves = _candidates(flight)
    figure = plt.figure(figsize=(5.4, 4.4))
    axes = figure.add_axes([0, 0, 1, 1], projection="3d")
    for status, points in curves:
        colour, width, _ = _fan_style(status)
        axes.plot(*points.T, color=colour, lw=width, linestyle=_dashes(status))
    everything = np.vstack([c for _, c in curves])
    low, high = everything.min(axis=0), everything.max(axis=0)
    margin = np.maximum(0.05 * (high - low), 1.0)
    _box(axes, *_deep(low - margin, high + margin))
    axes.view_init(elev=22, azim=-128)
    _label(axes)
    return _png(figure)


def fan_behind(flight):
    """The same seen from behind, along the leg, each with a dot at its largest offset."""
    curves = _candidates(flight)
    figure, axes = plt.subplots(figsize=(5.4, 3.6))
    figure.subplots_adjust(left=0.11, right=0.98, bottom=0.14, top=0.97)
    for status, points in curves:
        colour, width, order = _fan_style(status)
        axes.plot(points[:, 1], points[:, 2], color=colour, lw=width, linestyle=_dashes(status), zorder=order + 1)
        straight = np.linspace(points[0], points[-1], len(points))
        apex = points[np.argmax(np.linalg.norm(points - straight, axis=1))]
        axes.plot([apex[1]], [apex[2]], "o", color=colour, ms=6 if status == "chosen" else 4.5, zorder=order + 2)
    start = curves[0][1][0]
    axes.plot([start[1]], [start[2]], "s", color=INK, ms=5, zorder=9)
    axes.set_aspect("equal", adjustable="datalim")
    axes.invert_xaxis()
    axes.set_xlabel("to the left  \u2190  [m]  \u2192  to the right")
    axes.set_ylabel("height [m]")
    return _svg(figure)


def random_flights(flights):
    """Least separation of each random flight, without jink and with it."""
    known = [f for f in flights if f.least is not None]
    known.sort(key=lambda f: f.least)
    figure, (dots, bars) = plt.subplots(1, 2, figsize=(WIDTH, 3.4), gridspec_kw={"width_ratios": [1.7, 1], "wspace": 0.18})
    figure.subplots_adjust(left=0.06, right=0.985, bottom=0.14, top=0.97)
    x = np.arange(len(known))
    least = np.array([f.least for f in known])
    alone = np.array([math.nan if f.alone is None else f.alone for f in known])
    promise = max((f.promise for f in known if f.promise is not None), default=None)
    good = np.array([f.kept() is not False for f in known])
    dots.vlines(x, alone, least, color=GRID, lw=1.4, zorder=1)
    dots.plot(x, alone, "x", color=THREAT, ms=5, zorder=3, label="same flight without jink")
    dots.plot(x[good], least[good], "o", color=OWN, ms=4.5, zorder=3, label="with jink")
    if not np.all(good):
        dots.plot(x[~good], least[~good], "D", color=PROMISE, ms=5.5, zorder=4, label="with jink, promise broken")
    bars.hist(least, bins=min(20, max(5, len(known) // 3)), color=OWN, alpha=0.85, rwidth=0.92)
    if promise is not None:
        dots.axhline(promise, color=PROMISE, lw=1.2, ls="--", label=f"promise: {promise:g} m")
        bars.axvline(promise, color=PROMISE, lw=1.2, ls="--")
    dots.axhline(0.0, color=INK, lw=0.8)
    dots.set_xlabel("flights, in order of their least separation")
    dots.set_ylabel("least separation [m]")
    dots.set_xticks([])
    dots.legend(loc="upper left", fontsize=8.5)
    bars.set_xlabel("least separation with jink [m]")
    bars.set_ylabel("flights")
    return _svg(figure)


def plan_times(flights):
    """Histogram of the times that planning steps took."""
    figure, axes = plt.subplots(figsize=(WIDTH, 2.6))
    figure.subplots_adjust(left=0.06, right=0.985, bottom=0.19, top=0.96)
    single = [t for f in flights for t in f.plan_times_us]
    worst = [f.plan_worst_us for f in flights if f.plan_worst_us]
    mean = [f.plan_mean_us for f in flights if f.plan_mean_us]
    groups = [(single, OWN, "single steps")] if single else [(mean, AVAILABLE, "mean of each flight"),
                                                            (worst, OWN, "longest of each flight")]
    everything = [t / 1000.0 for values, _, _ in groups for t in values if t > 0]
    low, high = min(everything), max(max(everything), 2 * LATE_MS)
    bins = np.geomspace(low * 0.9, high * 1.1, 36)
    for values, colour, label in groups:
        axes.hist([t / 1000.0 for t in values], bins=bins, color=colour, alpha=0.75, label=label)
    axes.axvline(LATE_MS, color=PROMISE, lw=1.2, ls="--", label=f"a step is due every {LATE_MS:g} ms")
    axes.set_xscale("log")
    axes.xaxis.set_major_formatter(matplotlib.ticker.FormatStrFormatter("%g"))
    axes.set_xlabel("time of a step that planned, on the machine that ran the demo [ms]")
    axes.set_ylabel("steps" if single else "flights")
    axes.legend(loc="upper center", fontsize=8.5)
    return _svg(figure)
