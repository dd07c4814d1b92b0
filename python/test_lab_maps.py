# SPDX-License-Identifier: BSD-3-Clause
"""The laboratory's figures of maps and trajectories, against loops over all pairs and by hand."""

import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path
from types import SimpleNamespace

import numpy as np
from scipy.spatial.transform import Rotation

from lab import files, geometry, lidar_truth, reliability, trajectory

DATA = os.environ.get("PCL_SEMANTIC_DATA")
BIN = os.environ["PCL_SEMANTIC_BIN"]
CAMERA = SimpleNamespace(fx=50, fy=50, cx=30, cy=20, width=60, height=40)


def drive(poses, metres, turn=0.0):
    """Metres a pose along z, turning about y."""
    step = np.eye(4)
    step[:3, :3] = Rotation.from_euler("y", turn).as_matrix()
    step[2, 3] = metres
    path = [np.eye(4)]
    while len(path) < poses:
        path.append(path[-1] @ step)
    return np.array(path)


def voxels_at(points, size=0.2):
    return SimpleNamespace(points=points, size=size,
                           indices=np.floor(points / size).astype(np.int64))


class Geometry(unittest.TestCase):
    def setUp(self):
        random = np.random.default_rng(11)
        pixels, z = random.uniform([-10, -10], [70, 50], (900, 2)), random.uniform(1, 45, 900)
        self.scan = np.column_stack([(pixels - [30, 20]) / 50 * z[:, None], z])
        moved = self.scan[::2] + random.normal(0, 0.3, (450, 3))
        self.voxels = voxels_at(moved)

    def test_judged_are_voxels_between_returns_and_not_far_behind(self):
        met = geometry.met_by_scan(self.voxels.points, self.scan, CAMERA)
        rows, columns, depths, inside = lidar_truth.pixels(self.scan, CAMERA)
        own_rows, own_columns, _, own_inside = lidar_truth.pixels(self.voxels.points, CAMERA)
        for i, point in enumerate(self.voxels.points):
            near = (inside & (abs(rows - own_rows[i]) <= 7) & (abs(columns - own_columns[i]) <= 3))
            expected = (own_inside[i] and point[2] <= 40 and
                        np.any(near & (rows <= own_rows[i])) and
                        np.any(near & (rows >= own_rows[i])) and
                        point[2] <= depths[near].max() + 2)
            self.assertEqual(met[i], expected)
        self.assertGreater(met.sum(), 100)
        self.assertLess(met.sum(), len(met) - 50)

    def test_distances_and_surface_are_those_of_all_pairs(self):
        met = np.arange(len(self.voxels.points)) % 3 > 0
        depths = np.where(self.scan[:, 2] < 40, self.scan[:, 2], 0).astype(np.float32)
        samples = geometry.Samples()
        samples.add(self.voxels, [(self.scan, depths, met)])
        pairs = np.linalg.norm(self.voxels.points[:, None] - self.scan, axis=2)
        np.testing.assert_allclose(samples.distances[0], pairs.min(1)[met])
        expected = np.zeros((3, 4), int)
        for point, depth in zip(self.scan, depths):
            if depth == 0:
                continue
            apart = abs(self.voxels.indices - np.floor(point / 0.2)).max(1).min()
            outside = np.maximum(abs(point - (self.voxels.indices + 0.5) * 0.2) - 0.1, 0)
            near = np.linalg.norm(outside, axis=1).min() <= 0.3
            expected[0 if depth < 10 else 1 if depth < 20 else 2] += [1, apart < 1, apart < 2, near]
        np.testing.assert_array_equal(samples.surface, expected)
        self.assertTrue((expected[:, 3] > expected[:, 1]).all())

    def test_figures_of_samples(self):
        samples = geometry.Samples()
        empty = geometry.figures(samples)
        self.assertTrue(np.isnan(empty["mean"]))
        self.assertIn("| - |", geometry.row(samples, "none"))
        samples.voxels, samples.distances = 7, [np.array([0.5, 0.05]), np.array([0.15, 0.3, 2.0])]
        samples.surface[1] = [4, 1, 2, 3]
        found = geometry.figures(samples)
        self.assertEqual((found["voxels"], found["judged"]), (7, 5))
        np.testing.assert_allclose([found["mean"], found["median"], found["percentile_90"],
                                    *found["within"]], [0.6, 0.3, 2.0, 0.2, 0.4, 0.8])
        self.assertEqual(
            geometry.row(samples, "x"),
            "| x | 60.0 | 30.0 | 200.0 | 20.0 | 40.0 | 80.0 | - / - / - | 25.0 / 50.0 / 75.0 |"
            " - / - / - |")
        self.assertEqual(geometry.header().splitlines()[0].count("|"),
                         geometry.row(samples, "x").count("|"))


