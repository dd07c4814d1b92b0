# SPDX-License-Identifier: BSD-3-Clause
"""Scores of folders of label images (.png) or labels of scans (.label), with the figures of
pcl_semantic_evaluate: percent, exclusive unless it says inclusive."""

import json
from functools import lru_cache
from pathlib import Path

import numpy as np

import pcl_semantic
from lab import files

CLASSES = [each["name"] for each in files.label_set()]
IGNORED = ("sky", "pedestrian", "cyclist")
SCANS = ("--label-set", files.KITTI_CLASSES, "--label-mapping",
         files.ROOT / "data/label_mappings/semantic_kitti_to_kitti11.yaml")


def read_labels(path):
    path = Path(path)
    return files.read_scan_labels(path) if path.suffix == ".label" else files.read_image(path)


def read_depths(folder, name):
    if name.endswith(".label"):
        return files.read_array(Path(folder) / name.replace(".label", ".bin"), "<f4")
    return files.read_image(Path(folder) / name) / 256


@lru_cache(maxsize=None)
def confusion(prediction, truth, covered_by=None, depth=None, band=None):
    """Counts by true and predicted label over the files of a folder of ground truth: those
    that another folder covers, and whose depth lies in a band [m], if these are given."""
    total = 0
    for path in sorted(p for p in Path(truth).iterdir() if p.suffix in (".png", ".label")):
        labels, predicted = read_labels(path), read_labels(Path(prediction) / path.name)
        if labels.shape != predicted.shape:
            raise ValueError(f"{path}: the prediction has another size")
        if covered_by:
            labels = np.where(read_labels(Path(covered_by) / path.name) > 0, labels, 0)
        if band:
            depths = read_depths(depth, path.name)
            within = (depths > 0) & (depths >= band[0]) & (depths < band[1])
            labels = np.where(within, labels, 0)
        total = total + pcl_semantic.confusion_matrix(labels, predicted, len(CLASSES))
    return total


def figures(counts, ignored=IGNORED):
    """IoU of each class by its name, then mean, global accuracy, mean inclusive, coverage."""
    counts = counts.copy()
    counts[[CLASSES.index(each) + 1 for each in ignored]] = 0  # as if it had no truth
    found = pcl_semantic.scores(counts)
    result = {name: 100 * iou for name, iou in zip(CLASSES, found["iou"]) if name not in ignored}
    for title, key in (("mean", "mean_iou"), ("global accuracy", "global_accuracy"),
                       ("mean inclusive", "mean_iou_inclusive"), ("coverage", "coverage")):
        result[title] = 100 * found[key]
    return result


def evaluate(predictions, truths, covered_by, *options):
    """What pcl_semantic_evaluate finds in folders, pooled."""
    arguments = list(options)
    for folders in zip(predictions, truths, covered_by):
        for option, folder in zip(("--prediction", "--truth", "--covered-by"), folders):
            arguments += [option, folder]
    return json.loads(files.program("evaluate", "--json", *arguments))


@lru_cache(maxsize=None)
def panoptic(predictions, covered_by, truths):
    """Panoptic quality of the things of one or more sequences, in percent, and the number of
    true segments; all classes are pooled. Folders of .label files; the ground truth is
    SemanticKITTI's."""
    found = evaluate(predictions, truths, covered_by, "--panoptic", *SCANS)
    things = [each for each in found["classes"] if each["thing"]]
    matched = sum(each["matched"] for each in things)
    segments = sum(each["segments"] for each in things)
    false = sum(each["false_positives"] for each in things)
    quality = sum(each["sq"] * each["matched"] for each in things if each["matched"])
    size = matched + (false + segments - matched) / 2
    return 100 * quality / size if size else np.nan, segments


def gains_row(name, network, gains):
    """Pairs of mean IoU and global accuracy, of the network and of maps above it."""
    cells = [f"{network[0]:.1f} / {network[1]:.1f}"]
    cells += [f"{iou:+.1f} / {accuracy:+.1f}" for iou, accuracy in gains]
    return f"| {name} | {' | '.join(cells)} |"


def header(titles):
    return [f"| | {' | '.join(titles)} |", "|---|" + "---:|" * len(titles)]


def row(name, values):
    cells = ("-" if np.isnan(value) else f"{value:.1f}" for value in values)
    return f"| {name} | {' | '.join(cells)} |"
