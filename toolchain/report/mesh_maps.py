#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Draws maps of convex pieces from the standard input, as written by `jink mesh measure --figures`, all in one PNG."""
import pathlib
import sys

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import PolyCollection

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import pictures  # noqa: E402 (found beside this script)
from pictures import INK, WIDTH  # noqa: E402


def outline(points):
    """Convex hull of points of a plane, counter-clockwise (Andrew 1979)."""
    points = sorted(set(map(tuple, points)))
    if len(points) < 3:
        return points

    def half(some):
        chain = []
        for p in some:
            while len(chain) >= 2 and ((chain[-1][0] - chain[-2][0]) * (p[1] - chain[-2][1])
                                       - (chain[-1][1] - chain[-2][1]) * (p[0] - chain[-2][0])) <= 0:
                chain.pop()
            chain.append(p)
        return chain[:-1]

    return half(points) + half(points[::-1])


def view(axes, data, across, up):
    pieces = [outline([(v[across], v[up]) for v in piece]) for piece in data["pieces"]]
    colours = plt.cm.tab20(np.arange(len(pieces)) % 20)
    axes.add_collection(PolyCollection([p for p in pieces if len(p) > 2], facecolors=colours, edgecolors=colours, alpha=0.35,
                                       linewidths=0.8))
    axes.add_collection(PolyCollection([[(v[across], v[up]) for v in t] for t in data["mesh"]], facecolors="none",
                                       edgecolors=INK, linewidths=0.3))
    axes.autoscale_view()
    axes.set_aspect("equal")


def draw(maps):
    figure, rows = plt.subplots(2, len(maps), figsize=(WIDTH, 0.5 * WIDTH), layout="constrained", squeeze=False)
    for data, above, beside in zip(maps, rows[0], rows[1]):
        view(above, data, 0, 1)
        view(beside, data, 0, 2)
        above.set_title(f"{data['name']}: {len(data['pieces'])} pieces,\n{data['bytes'] / 1024:.1f} KiB, stand out "
                        f"{data['excess']:.2f} m", loc="left", fontsize=8)
        beside.set_xlabel("east [m]")
    rows[0][0].set_ylabel("from above: north [m]")
    rows[1][0].set_ylabel("from the side: up [m]")
    return figure, "maps.png"


if __name__ == "__main__":
    sys.exit(pictures.main("jink mesh measure", lambda maps: [draw(maps)]))
