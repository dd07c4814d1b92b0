# SPDX-License-Identifier: BSD-3-Clause
"""Geometry of a finished map against laser scans: how far voxels lie off the returns, and
how much of the returns is mapped."""

import argparse
import json
import re
import sqlite3
import tempfile
from pathlib import Path

import numpy as np
import pcl_semantic
from scipy.ndimage import maximum_filter
from scipy.spatial import cKDTree

from lab import files, lidar_truth, trajectory

BANDS = (0.0, 10.0, 20.0, 40.0)  # borders of depth [m]
BEHIND = 2.0  # a voxel farther behind the farthest return around it is hidden [m]
WITHIN = 0.3  # of a cube, the widest of the three fractions [m]
LIMITS = (0.1, 0.2, 0.5)  # of the distances [m]


class Map:
    """Occupied voxels and the poses of the left camera 0 (or the scanner) by frame number.
    \\a path is a folder of pcl_semantic_map, an archive or an index of tiles; of the last two
    the voxels around the poses of a sequence are read."""

    def __init__(self, path, sequence=None, poses=None, frames=None):
        path = Path(path)
        if path.is_dir():
            summary = json.loads((path / "summary.json").read_text())
            if not summary["finished"] and "voxel_size" not in summary:
                raise ValueError(f"{path}/summary.json: the map is not finished")
            numbers, self.sensor = summary["frame_numbers"], summary["inputs"].get("sensor")
            given = trajectory.read_kitti(path / "trajectory.txt")
            self._take(path / "map.pcd", summary["voxel_size"])
        else:
            given = trajectory.read_kitti(poses or Path(sequence) / "poses.txt")
            info = json.loads(files.program("archive", "info", path, "--json"))
            numbers = [n for n in files.Sequence(sequence).scans() if n < len(given)]
            made_of = frames_of(path) if frames is None else set()
            numbers = [n for n in numbers if not made_of or n in made_of]
            with tempfile.TemporaryDirectory() as folder:
                places = np.array([given[n][:3, 3] for n in numbers])
                reach = 2 * BANDS[-1]  # farther than deep at the corners of a wide image
                box = np.concatenate([places.min(0) - reach, places.max(0) + reach])
                files.program("archive", "export", path, f"{folder}/map.pcd", "--quiet",
                              "--box=" + ",".join(map(str, box)))
                self._take(f"{folder}/map.pcd", float(info["voxel_size"]))
        self.poses = {n: given[n] for n in numbers if frames is None or n in frames}

    def _take(self, cloud, voxel_size):
        self.size = voxel_size
        self.points = positions(cloud)
        self.indices = np.floor(self.points / self.size).astype(np.int64)


def positions(path):
    cloud = pcl_semantic.read_cloud(str(path))
    return np.stack([cloud[axis] for axis in "xyz"], axis=1).astype(float)


def frames_of(archive):
    """Numbers of the frames that an archive was made of; none of a merged one or an index."""
    with open(archive, "rb") as file:  # archives may be large
        if file.read(6) != b"SQLite":
            return set()
    with sqlite3.connect(f"file:{archive}?mode=ro", uri=True) as database:
        return {number for number, in database.execute("SELECT number FROM frames")}


def keys(indices):
    """One number a voxel."""
    return ((indices + (1 << 20)) * [1 << 42, 1 << 21, 1]).sum(1)


def holds(sorted_keys, indices):
    wanted = keys(indices)
    place = np.searchsorted(sorted_keys, wanted).clip(max=len(sorted_keys) - 1)
    return sorted_keys[place] == wanted


