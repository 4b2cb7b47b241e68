# SPDX-License-Identifier: BSD-3-Clause
"""Common style and output of the pictures of jink's commands, whose data come on standard input."""
import json
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402 (the backend must be chosen first)
import numpy as np  # noqa: E402
from PIL import Image  # noqa: E402 (matplotlib needs it too)

INK = "#2b2f36"
WIDTH = 12.0  # [in]

plt.rcParams.update({"font.family": "sans-serif", "font.size": 9, "text.color": INK, "axes.labelcolor": INK,
                     "xtick.color": INK, "ytick.color": INK, "axes.spines.top": False, "axes.spines.right": False})


def save(figure, path):
    """128 colours give a third of the size. Without date and version, so that drawing again gives the same bytes."""
    figure.set_dpi(90)
    figure.canvas.draw()
    pixels = Image.fromarray(np.asarray(figure.canvas.buffer_rgba())[:, :, :3])
    plt.close(figure)
    pixels.quantize(128, dither=Image.Dither.NONE).save(path, optimize=True)


def main(command, figures_of):
    """Writes the figures of figures_of(input), (figure, name), into the folder. Returns the exit status."""
    if len(sys.argv) != 2:
        print(f"usage: {pathlib.Path(sys.argv[0]).name} FOLDER < JSON", file=sys.stderr)
        return 2
    folder = pathlib.Path(sys.argv[1])
    for figure, name in figures_of(json.load(sys.stdin)):
        try:
            save(figure, folder / name)
        except OSError as error:
            print(f"{command}: {error.filename} cannot be written: {error.strerror}", file=sys.stderr)
            return 2
        print(folder / name)
    return 0