class Trajectories(unittest.TestCase):
    def test_a_scale_is_the_error(self):
        errors = trajectory.kitti_errors(drive(51, 1), drive(51, 1.02), [9.5, 19.5, 100])
        self.assertEqual([each[:2] for each in errors],
                         [(9.5, 41), (19.5, 31), (100, 0), (None, 72)])
        self.assertAlmostEqual(errors[0][2], 0.02 * 10 / 9.5)
        self.assertAlmostEqual(errors[0][3], 0)
        self.assertTrue(np.isnan(errors[2][2]))
        self.assertAlmostEqual(errors[3][2], (41 * 0.2 / 9.5 + 31 * 0.4 / 19.5) / 72)
        step = trajectory.kitti_errors(drive(51, 1), drive(51, 1), [9.5], 10)
        self.assertEqual(step[-1][1], 5)

    def test_a_turn_is_the_angle_by_the_way(self):
        errors = trajectory.kitti_errors(drive(30, 1), drive(30, 1, 1e-4), [9.5])
        self.assertAlmostEqual(errors[0][3], 10e-4 / 9.5, 9)

    def test_where_a_path_begins_does_not_matter(self):
        elsewhere = np.eye(4)
        elsewhere[:3, :3] = Rotation.from_euler("x", 1.0).as_matrix()
        elsewhere[:3, 3] = 5, 6, 7
        path = drive(30, 1, 0.01)
        errors = trajectory.kitti_errors(path, elsewhere @ path, [5, 10])[-1]
        self.assertLess(errors[2], 1e-9)
        for align in (False, True):
            self.assertLess(trajectory.distances(path, elsewhere @ path, align).max(), 1e-9)
        noisy = path.copy()
        noisy[:, 0, 3] += np.arange(30) * 0.1
        found = trajectory.figures(path, noisy, [5])
        self.assertAlmostEqual(found["from the start"]["last"], 2.9)
        self.assertLess(found["aligned"]["rms"], found["from the start"]["rms"])
        self.assertAlmostEqual(found["length"], 29)

    def test_quaternions_with_w_first_give_a_warning(self):
        turns = Rotation.from_euler("y", np.linspace(0, 2, 40))  # camera 0, y down
        scanner = Rotation.from_euler("z", np.linspace(0, 2, 40))
        for rotations in (turns, scanner):
            numbers = rotations.as_quat()
            self.assertFalse(trajectory.doubt_of_order(numbers))
            self.assertTrue(trajectory.doubt_of_order(np.roll(numbers, 1, axis=1)))
        with tempfile.TemporaryDirectory() as folder:
            rows = np.roll(turns.as_quat(), 1, axis=1)
            np.savetxt(f"{folder}/w.txt", [[i, i, 0, 0, *row] for i, row in enumerate(rows)])
            with self.assertWarnsRegex(UserWarning, "w.txt: .*w first: expected x y z w"):
                trajectory.read(f"{folder}/w.txt")

    def test_times_match_if_each_is_the_others_nearest(self):
        first, second = trajectory.match([0.0, 0.1, 0.2, 0.3], [0.101, 0.195, 0.204, 0.5])
        self.assertEqual((first.tolist(), second.tolist()), ([1, 2], [0, 2]))


class Reliability(unittest.TestCase):
    def test_the_error_is_that_of_the_bins(self):
        curve = reliability.Curve()
        curve.add([0.01, 0.99], [True, False])
        self.assertTrue(np.isnan(curve.error(3, 12)))
        curve.add([0.5] * 4, [True, False, False, False])
        self.assertAlmostEqual(curve.error(3, 12), 0.25)
        np.testing.assert_allclose(curve.points(least=2), [[0.5, 0.25, 4]])
        self.assertAlmostEqual(curve.error(), (0.99 + 0.99 + 1.0) / 6)


