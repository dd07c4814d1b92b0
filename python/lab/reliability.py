# SPDX-License-Identifier: BSD-3-Clause
"""How often probabilities are right: of labels against label images, or of the occupancy of an
archive against laser scans of frames that are not in it."""

import argparse
import json
import sqlite3
from pathlib import Path

import numpy as np

from lab import files, geometry, trajectory

BINS = 15
PRIOR = 0.27  # kOccupancyPrior, map/semantic_voxel.h
CARRIER = 2.0  # returns nearer than this are of the car [m]


class Curve:
    """Counts by bins of probability."""

    def __init__(self):
        self.counts = np.zeros((3, BINS))  # how many, right ones, sum of probabilities

    def add(self, probabilities, right):
        bins = (np.asarray(probabilities, np.float32) * np.float32(BINS)).astype(int)
        bins = bins.clip(0, BINS - 1)
        for i, weights in enumerate((None, right, probabilities)):
            self.counts[i] += np.bincount(bins, weights, BINS)

    def error(self, first=0, end=BINS):
        """Expected calibration error (Naeini et al. 2015) of some of the bins."""
        count, right, probability = self.counts[:, first:end]
        return abs(right - probability).sum() / count.sum() if count.sum() else np.nan

    def points(self, least=1):
        """Mean probability, frequency and number of each bin that holds enough."""
        count, right, probability = self.counts[:, self.counts[0] >= least]
        return np.stack([probability / count, right / count, count], axis=1)


def labels(truth, prediction, probabilities, classes, covered=None):
    """Curves of the most probable class ("confidence") and of each class, by name.

    Folders of images; of the probabilities `.npy`, H x W x L. Counted are pixels that the
    prediction (and the image of \\a covered) gives a class."""
    names = [each["name"] for each in classes]
    judged = [i for i, name in enumerate(names, 1)
              if name not in ("sky", "pedestrian", "cyclist")]
    curves = {name: Curve() for name in ["confidence", *(names[i - 1] for i in judged)]}
    for frame, path in files.frames(truth, ".png").items():
        right = files.read_image(path)
        counted = files.read_image(f"{prediction}/{path.name}") > 0
        if covered:
            counted &= files.read_image(f"{covered}/{path.name}") > 0
        values = np.load(f"{probabilities}/{path.stem}.npy", mmap_mode="r")
        if values.shape != (*right.shape, len(classes)):
            raise ValueError(f"{probabilities}/{path.stem}.npy: has shape {values.shape}, "
                             f"expected {(*right.shape, len(classes))}")
        counted &= np.isin(right, judged)
        p = values[counted].astype(np.float32)
        p /= np.maximum(p.sum(1, keepdims=True), np.finfo(np.float32).tiny)
        right, p = right[counted][p.any(1)], p[p.any(1)]
        best = p.argmax(1)
        curves["confidence"].add(p[np.arange(len(p)), best], right == best + 1)
        for i in judged:
            curves[names[i - 1]].add(p[:, i - 1], right == i)
    return curves


def known_voxels(archive):
    """Voxel size [m]; sorted keys of the voxels that a ray has reached, and their log-odds."""
    import zstandard
    size = json.loads(files.program("archive", "info", archive, "--json"))["voxel_size"]
    offsets = np.stack(np.unravel_index(np.arange(512), (8, 8, 8)), axis=1)[:, ::-1]  # x y z
    found, odds = [], []
    with sqlite3.connect(f"file:{archive}?mode=ro", uri=True) as database:
        for z, y, x, content in database.execute("SELECT z, y, x, content FROM blocks"):
            block = zstandard.ZstdDecompressor().decompress(content)
            log_odds = np.frombuffer(block, "<i2", 512, offset=15)
            known = log_odds != -32768
            found.append(geometry.keys(np.array([x, y, z]) * 8 + offsets[known]))
            odds.append(log_odds[known] / 4096)
    found, odds = np.concatenate(found), np.concatenate(odds)
    order = np.argsort(found)
    return size, found[order], odds[order]


def crossed_by(start, ends, size):
    """Sorted keys of the voxels that the segments cross (Amanatides and Woo 1987)."""
    start, ends = (np.floor(each * (1024 / size)) / 1024 for each in (start, ends))
    delta = ends - start
    voxel = np.broadcast_to(np.floor(start), ends.shape).astype(np.int64)
    with np.errstate(divide="ignore", invalid="ignore"):
        step = abs(1 / delta)
        time = np.where(delta == 0, np.inf, (voxel + (delta > 0) - start) / delta)
    sign, met = np.sign(delta).astype(np.int64), [geometry.keys(voxel[:1])]
    while len(voxel):
        now = time.min(1)
        going = now <= 1
        voxel, time, step, sign, now = (e[going] for e in (voxel, time, step, sign, now))
        passed = time == now[:, None]
        voxel, time = voxel + sign * passed, np.where(passed, time + step, time)
        met.append(np.unique(geometry.keys(voxel)))
        if len(met) > 50:
            met = [np.unique(np.concatenate(met))]
    return np.unique(np.concatenate(met))


