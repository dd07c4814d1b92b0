# SPDX-License-Identifier: BSD-3-Clause
"""Learns a calibration of a network's probabilities from sequences with ground truth
(doc/calibration.md): calibration.yaml for pcl_semantic_map --label-calibration,
without_NAME.yaml for each sequence, learned from the others, and report.md."""

import argparse
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace

import numpy as np
from scipy import optimize, sparse

import pcl_semantic
from lab import files, scores

LEAST = 1e-4  # smaller probabilities of a network carry no information
KNOTS = {
    "height": [-0.5, -0.15, 0, 0.1, 0.2, 0.4, 0.8, 1.4, 2, 3, 5],
    "distance": [5, 10, 15, 20, 30, 40],
    "level": [0, 0.3, 0.6, 0.85, 1],
    "side": [0, 2, 4, 6, 9, 13, 20],
    "brightness": [0.05, 0.15, 0.25, 0.35, 0.5, 0.7, 0.9],
    "red": [0.24, 0.28, 0.31, 0.33, 0.35, 0.38, 0.44],
    "green": [0.24, 0.28, 0.31, 0.33, 0.35, 0.38, 0.44]}
DEFAULTS = SimpleNamespace(features=("height", "distance", "level"), balance=0.5, shrinkage=0.5,
                           bias_penalty=0.001, curve_penalty=0.0003, first=0, end=np.inf,
                           stereo={})


@dataclass
class Samples:
    """Ground truth pixels of a sequence, N of them."""
    network: np.ndarray   # N x L
    features: np.ndarray  # N x 7, in the order of pcl_semantic.pixel_feature_names
    truth: np.ndarray     # N, 1..L
    frames: list          # of each frame the histograms of its features, by feature


@dataclass
class Calibration:
    """p'(l) ~ p(l)^s exp(b_l + sum of curves) of the fitted classes."""
    sharpness: float
    labels: np.ndarray  # the fitted classes, from 1
    bias: np.ndarray    # of each of them
    curves: dict        # by feature: fitted classes x knots
    seen: dict          # by feature: L x knots, shares of the training pixels
    usual_distance: float = 0.0


def weights_on(knots, values):
    """Of each value its two weights on the knots, N x K, linear between them and constant
    beyond; NaN has none."""
    knots = np.asarray(knots, float)
    known = np.flatnonzero(np.isfinite(values))
    inside = np.clip(values[known], knots[0], knots[-1])
    first = np.searchsorted(knots[1:-1], inside, side="right")
    share = (inside - knots[first]) / (knots[first + 1] - knots[first])
    return sparse.csr_matrix(
        (np.concatenate([1 - share, share]),
         (np.tile(known, 2), np.concatenate([first, first + 1]))), (len(values), len(knots)))


def column(features, name):
    return features[:, pcl_semantic.pixel_feature_names.index(name)].astype(float)


def design(features, names):
    """A constant and the weights on the knots of each feature, N x columns."""
    blocks = [weights_on(KNOTS[name], column(features, name)) for name in names]
    return sparse.hstack([np.ones((len(features), 1)), *blocks], "csr")


def balanced_weights(sequences, balance):
    """Sum 1: equal for every sequence, and within it the number of pixels to the power of
    1 - balance for every class."""
    weights = []
    for truth in sequences:
        classes, inverse, numbers = np.unique(truth, return_inverse=True, return_counts=True)
        weights.append((numbers ** -balance)[inverse] / (numbers ** (1 - balance)).sum())
    return np.concatenate(weights) / len(sequences)