class Samples:
    """What is counted of maps; pooling is adding."""

    def __init__(self):
        self.voxels, self.distances = 0, []
        self.surface = np.zeros((len(BANDS) - 1, 4), int)  # returns, in, next to, near a voxel

    def add(self, voxels, scans):
        """Of a map, with its scans: returns in the world, their depths (0 = not seen), and
        which voxels the scan could have met."""
        sorted_keys = np.sort(keys(voxels.indices))
        centres = cKDTree((voxels.indices + 0.5) * voxels.size)
        judged, returns = np.zeros(len(voxels.points), bool), []
        for points, depths, met in scans:
            returns.append(points)
            judged |= met
            self._count(points[depths > 0], depths[depths > 0], voxels.size, sorted_keys, centres)
        self.voxels += len(voxels.points)
        if returns:
            nearest, _ = cKDTree(np.concatenate(returns)).query(voxels.points[judged], workers=-1)
            self.distances.append(nearest)

    def _count(self, points, depths, size, sorted_keys, centres):
        indices = np.floor(points * (1024 / size)).astype(np.int64) >> 10
        inside = holds(sorted_keys, indices)
        beside = inside.copy()
        for offset in np.ndindex(3, 3, 3):
            beside[~beside] = holds(sorted_keys, indices[~beside] + np.array(offset) - 1)
        near = inside | (cube_distances(points, size, centres) <= WITHIN)
        bands = np.searchsorted(BANDS, depths, side="right") - 1
        for band in range(len(self.surface)):
            here = bands == band
            self.surface[band] += [np.count_nonzero(each & here) for each in
                                   (here, inside, beside, near)]


def cube_distances(points, size, centres, count=32):
    """From points to the nearest cubes of voxels, infinite where none is within WITHIN [m]."""
    reach = WITHIN + size * 3 ** 0.5 / 2
    _, nearest = centres.query(points, k=count, distance_upper_bound=reach, workers=-1)
    cubes = np.vstack([centres.data, np.full(3, np.inf)])[nearest]
    outside = np.maximum(abs(points[:, None] - cubes) - size / 2, 0)
    return np.sqrt((outside ** 2).sum(2)).min(1)


def met_by_scan(in_camera, scan_in_camera, camera):
    """Which points the laser could have met: in the image between returns, at most BEHIND
    farther than the farthest of them, and not beyond the last band."""
    rows, columns, depths, inside = lidar_truth.pixels(scan_in_camera, camera)
    farthest = np.zeros((camera.height, camera.width), np.float32)
    np.maximum.at(farthest, (rows[inside], columns[inside]), depths[inside])
    tall, wide = lidar_truth.ROWS, lidar_truth.COLUMNS
    wide = maximum_filter(farthest, (1, 2 * wide + 1), mode="constant")
    half = (tall + 1) // 2
    above, below = (maximum_filter(wide, (tall + 1, 1), mode="constant", origin=(shift, 0))
                    for shift in (half - 1, -half))
    behind = np.where((above > 0) & (below > 0), np.maximum(above, below), -np.inf)
    rows, columns, _, inside = lidar_truth.pixels(in_camera, camera)
    z = in_camera[:, 2]
    return inside & (z <= BANDS[-1]) & (z <= behind[rows, columns] + BEHIND)


def measure(map_path, sequence_folder, poses=None, frames=None):
    """Samples of a map and the scans of the KITTI sequence that it was made of."""
    sequence, samples = files.Sequence(sequence_folder), Samples()
    voxels = Map(map_path, sequence_folder, poses, frames)

    def scans():
        for frame, pose in voxels.poses.items():
            pose = pose @ sequence.camera0_from_camera()
            scan = sequence.in_camera(sequence.scan(frame))
            _, _, depths = lidar_truth.seen(scan, sequence.camera, BANDS[-1])
            in_camera = (voxels.points - pose[:3, 3]) @ pose[:3, :3]
            yield (scan @ pose[:3, :3].T + pose[:3, 3], depths,
                   met_by_scan(in_camera, scan, sequence.camera))

    samples.add(voxels, scans())
    return samples


def measure_clouds(map_path, folder):
    """Samples of a map and the clouds that it was made of, by the poses of their scanner; depth
    is the distance, and a voxel is judged if it is that near."""
    voxels, samples = Map(map_path), Samples()
    if voxels.sensor != "own":
        raise ValueError(f"{map_path}: was not made of clouds with --sensor own")
    numbers = {path: re.search(r"\d+$", path.stem) for path in Path(folder).iterdir()}
    clouds = {int(number[0]): path for path, number in numbers.items() if number}

    def scans():
        for frame, pose in voxels.poses.items():
            if frame not in clouds:
                raise ValueError(f"{folder}: has no cloud of frame {frame}, which is in the map")
            pose = pose @ trajectory.WORLD_FROM_CAMERA.T  # a scanner looks along x
            points = positions(clouds[frame])
            points = points[np.isfinite(points).all(1)]
            yield (points @ pose[:3, :3].T + pose[:3, 3], np.linalg.norm(points, axis=1),
                   np.linalg.norm(voxels.points - pose[:3, 3], axis=1) <= BANDS[-1])

    samples.add(voxels, scans())
    return samples