def occupancy(archive, sequence_folder, mapped, poses_path=None):
    """The curve of the voxels that rays of the scans of other frames than \\a mapped cross: right
    is one with a return in it or in one of the 26 around it."""
    sequence, curve = files.Sequence(sequence_folder), Curve()
    poses = trajectory.read_kitti(poses_path or Path(sequence_folder) / "poses.txt")
    size, known, odds = known_voxels(archive)
    frames = [n for n in sequence.scans() if n not in mapped]
    if not frames:
        raise ValueError(f"{archive}: holds all frames of {sequence_folder}; map a part of them")
    for frame in frames:
        pose = poses[frame] @ sequence.camera0_from_camera()
        scan = sequence.scan(frame)
        scan = scan[np.linalg.norm(scan, axis=1) > CARRIER]
        ends = sequence.in_camera(scan) @ pose[:3, :3].T + pose[:3, 3]
        scanner = sequence.in_camera(np.zeros((1, 3))) @ pose[:3, :3].T + pose[:3, 3]
        crossed = crossed_by(scanner, ends, size)
        place = np.searchsorted(known, crossed).clip(max=len(known) - 1)
        place = place[known[place] == crossed]
        returns = np.floor(ends / size).astype(int)
        near = np.unique(np.concatenate([geometry.keys(returns + np.array(each) - 1)
                                         for each in np.ndindex(3, 3, 3)]))
        curve.add(1 / (1 + (1 / PRIOR - 1) * np.exp(-odds[place])), np.isin(known[place], near))
    return curve


def plot(path, curves):
    """A reliability diagram: below the diagonal probabilities are too sure."""
    from matplotlib.figure import Figure
    figure = Figure(figsize=(6, 5), layout="constrained")
    axes = figure.subplots()
    axes.plot([0, 1], [0, 1], color="lightgrey", linewidth=2)
    for name, curve in curves.items():
        points = curve.points(least=50)
        axes.plot(points[:, 0], points[:, 1], marker=".", label=name)
    axes.set(xlabel="probability", ylabel="frequency", aspect="equal")
    axes.legend(frameon=False, fontsize="small")
    figure.savefig(path, dpi=100)


def main():
    parser = argparse.ArgumentParser(prog="python3 -m lab.reliability", description=__doc__)
    parser.add_argument("--truth", help="folder of label images")
    parser.add_argument("--prediction", help="folder of the labels that are judged")
    parser.add_argument("--probabilities", help="folder of their probabilities (.npy)")
    parser.add_argument("--covered-by", help="folder of label images: others do not count")
    parser.add_argument("--label-set", default=files.KITTI_CLASSES)
    parser.add_argument("--archive", help="archive of a part of SEQUENCE, for its occupancy")
    parser.add_argument("--sequence", help="KITTI sequence with velodyne/ and poses.txt")
    parser.add_argument("--mapped", default=":", help="A:B = the frames that are in the archive")
    parser.add_argument("--plot", help="reliability diagram (.png)")
    given = parser.parse_args()
    if given.archive and given.sequence:
        first, _, end = given.mapped.partition(":")
        mapped = range(int(first or 0), int(end or 10 ** 9))
        curves = {"occupied": occupancy(given.archive, given.sequence, mapped)}
        fifth = BINS // 5
        print(f"error where p is 0.2 to 0.8: {curves['occupied'].error(fifth, BINS - fifth):.3f}")
        for probability, frequency, count in curves["occupied"].points():
            print(f"  {probability:.3f}  {frequency:.3f}  {count:10.0f}")
    elif given.truth and given.prediction and given.probabilities:
        curves = labels(given.truth, given.prediction, given.probabilities,
                        files.label_set(given.label_set), given.covered_by)
        print("expected calibration error [%]")
        for name, curve in curves.items():
            print(f"  {name:<22}{100 * curve.error():6.1f}")
    else:
        parser.error("expected --truth, --prediction and --probabilities, or --archive and "
                     "--sequence")
    if given.plot:
        plot(given.plot, curves)


if __name__ == "__main__":
    files.run(main)