def fit(sequences, given=DEFAULTS):
    """Maximises the penalised likelihood, which is concave, then shrinks bias and curves."""
    truth = np.concatenate([each.truth for each in sequences])
    labels, true = np.unique(truth, return_inverse=True)
    if len(labels) < 2:
        raise ValueError("ground truth has fewer than two classes, expected two or more")
    network = np.concatenate([each.network for each in sequences])
    logs = np.log(np.maximum(network[:, labels - 1], LEAST)).astype(float)
    rows = design(np.concatenate([each.features for each in sequences]), given.features)
    weights = balanced_weights([each.truth for each in sequences], given.balance)
    penalty = np.full((rows.shape[1], 1), given.curve_penalty)
    penalty[0] = given.bias_penalty
    every = np.arange(len(true))

    def loss(x):
        values = x[1:].reshape(rows.shape[1], len(labels))
        score = x[0] * logs + rows @ values
        score -= score.max(1, keepdims=True)
        of_truth = score[every, true]
        score = np.exp(score)
        total = score.sum(1)
        value = weights @ (np.log(total) - of_truth) + (penalty * values ** 2).sum()
        score *= (weights / total)[:, None]
        score[every, true] -= weights
        slope = rows.T @ score + 2 * penalty * values
        return value, np.concatenate([[(score * logs).sum()], slope.ravel()])
    start = np.zeros(1 + rows.shape[1] * len(labels))
    start[0] = 1
    found = optimize.minimize(loss, start, jac=True, method="L-BFGS-B",
                              bounds=[(0, None)] + [(None, None)] * (len(start) - 1),
                              options={"maxiter": 500, "maxfun": 1000, "gtol": 1e-6,
                                       "ftol": 1e-8})
    values = found.x[1:].reshape(rows.shape[1], len(labels)) * (1 - given.shrinkage)
    curves, at = {}, 1
    for name in given.features:
        curves[name] = values[at:at + len(KNOTS[name])].T
        at += len(KNOTS[name])
    return Calibration(found.x[0], labels, values[0], curves, {})


def apply(calibration, network, features):
    """The classes that are not fitted keep their probability."""
    score = calibration.sharpness * np.log(np.maximum(network[:, calibration.labels - 1], LEAST))
    score = score + calibration.bias
    for name, values in calibration.curves.items():
        score += weights_on(KNOTS[name], column(features, name)) @ values.T
    score = np.exp(score - score.max(1, keepdims=True))
    result = network.astype(float)
    mass = result[:, calibration.labels - 1].sum(1, keepdims=True)
    result[:, calibration.labels - 1] = score * mass / score.sum(1, keepdims=True)
    return result


def histogram(name, network, features):
    """Shares of the pixels by class of the network and knot of a feature, L x K."""
    shares = np.zeros((network.shape[1], len(KNOTS[name])))
    rows = weights_on(KNOTS[name], column(features, name))
    best = np.where(network.any(1), network.argmax(1), -1)
    for label in range(network.shape[1]):
        shares[label] = rows[best == label].sum(0)
    return shares / max(shares.sum(), 1e-30)


def mean_histograms(sequences):
    mean = {}
    for each in sequences:
        for frame in each.frames:
            for name, shares in frame.items():
                mean[name] = mean.get(name, 0) + shares / len(each.frames)
    return {name: shares / max(shares.sum(), 1e-30) for name, shares in mean.items()}


def distance(frame, others):
    """Mean total variation; NaN without a common feature."""
    both = [abs(frame[name] - others[name]).sum() / 2 for name in frame
            if name in others and frame[name].any() and others[name].any()]
    return np.mean(both) if both else np.nan