def figures(samples):
    """Voxels, how many are judged, distances [m], fractions of those judged within LIMITS and,
    by band, of the returns in a voxel, in or next to one, and within WITHIN of one."""
    distances = np.sort(np.concatenate(samples.distances or [[]]))
    judged = len(distances)

    def quantile(fraction):
        return distances[int(fraction * (judged - 1) + 0.5)] if judged else np.nan

    with np.errstate(invalid="ignore"):
        mapped = samples.surface[:, 1:] / samples.surface[:, :1]
    return {"voxels": samples.voxels, "judged": judged,
            "mean": distances.mean() if judged else np.nan, "median": quantile(0.5),
            "percentile_90": quantile(0.9),
            "within": [np.searchsorted(distances, limit, "right") / judged if judged else np.nan
                       for limit in LIMITS],
            "returns": samples.surface[:, 0].tolist(), "mapped": mapped.tolist()}


def shown(value, decimals=1):
    return f"{value:.{decimals}f}" if np.isfinite(value) else "-"


def parts(mapped):
    return " / ".join(shown(100 * each) for each in mapped)


def bands():
    return [f"{a:g}-{b:g} m" for a, b in zip(BANDS, BANDS[1:])]


def header():
    titles = (["mean cm", "median cm", "90 % cm"] + [f"to {100 * x:.0f} cm %" for x in LIMITS] +
              [f"mapped {band} %" for band in bands()])
    return f"| | {' | '.join(titles)} |\n|---|{'---:|' * len(titles)}"


def row(samples, name):
    found = figures(samples)
    values = [shown(100 * found[each]) for each in ("mean", "median", "percentile_90")]
    values += [shown(100 * each) for each in found["within"]]
    return " | ".join([f"| {name}", *values, *map(parts, found["mapped"])]) + " |"


def pooled(maps, sequences, **options):
    total = Samples()
    for map_path, sequence in zip(maps, sequences):
        each = measure(map_path, sequence, **options)
        total.voxels += each.voxels
        total.distances += each.distances
        total.surface += each.surface
    return total


def rows(maps, sequences, name=None):
    """A row of a Markdown table, pooled over maps and their sequences."""
    return row(pooled(maps, sequences), name or Path(maps[0]).name)


def report(samples):
    found = figures(samples)
    lines = [f"voxels {found['voxels']}, judged {found['judged']}", "",
             "from a voxel to the nearest return"]
    for name, key in (("mean", "mean"), ("median", "median"), ("90 %", "percentile_90")):
        lines.append(f"  {name:<9} {shown(found[key], 3)} m")
    lines += [f"  to {limit:.1f} m  {shown(100 * part)} %"
              for limit, part in zip(LIMITS, found["within"])]
    lines += ["", f"returns in a voxel / next to one / within {WITHIN:g} m of one"]
    lines += [f"  {band}: {parts(mapped)} % of {count}" for band, mapped, count in
              zip(bands(), found["mapped"], found["returns"])]
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(prog="python3 -m lab.geometry", description=__doc__)
    parser.add_argument("map", help="folder of pcl_semantic_map, archive, or index of tiles")
    parser.add_argument("sequence", nargs="?", help="KITTI sequence with velodyne/")
    parser.add_argument("--clouds", help="folder of the clouds that the map was made of, instead")
    parser.add_argument("--poses", help="of an archive: KITTI's poses of camera 0 in its frame")
    parser.add_argument("--frames", default=":", help="of an archive: A:B = frames A <= n < B "
                        "(default: those that it was made of)")
    parser.add_argument("--json", action="store_true", help="metres and ratios as JSON")
    given = parser.parse_args()
    if (given.sequence is None) == (given.clouds is None):
        parser.error("expected SEQUENCE or --clouds")
    first, _, end = given.frames.partition(":")
    frames = None if given.frames == ":" else range(int(first or 0), int(end or 10 ** 9))
    samples = (measure_clouds(given.map, given.clouds) if given.clouds else
               measure(given.map, given.sequence, given.poses, frames))
    print(files.as_json(figures(samples)) if given.json else report(samples))


if __name__ == "__main__":
    files.run(main)
