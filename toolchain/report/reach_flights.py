#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Draws plan views of flown scenes from the standard input, as written by `jink scenes --out`, one PNG each."""
import pathlib
import sys

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.patches import Circle, Rectangle

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import pictures  # noqa: E402 (found beside this script)
from pictures import INK, WIDTH  # noqa: E402

BODY, EDGE, MOVES = "#c9ced6", "#8b939f", "#b3462f"
COLOURS = {"straight": "#9aa1ab", "geometric": "#d17a22", "geometric, reach sets": "#1f6fb2", "reach sets, geometric": "#2e8b57",
           "reach sets": "#8e5bb5"}
ROOM = 8.0  # margin about the drawn objects [m]


def draw_body(axes, body):
    x, y, _ = body["from"]
    if body["form"] == "area":
        axes.add_patch(Circle((x, y), body["radius"], facecolor=MOVES, alpha=0.2, lw=0, zorder=1))
        axes.add_patch(Circle((x, y), body["radius"] + body["margin"], fill=False, edgecolor=MOVES, ls=(0, (3, 3)), lw=0.8, zorder=1))
        axes.annotate("", body["to"][:2], (x, y), arrowprops={"arrowstyle": "->", "color": MOVES, "lw": 1.0, "alpha": 0.7}, zorder=2,
                      annotation_clip=True)
    elif body["moves"]:
        axes.annotate("", body["to"][:2], (x, y), arrowprops={"arrowstyle": "->", "color": MOVES, "lw": 1.0, "alpha": 0.7}, zorder=2,
                      annotation_clip=True)
        axes.add_patch(Circle((x, y), body["radius"], color=MOVES, lw=0, zorder=2))
    elif body["form"] == "box":
        a, b, _ = body["half_extents"]
        axes.add_patch(Rectangle((x - a, y - b), 2 * a, 2 * b, facecolor=BODY, edgecolor=EDGE, lw=0.8, zorder=1))
        axes.text(x, y, f"{body['from'][2] + body['half_extents'][2]:.0f} m", ha="center", va="center", fontsize=7, color=EDGE, zorder=2)
    else:
        axes.add_patch(Circle((x, y), body["radius"], facecolor=EDGE, edgecolor=INK, lw=0.4, zorder=1))


def label_of(flight):
    how = f"at the goal after {flight['end'] - 2.0:.0f} s" if flight["goal"] else "not at the goal"
    return f"{flight['by']}: {how}, least {flight['least']:.1f} m"


def view(axes, scene, coordinate):
    for order, flight in enumerate(scene["flights"]):
        path = np.array(flight["path"])
        colour = COLOURS.get(flight["by"], f"C{order}")
        style = (0, (4, 3)) if flight["by"] == "straight" else "-"
        axes.plot(path[:, 0], path[:, coordinate], color=colour, lw=1.3, ls=style, label=label_of(flight), zorder=3 + order)
        if not flight["goal"]:
            axes.plot(path[-1, 0], path[-1, coordinate], "s", color=colour, ms=5, zorder=10)
        axes.plot(flight["at"][0], flight["at"][coordinate], "o", mfc="white", mec=colour, ms=4, zorder=11)


def draw(scene):
    mission = np.array(scene["mission"])
    paths = np.concatenate([np.array(flight["path"]) for flight in scene["flights"]] + [mission])
    low, high = paths.min(axis=0) - ROOM, paths.max(axis=0) + ROOM
    bodies = [body for body in scene["bodies"] if not body["moves"]]
    for body in bodies:
        low[:2], high[:2] = np.minimum(low[:2], np.subtract(body["from"][:2], body.get("margin", 0.0))), np.maximum(high[:2], body["from"][:2])
    tall = (high[1] - low[1]) / (high[0] - low[0])
    figure, axes = plt.subplots(3, 1, figsize=(WIDTH, WIDTH * 0.9 * tall + 3.2), layout="constrained",
                                height_ratios=[WIDTH * 0.9 * tall, 1.7, 0.5])
    for body in scene["bodies"]:
        draw_body(axes[0], body)
    view(axes[0], scene, 1)
    axes[0].plot(*mission[-1][:2], "*", color=INK, ms=9, zorder=12)
    axes[0].set_xlim(low[0], high[0])
    axes[0].set_ylim(low[1], high[1])
    axes[0].set_aspect("equal")
    axes[0].set_ylabel("north [m]")
    view(axes[1], scene, 2)
    axes[1].set_xlim(low[0], high[0])
    axes[1].set_ylabel("height [m]")
    axes[1].set_xlabel("east [m]")
    figure.suptitle(scene["title"], fontsize=10, weight="bold")
    handles, labels = axes[0].get_legend_handles_labels()
    axes[2].axis("off")
    axes[2].legend(handles, labels, loc="center", ncols=3, frameon=False, fontsize=8)
    return figure, scene["name"] + ".png"


if __name__ == "__main__":
    sys.exit(pictures.main("jink scenes", lambda scenes: map(draw, scenes)))