class OfAMap(unittest.TestCase):
    """A small street whose scans are the voxels of its own map."""

    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.temporary.cleanup)
        cls.folder = Path(cls.temporary.name)
        cls.street = cls.folder / "street"
        cls.program("synthesize", cls.street, "--frames", 3, "--size", "208x64")
        cls.program("map", cls.street, "--labels", cls.street / "labels", "--voxel-size", 0.2,
                    "--frames", "0:2", "--crf", "none", "--also", "probabilities",
                    "--output", cls.folder / "map", "--archive", cls.folder / "street.map")
        sequence = files.Sequence(cls.street)
        poses = trajectory.read_kitti(cls.street / "poses.txt")
        (cls.street / "velodyne").mkdir()
        voxels = geometry.Map(cls.folder / "map")
        for frame in range(3):
            pose = poses[frame] @ sequence.camera0_from_camera()
            scan = (voxels.points - pose[:3, 3]) @ pose[:3, :3] - sequence.scanner_translation
            scan = scan @ sequence.scanner_rotation
            files.write_array(cls.street / "velodyne" / f"{frame:06}.bin",
                              np.column_stack([scan, np.ones(len(scan))]), "<f4")

    @staticmethod
    def program(name, *arguments):
        subprocess.run([f"{BIN}/pcl_semantic_{name}", *map(str, arguments), "--quiet"], check=True)

    def test_it_is_exact_where_the_laser_saw_the_voxels(self):
        samples = geometry.measure(self.folder / "map", self.street)
        found = geometry.figures(samples)
        self.assertGreater(found["judged"], 1000)
        self.assertLess(found["percentile_90"], 1e-3)
        self.assertEqual(found["within"], [1, 1, 1])
        self.assertGreater(found["mapped"][0][0], 0.99)
        row = geometry.rows([self.folder / "map"] * 2, [self.street] * 2, "map")
        self.assertEqual(row, geometry.row(samples, "map"))  # twice the same is the same

    def test_an_archive_has_the_geometry_of_its_folder(self):
        archive = geometry.measure(self.folder / "street.map", self.street)
        folder = geometry.measure(self.folder / "map", self.street)
        self.assertEqual(geometry.row(archive, ""), geometry.row(folder, ""))

    def test_clouds_are_compared_by_the_poses_of_their_scanner(self):
        made = self.folder / "of_clouds"
        shutil.copytree(self.folder / "map", made)
        with self.assertRaisesRegex(ValueError, "was not made of clouds"):
            geometry.measure_clouds(made, self.folder)
        summary = json.loads((made / "summary.json").read_text())
        summary["inputs"]["sensor"] = "own"
        (made / "summary.json").write_text(json.dumps(summary))
        voxels = geometry.Map(self.folder / "map")
        clouds = self.folder / "clouds"
        clouds.mkdir()
        for frame, pose in voxels.poses.items():
            turn = pose[:3, :3] @ trajectory.WORLD_FROM_CAMERA[:3, :3].T  # looks along x
            points = (voxels.points - pose[:3, 3]) @ turn
            geometry.pcl_semantic.write_cloud(
                str(clouds / f"{frame:06}.pcd"),
                {axis: points[:, i].astype(np.float32) for i, axis in enumerate("xyz")})
        found = geometry.figures(geometry.measure_clouds(made, clouds))
        self.assertEqual(found["within"], [1, 1, 1])
        (clouds / "000001.pcd").unlink()
        with self.assertRaisesRegex(ValueError, "no cloud of frame 1"):
            geometry.measure_clouds(made, clouds)

    def test_occupancy_is_judged_by_scans_of_other_frames(self):
        curve = reliability.occupancy(self.folder / "street.map", self.street, range(2))
        points = curve.points()
        self.assertLess(points[0, 1], 0.2)  # found free
        self.assertGreater(points[-1, 1], 0.8)  # the returns are its voxels
        with self.assertRaisesRegex(ValueError, "holds all frames"):
            reliability.occupancy(self.folder / "street.map", self.street, range(3))

    def test_probabilities_of_labels_are_judged(self):
        for frame in range(2):
            path = self.folder / "gt" / f"{frame:06}.png"
            path.parent.mkdir(exist_ok=True)
            path.write_bytes((self.street / "gt" / path.name).read_bytes())
        curves = reliability.labels(self.folder / "gt", self.folder / "map" / "labels_at_depth",
                                    self.folder / "map" / "probabilities_at_depth",
                                    files.label_set())
        count, right, _ = curves["confidence"].counts.sum(1)
        self.assertGreater(count, 1000)
        self.assertGreater(right / count, 0.5)
        self.assertLess(curves["confidence"].error(), 0.5)
        reliability.plot(self.folder / "r.png", curves)
        self.assertGreater((self.folder / "r.png").stat().st_size, 1000)


class Commands(unittest.TestCase):
    def test_trajectories_of_both_formats(self):
        with tempfile.TemporaryDirectory() as folder:
            poses = drive(30, 1)
            np.savetxt(f"{folder}/kitti.txt", poses[:, :3].reshape(-1, 12))
            np.savetxt(f"{folder}/tum.txt", [[i / 10, *pose[:3, 3], 0, 0, 0, 1]
                                             for i, pose in enumerate(poses) if i])
            np.savetxt(f"{folder}/times.txt", np.arange(30) / 10)
            run = [sys.executable, "-m", "lab.trajectory", f"{folder}/kitti.txt"]
            out = subprocess.run([*run, f"{folder}/tum.txt", "--times", f"{folder}/times.txt",
                                  "--lengths", "5", "--plot", f"{folder}/plot.png"], check=True,
                                 stdout=subprocess.PIPE, text=True).stdout
            self.assertTrue(out.startswith("29 poses, 28.0 m\n"))
            self.assertIn("     all        23         0.0000          0.00000", out)
            self.assertTrue(os.path.exists(f"{folder}/plot.png"))
            bad = subprocess.run([*run, f"{folder}/tum.txt"], stderr=subprocess.PIPE, text=True)
            self.assertEqual(bad.returncode, 1)
            self.assertIn("--times is missing", bad.stderr)


if __name__ == "__main__":
    unittest.main()
