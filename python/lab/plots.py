# SPDX-License-Identifier: BSD-3-Clause
"""The figures of the result pages."""

import matplotlib
import numpy as np

from lab import scores, tables

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402, after the choice of a backend


def bars(path, ylabel, groups, series):
    """Bars side by side in each group; `series` are names and a value a group."""
    path.parent.mkdir(exist_ok=True)
    figure, axes = pyplot.subplots(figsize=(8, 3), layout="constrained")
    width = 0.8 / len(series)
    for i, (name, values) in enumerate(series.items()):
        axes.bar(np.arange(len(groups)) + (i - (len(series) - 1) / 2) * width, values, width,
                 label=name)
    axes.axhline(0, color="black", linewidth=0.8)
    axes.set(xticks=range(len(groups)), xticklabels=groups, ylabel=ylabel)
    axes.legend(frameon=False)
    figure.savefig(path, dpi=100)
    pyplot.close(figure)
    return path


def page(found, out):
    """Gain over the network by street, and IoU by class. Returns the files."""
    gains = {street: found.gains(tables.DEPTH, [street]) for street in found.streets}
    streets = sorted(gains, key=lambda street: round(gains[street][1][0], 1))
    first = bars(out / "results_gain.png", "mean IoU over network", streets,
                 {"map": [gains[each][1][0] for each in streets],
                  "map, final": [gains[each][2][0] for each in streets],
                  "calibrated": [gains[each][3][0] for each in streets]})
    series = {}
    for name, model, prediction in (("2D network", "dense", "network_labels"),
                                    ("map", "dense", tables.DEPTH),
                                    ("calibrated", "calibrated_dense", tables.DEPTH)):
        figures = found.figures(found.streets, model, prediction, covered=tables.DEPTH)
        series[name] = [figures[each] for each in scores.CLASSES if each in figures]
    classes = [each for each in scores.CLASSES if each not in scores.IGNORED]
    return [first, bars(out / "results_classes.png", "IoU", classes, series)]


def appendix(found, out):
    """Mean IoU by distance."""
    series = {}
    for name, model, prediction in (("2D network", "dense", "network_labels"),
                                    ("map", "dense", tables.RENDERED),
                                    ("calibrated", "calibrated_dense", tables.RENDERED)):
        series[name] = [found.figures(found.streets, model, prediction, covered=tables.RENDERED,
                                      band=band)["mean"] for band in tables.BANDS]
    bands = [f"{a}-{b} m" for a, b in tables.BANDS]
    return [bars(out / "results_distance.png", "mean IoU", bands, series)]