def learn(sequences, given=DEFAULTS):
    """fit(), and the data that it has seen. The usual distance is the largest one of a sequence
    (the median of its frames) from the others."""
    calibration = fit(sequences, given)
    calibration.seen = mean_histograms(sequences)
    for one in sequences:
        others = mean_histograms([each for each in sequences if each is not one])
        found = [distance(frame, others) for frame in one.frames]
        found = sorted(each for each in found if np.isfinite(each))
        if found:
            calibration.usual_distance = max(calibration.usual_distance, found[len(found) // 2])
    return calibration


def as_yaml(calibration, ground, names):
    """Text for pcl_semantic_map --label-calibration (doc/formats.md)."""
    def numbers(values):
        return "[" + ", ".join(f"{value:.9g}" for value in values) + "]"
    lines = [f"sharpness: {calibration.sharpness:.9g}", f"ground: [{', '.join(ground)}]",
             "knots:" + ("" if calibration.curves else " {}")]
    lines += [f"  {name}: {numbers(KNOTS[name])}" for name in calibration.curves]
    lines.append("classes:")
    for i, label in enumerate(calibration.labels):
        lines += [f"  {names[label - 1]}:", f"    bias: {calibration.bias[i]:.9g}"]
        lines += [f"    {name}: {numbers(values[i])}"
                  for name, values in calibration.curves.items()]
    if calibration.curves:
        lines += ["seen:", f"  usual_distance: {calibration.usual_distance:.9g}"]
    for name, shares in calibration.seen.items():
        lines.append(f"  {name}:" + ("" if shares.any() else " {}"))
        lines += [f"    {names[label]}: {numbers(shares[label])}"
                  for label in range(len(names)) if shares[label].any()]
    return "\n".join(lines) + "\n"


def stereo_camera(folder):
    """Camera for pixel_features(), without its image size, and the folders of the images."""
    rows = files.calibration_rows(folder)
    first = 2 if (folder / "image_2").is_dir() else 0
    left, right = (rows[f"P{first + i}"] for i in (0, 1))
    camera = [left[0, 0], left[1, 1], left[0, 2], left[1, 2],
              (left[0, 3] - right[0, 3]) / left[0, 0]]
    return camera, [folder / f"image_{first + i}" for i in (0, 1)]


def read_samples(sequence, labels, truth, ground, given):
    """Of a folder in KITTI's layout; `labels` holds distributions, `truth` label images."""
    camera, folders = stereo_camera(Path(sequence))
    parts, histograms = [], []
    for number, path in files.frames(truth, ".png").items():
        if not given.first <= number < given.end:
            continue
        images = [files.read_image(folder / path.name) for folder in folders]
        right = files.read_image(path)
        if right.shape != images[0].shape[:2]:
            raise ValueError(f"{path}: has {right.shape} pixels, its image {images[0].shape[:2]}")
        network = files.read_distributions(labels, number, right.shape)
        network = network.reshape(-1, network.shape[2])
        if right.max() > network.shape[1]:
            raise ValueError(f"{path}: has labels up to {right.max()}, expected up to "
                             f"{network.shape[1]}")
        features = pcl_semantic.pixel_features(*images, [*camera, *right.shape[::-1]], network,
                                               ground=ground, **given.stereo)
        features, right = features.reshape(len(network), -1), right.ravel()
        counted = (right > 0) & network.any(1)
        parts.append((network[counted], features[counted], right[counted].astype(int)))
        histograms.append({name: histogram(name, network, features) for name in given.features})
    if not parts:
        raise ValueError(f"{truth}: has no ground truth image of a frame of {sequence}")
    return Samples(*(np.concatenate(each) for each in zip(*parts)), histograms)


def counts(samples, distributions):
    return pcl_semantic.confusion_matrix(samples.truth.astype(np.uint8),
                                         (distributions.argmax(1) + 1).astype(np.uint8),
                                         distributions.shape[1])


def report(sequences, whole, without, names):
    """IoU of each class, mean, global accuracy of the ground truth pixels."""
    def row(title, total):
        found = pcl_semantic.scores(total)
        return scores.row(title, 100 * np.array([*found["iou"], found["mean_iou"],
                                                 found["global_accuracy"]]))
    lines = ["# Pixels with ground truth, before any map", "",
             *scores.header([*names, "mean", "global accuracy"]),
             row("the network", sum(counts(each, each.network) for each in sequences)),
             row("calibrated, learned from all",
                 sum(counts(each, apply(whole, each.network, each.features))
                     for each in sequences))]
    if without:
        lines.append(row("calibrated, learned from the others", sum(
            counts(each, apply(one, each.network, each.features))
            for each, one in zip(sequences, without))))
    return "\n".join(lines) + "\n"


def write(folders, labels, truth, output, given=DEFAULTS, label_set=files.KITTI_CLASSES,
          ground=("road", "sidewalk")):
    """`labels` and `truth` hold {sequence} (the path) or {name} (its last part)."""
    names = [each["name"] for each in files.label_set(label_set)]
    unknown = [each for each in ground if each not in names]
    if unknown:
        raise ValueError(f"--ground: class '{unknown[0]}' is not in the label set")
    called = [Path(each).resolve().name for each in folders]
    if len(set(called)) < len(called):
        raise ValueError("two sequences have the same name, expected different names")
    sequences = []
    for folder, name in zip(folders, called):
        paths = (each.replace("{sequence}", str(folder)).replace("{name}", name)
                 for each in (str(labels), str(truth)))
        sequences.append(read_samples(folder, *paths, [names.index(g) + 1 for g in ground], given))
    whole = learn(sequences, given)
    without = [learn([each for each in sequences if each is not one], given)
               for one in sequences] if len(sequences) > 1 else []
    output = Path(output)
    output.mkdir(parents=True, exist_ok=True)
    for old in output.glob("without_*.yaml"):
        old.unlink()
    texts = {"calibration.yaml": as_yaml(whole, ground, names),
             "report.md": report(sequences, whole, without, names)}
    for name, one in zip(called, without):
        texts[f"without_{name}.yaml"] = as_yaml(one, ground, names)
    for name, text in texts.items():
        files.replace(output / name, lambda file, text=text: file.write(text.encode()))
    return texts["report.md"]


def main():
    parser = argparse.ArgumentParser(prog="python3 -m lab.calibrate", description=__doc__)
    parser.add_argument("sequences", nargs="+", help="folders in KITTI's odometry layout")
    parser.add_argument("--labels", required=True, help="label distributions of each "
                        "sequence; {sequence} = its path, {name} = the last part of the path")
    parser.add_argument("--truth", required=True, help="ground truth images, as --labels")
    parser.add_argument("--output", required=True)
    parser.add_argument("--label-set", default=files.KITTI_CLASSES)
    parser.add_argument("--features", default=",".join(DEFAULTS.features),
                        help="features with a curve, or none (default: %(default)s)")
    parser.add_argument("--ground", default="road,sidewalk", help="classes, or none")
    parser.add_argument("--frames", default=":", help="A:B, only frames A <= n < B")
    for name in ("balance", "shrinkage", "bias_penalty", "curve_penalty"):
        parser.add_argument("--" + name.replace("_", "-"), type=float,
                            default=getattr(DEFAULTS, name))
    for name in ("stereo", "disparities", "max-deviation"):
        parser.add_argument("--" + name, help="as of the maps")
    given = parser.parse_args()
    given.features = [] if given.features == "none" else given.features.split(",")
    for each in given.features:
        if each not in KNOTS:
            raise ValueError(f"--features: '{each}' is no feature, expected {', '.join(KNOTS)}")
    for name in ("balance", "shrinkage"):
        if not 0 <= getattr(given, name) <= 1:
            raise ValueError(f"--{name} is {getattr(given, name)}, expected 0 to 1")
    first, _, end = given.frames.partition(":")
    given.first, given.end = int(first or 0), int(end) if end else np.inf
    given.stereo = {name: value for name, value in
                    [("stereo", given.stereo),
                     ("disparities", given.disparities and int(given.disparities)),
                     ("max_deviation", given.max_deviation and float(given.max_deviation))]
                    if value}
    ground = [] if given.ground == "none" else given.ground.split(",")
    print(write(given.sequences, given.labels, given.truth, given.output, given,
                given.label_set, ground), end="")


if __name__ == "__main__":
    files.run(main)
