# SPDX-License-Identifier: BSD-3-Clause
"""Compares two trajectories, KITTI (matched by row) or TUM (matched by time): errors by KITTI's
definition and distances of the positions. evo (pip install evo) does more."""

import argparse
import warnings

import numpy as np
from scipy.spatial.transform import Rotation

from lab import files

LENGTHS = (100, 200, 300, 400, 500, 600, 700, 800)  # of KITTI's pieces [m]
# From KITTI's first camera (x right, y down, z forward) to our world (x forward, y left, z up).
WORLD_FROM_CAMERA = np.array([[0, 0, 1, 0], [-1, 0, 0, 0], [0, -1, 0, 0], [0, 0, 0, 1.0]])


def doubt_of_order(quaternions):
    """Whether x y z w (N x 4) are tilted in every frame that poses have, but upright as w x y z."""
    def uprights(numbers):  # of camera 0, of a camera and of a scanner in a world with z up
        turns = Rotation.from_quat(numbers).as_matrix()
        return np.stack([turns[:, 1, 1], -turns[:, 2, 1], turns[:, 2, 2]])
    read, other = uprights(quaternions), uprights(np.roll(quaternions, -1, axis=1))
    upright = (other > 0.5).mean(1) >= 0.9
    return bool(upright.any() and
                read.mean(1).max() < other.mean(1)[upright].max() - 0.1)


def read(path):
    """Times (None of KITTI's format) and poses, N x 4 x 4."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        rows = np.atleast_2d(np.loadtxt(path))
    if not rows.size or not np.isfinite(rows).all():
        raise ValueError(f"{path}: holds no pose, or a number that is not finite")
    poses = np.tile(np.eye(4), (len(rows), 1, 1))
    if rows.shape[1] == 12:
        poses[:, :3] = rows.reshape(-1, 3, 4)
        return None, poses
    if rows.shape[1] != 8:
        raise ValueError(f"{path}: has {rows.shape[1]} numbers a row, expected 12 (KITTI) or 8 (TUM)")
    poses[:, :3, 3] = rows[:, 1:4]
    poses[:, :3, :3] = Rotation.from_quat(rows[:, 4:]).as_matrix()
    if doubt_of_order(rows[:, 4:]):
        warnings.warn(f"{path}: most poses are tilted or upside down, but upright if the "
                      "quaternions have w first: expected x y z w", stacklevel=2)
    return rows[:, 0], poses


def read_kitti(path):
    """Poses of camera 0 in our world, N x 4 x 4."""
    times, poses = read(path)
    if times is not None:
        raise ValueError(f"{path}: is TUM's, expected KITTI's 12 numbers a row")
    return WORLD_FROM_CAMERA @ poses


def ways(poses):
    """The way from the first pose to each [m]."""
    steps = np.linalg.norm(np.diff(poses[:, :3, 3], axis=0), axis=1)
    return np.concatenate([[0], np.cumsum(steps)])


def kitti_errors(truth, estimate, lengths=LENGTHS, step=1):
    """(length or None for all, pieces, translation [1], rotation [rad/m]) of each length: a
    piece begins at every \\a step-th pose and ends after its length."""
    way, errors = ways(truth), []
    for length in lengths:
        begin = np.arange(0, len(way), step)
        end = np.searchsorted(way, way[begin] + length, side="right")
        begin, end = begin[end < len(way)], end[end < len(way)]
        inverse = np.linalg.inv
        error = (inverse(inverse(estimate[begin]) @ estimate[end]) @
                 (inverse(truth[begin]) @ truth[end]))
        errors.append((length, np.linalg.norm(error[:, :3, 3], axis=1) / length,
                       Rotation.from_matrix(error[:, :3, :3]).magnitude() / length
                       if len(error) else np.zeros(0)))
    errors.append((None, *(np.concatenate([each[i] for each in errors]) for i in (1, 2))))
    return [(length, len(shift), shift.mean() if len(shift) else np.nan,
             turn.mean() if len(turn) else np.nan) for length, shift, turn in errors]


def distances(truth, estimate, align=False):
    """Distances of the positions [m] with equal first poses, or fitted without scale."""
    p, q = estimate[:, :3, 3], truth[:, :3, 3]
    if align:
        u, _, vt = np.linalg.svd((q - q.mean(0)).T @ (p - p.mean(0)))
        turn = u @ np.diag([1, 1, np.sign(np.linalg.det(u @ vt))]) @ vt
        shift = q.mean(0) - turn @ p.mean(0)
    else:
        start = truth[0] @ np.linalg.inv(estimate[0])
        turn, shift = start[:3, :3], start[:3, 3]
    return np.linalg.norm(q - p @ turn.T - shift, axis=1)


def match(times, other_times, tolerance=0.01):
    """Rows of both whose times are each other's nearest, at most \\a tolerance apart [s]."""
    gaps = abs(np.asarray(times)[:, None] - np.asarray(other_times))
    nearest = gaps.argmin(1)
    mutual = gaps.argmin(0)[nearest] == np.arange(len(times))
    first = np.flatnonzero(mutual & (gaps.min(1) <= tolerance))
    return first, nearest[first]


