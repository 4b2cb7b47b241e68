# SPDX-License-Identifier: BSD-3-Clause
"""The figures of docs/evidence/timing, as SVG: the same bytes from the same counts and the same matplotlib."""
import io

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402 (the backend must be chosen first)

import records  # noqa: E402
import stages  # noqa: E402

VERSION = matplotlib.__version__
TITLES = {"mps2_an500": "Cortex-M7", "stm32f405": "Cortex-M4F (F405)", "armhf": "ARM Linux, 32 bits", "aarch64": "ARM Linux, 64 bits"}
INK, GRID, BAR, WORST, GOAL = "#2b2f36", "#d9dde3", "#5b8fc7", "#c62828", "#1e9e3e"
COLOURS = ["#8a93a0", "#c9b458", "#a68a64", "#6f9f6f", "#1d5fa8", "#4db6ac", "#90a4ae", "#7e57c2", "#5bb8e8", "#b0bec5", "#e07b1a",
           "#9ccc65", "#c62828", "#f48fb1", "#ffd54f", "#00897b", "#37474f", "#ff7043", "#80cbc4", "#8e3fa8", "#5d4037", "#9fa8da"]

plt.rcParams.update({
    "font.family": "sans-serif", "font.size": 9, "axes.edgecolor": "#8a93a0", "axes.labelcolor": INK, "text.color": INK,
    "xtick.color": INK, "ytick.color": INK, "axes.grid": True, "grid.color": GRID, "grid.linewidth": 0.6, "axes.axisbelow": True,
    "axes.spines.top": False, "axes.spines.right": False, "legend.frameon": False, "svg.fonttype": "none", "svg.hashsalt": "jink",
})


def _svg(figure):
    buffer = io.BytesIO()
    figure.savefig(buffer, format="svg", metadata={"Date": None, "Creator": None})
    plt.close(figure)
    return buffer.getvalue()


def _edges():
    return [10 ** (4 + i / records.PER_DECADE) for i in range(records.PER_DECADE * records.DECADES + 1)]


def histogram(counts, sample, worst, goal=None):
    """Random problems of one kind on every target, and the worst case of the hunt."""
    figure, axes = plt.subplots(4, 1, figsize=(8.4, 6.8), sharex=True, layout="constrained")
    edges = _edges()
    for axis, target in zip(axes, records.TARGETS):
        values = counts[target]["typical"][sample]
        axis.bar(edges[:-1], values["bins"], width=[b - a for a, b in zip(edges, edges[1:])], align="edge", color=BAR, edgecolor="white",
                 linewidth=0.3)
        axis.set_xscale("log")
        axis.set_xlim(1e4, 1e8)
        axis.axvline(worst[target], color=WORST, linewidth=1.6)
        axis.annotate(f"worst found {worst[target]:,}".replace(",", " "), (worst[target], 0.86), xycoords=("data", "axes fraction"),
                      xytext=(4, 0), textcoords="offset points", color=WORST, fontsize=8)
        if goal and target == "mps2_an500":
            axis.axvline(goal, color=GOAL, linewidth=1.2, linestyle="--")
            axis.annotate(f"goal {goal:,}".replace(",", " "), (goal, 0.6), xycoords=("data", "axes fraction"), xytext=(4, 0),
                          textcoords="offset points", color=GOAL, fontsize=8)
        axis.set_title(f"{TITLES[target]}: {values['cases']} random problems", loc="left", fontsize=9)
        axis.set_ylabel("problems")
    axes[-1].set_xlabel("instructions")
    return _svg(figure)


def bars(rows):
    """One bar a row, cut into stages. `rows`: (label, {stage: instructions})."""
    figure, axis = plt.subplots(figsize=(8.4, 1.2 + 0.42 * len(rows)), layout="constrained")
    used = [name for name in stages.NAMES if any(stage.get(name, 0) > 0.01 * sum(stage.values()) for _, stage in rows)]
    for y, (_, stage) in enumerate(rows):
        total = sum(stage.values())
        left = 0.0
        for name in used:
            share = 100.0 * stage.get(name, 0) / total
            axis.barh(y, share, left=left, height=0.68, color=COLOURS[stages.NAMES.index(name)], label=name if y == 0 else None)
            left += share
        axis.barh(y, 100.0 - left, left=left, height=0.68, color=GRID, label="less than 1 % each" if y == 0 else None)
        axis.annotate(f"{total:,}".replace(",", " "), (100.5, y), va="center", fontsize=8, annotation_clip=False)
    axis.set_yticks(range(len(rows)), [label for label, _ in rows])
    axis.invert_yaxis()
    axis.set_xlim(0, 100)
    axis.grid(axis="y", visible=False)
    axis.set_xlabel("share of the instructions [%]; at the right how many")
    axis.legend(loc="upper center", bbox_to_anchor=(0.45, -0.55 / (0.42 * len(rows)) - 0.02), ncols=4, fontsize=8)
    return _svg(figure)


def host(values):
    """Wall time of plans on the host."""
    figure, axis = plt.subplots(figsize=(8.4, 3.0), layout="constrained")
    edges = [10 ** (i / 20) for i in range(len(values["bins"]) + 1)]
    axis.bar(edges[:-1], values["bins"], width=[b - a for a, b in zip(edges, edges[1:])], align="edge", color=BAR, edgecolor="white", linewidth=0.3)
    axis.set_xscale("log")
    axis.set_yscale("log")
    axis.set_xlim(1, 1e5)
    for key, label, colour in (("most_us", "most", WORST), ("costliest_us", "costliest without noise", GOAL)):
        axis.axvline(values[key], color=colour, linewidth=1.4)
        axis.annotate(label, (values[key], 0.9), xycoords=("data", "axes fraction"), xytext=(4, 0), textcoords="offset points", color=colour,
                      fontsize=8)
    axis.set_title(f"{values['plans']:,} random plans, {values['how']}".replace(",", " ", 2), loc="left", fontsize=9)
    axis.set_xlabel("wall time [us]")
    axis.set_ylabel("plans")
    return _svg(figure)
