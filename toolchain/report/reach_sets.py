#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Draws reach sets from the standard input, as written by `jink reach measure --figures`, one PNG each."""
import math
import pathlib
import sys

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import LineCollection

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import pictures  # noqa: E402 (found beside this script)
from pictures import INK, WIDTH  # noqa: E402

GRID = "#c9ced6"
FLATTEST = 0.34  # of a view's width: flatter views are stretched, with a note


def grid_lines(half, parts, layers, distance):
    """Faces of the grid's cells in the plane through the vehicle: rays, and an arc for each layer."""
    lines = []
    for part in range(parts + 1):
        angle = half * (2 * part / parts - 1)
        lines.append([(0.0, 0.0), (distance * math.cos(angle), distance * math.sin(angle))])
    angles = np.linspace(-half, half, 61)
    for layer in range(1, layers + 1):
        reach = distance * layer / layers
        lines.append(np.column_stack([reach * np.cos(angles), reach * np.sin(angles)]))
    return lines


def view(axes, data, coordinate, half, parts, title):
    movements = sorted(data["movements"], key=lambda m: m["smoothness"])
    lines = [[(p[0], p[coordinate]) for p in m["points"]] for m in movements]
    axes.add_collection(LineCollection(grid_lines(half, parts, data["layers"], data["distance"]), colors=GRID,
                                       linewidths=0.6, zorder=1))
    drawn = LineCollection(lines, array=np.array([m["smoothness"] for m in movements]), cmap="viridis_r",
                           norm=plt.Normalize(0.0, 1.0), linewidths=0.7, zorder=2)
    axes.add_collection(drawn)
    high = data["distance"] * math.sin(half) * 1.05
    axes.set_xlim(-0.02 * data["distance"], 1.02 * data["distance"])
    axes.set_ylim(-high, high)
    stretch = max(1.0, FLATTEST * data["distance"] * 1.04 / (2 * high))
    axes.set_aspect(stretch)
    if stretch > 1.0:
        title += f", heights {stretch:.1f} times larger" if coordinate == 2 else f", widths {stretch:.1f} times larger"
    axes.set_title(title, loc="left", fontsize=9)
    return drawn


def height_share(half):
    return max(FLATTEST, 2.1 * math.sin(half) / 1.04)


def draw(data):
    tall = max(height_share(data["horizontal"]), height_share(data["vertical"]))
    figure, axes = plt.subplots(1, 2, figsize=(WIDTH, 0.44 * WIDTH * tall + 0.9), layout="constrained")
    drawn = view(axes[0], data, 1, data["horizontal"], data["columns"], "seen from above")
    view(axes[1], data, 2, data["vertical"], data["rows"], "seen from the side")
    axes[0].set_ylabel("left [movements]")
    axes[1].set_ylabel("up [movements]")
    for ax in axes:
        ax.set_xlabel("ahead [movements]")
    figure.suptitle(f"{data['name']}: {len(data['movements']) + 1} nodes", fontsize=10, weight="bold")
    figure.colorbar(drawn, ax=axes, label="smoothness of the best trajectory through it", shrink=0.7, pad=0.01)
    name = data["name"].replace(" ", "_").replace("/", "-").replace(",", "") + ".png"
    return figure, name


if __name__ == "__main__":
    sys.exit(pictures.main("jink reach measure", lambda sets: map(draw, sets)))