def matched(truth_path, estimate_path, times_path=None, tolerance=0.01):
    (times, truth), (other, estimate) = read(truth_path), read(estimate_path)
    if times is None and other is None:
        common = min(len(truth), len(estimate))
        return truth[:common], estimate[:common]
    if times_path is None and (times is None or other is None):
        raise ValueError("a KITTI trajectory meets a TUM one: --times is missing")
    given = np.loadtxt(times_path) if times_path else None
    first, second = match(given[:len(truth)] if times is None else times,
                          given[:len(estimate)] if other is None else other, tolerance)
    if not len(first):
        raise ValueError(f"{estimate_path}: has no pose at the times of {truth_path}")
    return truth[first], estimate[second]


def figures(truth, estimate, lengths=LENGTHS, step=1):
    def of(values):
        return {"mean": values.mean(), "rms": np.sqrt((values ** 2).mean()),
                "largest": values.max(), "last": values[-1]}
    return {"poses": len(truth), "length": ways(truth)[-1],
            "pieces": kitti_errors(truth, estimate, lengths, step),
            "from the start": of(distances(truth, estimate)),
            "aligned": of(distances(truth, estimate, align=True))}


def report(found):
    lines = [f"{found['poses']} poses, {found['length']:.1f} m", "",
             f"{'length':>8} {'pieces':>9} {'translation %':>14} {'rotation deg/m':>16}"]
    for length, pieces, shift, turn in found["pieces"]:
        name = f"{length:g} m" if length else "all"
        numbers = (f"{100 * shift:14.4f} {np.degrees(turn):16.5f}" if pieces else
                   f"{'-':>14} {'-':>16}")
        lines.append(f"{name:>8} {pieces:>9} {numbers}")
    lines.append("")
    for name in ("from the start", "aligned"):
        values = ", ".join(f"{key} {value:.4f} m" for key, value in found[name].items())
        lines.append(f"{name + ':':<16} {values}")
    return "\n".join(lines)


def plot(path, truth, estimate):
    """Both from above, in metres."""
    from matplotlib.figure import Figure
    figure = Figure(figsize=(6, 6), layout="constrained")
    axes = figure.subplots()
    start = truth[0] @ np.linalg.inv(estimate[0])
    for name, poses in (("truth", truth), ("estimate", start @ estimate)):
        axes.plot(*(WORLD_FROM_CAMERA @ poses)[:, :2, 3].T, label=name)
    axes.set(xlabel="x [m]", ylabel="y [m]", aspect="equal")
    axes.legend(frameon=False)
    figure.savefig(path, dpi=100)


def main():
    parser = argparse.ArgumentParser(prog="python3 -m lab.trajectory", description=__doc__)
    parser.add_argument("truth")
    parser.add_argument("estimate")
    parser.add_argument("--times", help="times.txt of a KITTI trajectory that meets a TUM one")
    parser.add_argument("--lengths", default=",".join(map(str, LENGTHS)), help="of pieces [m]")
    parser.add_argument("--step", type=int, default=1, help="poses between the starts of pieces")
    parser.add_argument("--tolerance", type=float, default=0.01, help="of times that match [s]")
    parser.add_argument("--plot", help="picture of both from above (.png)")
    parser.add_argument("--json", action="store_true")
    given = parser.parse_args()
    lengths = [float(each) for each in given.lengths.split(",")]
    if given.step < 1 or not all(0 < each < np.inf for each in lengths):
        parser.error("--step and --lengths have to be more than 0")
    truth, estimate = matched(given.truth, given.estimate, given.times, given.tolerance)
    found = figures(truth, estimate, lengths, given.step)
    print(files.as_json(found) if given.json else report(found))
    if given.plot:
        plot(given.plot, truth, estimate)


if __name__ == "__main__":
    files.run(main)
