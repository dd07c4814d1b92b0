# SPDX-License-Identifier: BSD-3-Clause
"""The module gives what the programs give, byte by byte, and refuses with a word."""

import multiprocessing
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import threading
import unittest
import warnings

import numpy as np

import pcl_semantic

HERE = os.path.dirname(os.path.abspath(__file__))
LABEL_SET = os.path.join(HERE, "..", "data", "label_sets", "kitti11.yaml")


def two_walls(seed=1, wrong=0.2):
    """Points of two parallel walls, their labels, and the same with some of them wrong."""
    random = np.random.default_rng(seed)
    points = random.uniform([0, 0, 0], [4, 0.02, 2], (4000, 3)).astype(np.float32)
    points[2000:, 1] += 3
    labels = np.repeat([1, 2], 2000)
    noisy = np.where(random.random(4000) < wrong, 3 - labels, labels)
    return points, labels, noisy


class Refine(unittest.TestCase):
    def test_a_survey_20_km_wide_has_the_labels_of_its_parts(self):
        parts = [two_walls(seed, wrong=0.35) for seed in range(4)]
        corners = np.array([[x, y, 300.0] for x in (500e3, 520e3) for y in (5.4e6, 5.42e6)])
        whole, _ = pcl_semantic.refine(
            np.concatenate([part[0] + corner for part, corner in zip(parts, corners)]),
            labels=np.concatenate([noisy for _, _, noisy in parts]))
        for i, (points, _, noisy) in enumerate(parts):
            alone, _ = pcl_semantic.refine(points, labels=noisy)
            equal = np.mean(whole[4000 * i:4000 * (i + 1)] == alone)
            self.assertGreaterEqual(equal, 0.999)

    def test_a_grid_20_km_wide_has_the_labels_of_its_parts(self):
        random = np.random.default_rng(4)
        corners = np.array([[x, y, 300.0] for x in (500e3, 520e3) for y in (5.4e6, 5.42e6)])
        patches, noisy = [], []
        for side in 150, 80, 120, 100:  # points 0.05 m apart, moved by millimetres
            y, x = np.divmod(np.arange(side * side), side)
            patches.append(0.05 * np.stack([x, y, 0 * x], 1) +
                           random.normal(0, 0.004, (side * side, 3)))
            noisy.append(np.where(random.random(side * side) < 0.45,
                                  random.integers(1, 6, side * side),
                                  1 + (x // 30 * 7 + y // 30 * 13) % 5))
        fixed = dict(smoothness_deviation=0.1, appearance_deviation=0.2, crf_iterations=3)
        points = [patch + corner for patch, corner in zip(patches, corners)]
        points.append([[0, 0, 0]])  # far from all
        whole, _ = pcl_semantic.refine(np.concatenate(points),
                                       labels=np.concatenate(noisy + [[1]]), **fixed)
        alone = [pcl_semantic.refine(part, labels=labels, classes=5, **fixed)[0]
                 for part, labels in zip(points, noisy)]
        np.testing.assert_array_equal(whole[:-1], np.concatenate(alone))

    def test_labels_become_consistent(self):
        points, labels, noisy = two_walls()
        refined, probabilities = pcl_semantic.refine(points, labels=noisy)
        self.assertLess(np.mean(noisy == labels), 0.82)
        self.assertGreater(np.mean(refined == labels), 0.99)
        self.assertEqual(probabilities.shape, (4000, 2))
        np.testing.assert_allclose(probabilities.sum(axis=1), 1, atol=1e-5)

    def test_probabilities_are_those_of_the_program(self):
        points, _, noisy = two_walls()
        with tempfile.TemporaryDirectory() as folder:
            cloud, refined = os.path.join(folder, "in.pcd"), os.path.join(folder, "out.pcd")
            x, y, z = points.T
            pcl_semantic.write_cloud(cloud, {"x": x, "y": y, "z": z, "label": noisy})
            program = os.path.join(os.environ["PCL_SEMANTIC_BIN"], "pcl_semantic_crf")
            subprocess.run([program, cloud, refined, "--crf-iterations", "3", "--crf",
                            "hierarchical", "--cliques", "cubes:1", "--quiet"], check=True)
            expected = pcl_semantic.read_cloud(refined)
        labels, probabilities = pcl_semantic.refine(
            points, labels=noisy, crf="hierarchical", cliques="cubes:1", crf_iterations=3)
        np.testing.assert_array_equal(labels, expected["label"])
        self.assertEqual(probabilities.tobytes(), expected["probability"].tobytes())

    def test_softmax_and_cliques_of_numbers(self):
        points, labels, noisy = two_walls()
        softmax = np.full((4000, 2), 0.2)
        softmax[np.arange(4000), noisy - 1] = 0.8
        refined, _ = pcl_semantic.refine(
            points, probabilities=softmax, colours=np.zeros((4000, 3), np.uint8),
            cliques=labels, crf="hierarchical", threads=1)
        self.assertGreater(np.mean(refined == labels), 0.99)

    def test_points_of_no_clique_are_zero(self):
        points, _, noisy = two_walls()
        numbers = np.where(np.arange(4000) % 3 == 0, -1, 1)  # noise of DBSCAN
        with self.assertRaisesRegex(ValueError, "cliques hold -1 at point 0"):
            pcl_semantic.refine(points, labels=noisy, crf="hierarchical", cliques=numbers)

    def test_what_numpy_would_drop_is_refused(self):
        points, _, noisy = two_walls()
        probabilities = np.full((4000, 2), 0.5)
        masked = np.ma.masked_array
        for message, arguments in [
                ("masked", (masked(points, points > 3), {"labels": noisy})),
                ("masked", (points, {"labels": masked(noisy, noisy == 1)})),
                ("masked", (points, {"probabilities": masked(probabilities)})),
                ("complex", (points, {"probabilities": probabilities + 1j})),
                ("dates", (points.astype("M8[s]"), {"labels": noisy}))]:
            with self.assertRaisesRegex(ValueError, message):
                pcl_semantic.refine(arguments[0], **arguments[1])

    def test_a_cloud_far_away_is_the_same_cloud(self):
        points, _, noisy = two_walls()
        shift = np.array([691200.0, 5334400.0, 384.0])
        for options in ({}, {"crf": "hierarchical", "cliques": "cubes:0.8"}):
            near, _ = pcl_semantic.refine(points, labels=noisy, **options)
            far, _ = pcl_semantic.refine(points + shift, labels=noisy, **options)
            np.testing.assert_array_equal(near, far)
        np.testing.assert_array_equal(pcl_semantic.cliques(points, "cubes:0.8"),
                                      pcl_semantic.cliques(points + shift, "cubes:0.8"))
        with self.assertWarnsRegex(UserWarning, "steps of 0.5 m"):
            pcl_semantic.refine((points + shift).astype(np.float32), labels=noisy)
        with self.assertWarnsRegex(UserWarning, "steps of 0.5 m"):  # not its sensor's
            pcl_semantic.SemanticVoxelMap("kitti11").integrate(points + shift, np.eye(4))

    def test_what_does_not_fit_is_refused(self):
        points, _, noisy = two_walls()
        for message, arguments in [
                ("labels are 3, expected 4000", {"labels": noisy[:3]}),
                ("points are 3, expected N x 3", {"points": points[0], "labels": noisy}),
                ("got None", {"points": np.where(points < 1, points, None),
                              "labels": noisy}),
                ("probabilities or labels", {}),
                ("labels are float64, expected integers", {"labels": noisy + 0.5}),
                ("colours are float32, expected integers",
                 {"labels": noisy, "colours": points / 4}),
                ("colours hold 256", {"labels": noisy,
                                      "colours": np.full((4000, 3), 256)}),
                ("'superpixel', expected planes",
                 {"labels": noisy, "crf": "hierarchical", "cliques": "superpixel"}),
                ("-1 of point 0", {"labels": noisy - 10 * (noisy > 0) + 8 - (noisy > 1)}),
                ("smoothness_weight is -1", {"labels": noisy, "smoothness_weight": -1}),
                ("colours are 4000, expected 4000 x 3",
                 {"labels": noisy, "colours": noisy})]:
            with self.assertRaisesRegex(ValueError, message):
                pcl_semantic.refine(**{"points": points, **arguments})
        with self.assertRaisesRegex(TypeError, "unknown parameter 'smooth'"):
            pcl_semantic.refine(points, labels=noisy, smooth=1)


def scans_of_walls():
    """Two scans of the walls, class 1 and 3, from 10 m ahead of the origin."""
    points, labels, _ = two_walls()
    probabilities = np.full((4000, 11), 0.01, np.float32)
    probabilities[np.arange(4000), np.where(labels == 1, 0, 2)] = 1
    for x in (10, 10.5):
        pose = np.eye(4)
        pose[0, 3] = x
        yield points - [x - 10, 1.5, 1], pose, probabilities


class Map(unittest.TestCase):
    def test_scans_become_labelled_voxels(self):
        voxel_map = pcl_semantic.SemanticVoxelMap(LABEL_SET, voxel_size=0.2,
                                                  window=(20, 20, 8))
        for points, pose, probabilities in scans_of_walls():
            counts = voxel_map.integrate(points, pose, probabilities=probabilities)
            self.assertEqual((counts["points"], counts["rays"]), (4000, 4000))
        voxels = voxel_map.voxels()
        self.assertGreater(len(voxels["points"]), 100)
        self.assertGreaterEqual(voxels["points"][:, 0].min(), 10)
        np.testing.assert_array_equal(
            voxels["labels"], np.where(voxels["points"][:, 1] > 0, 3, 1))
        np.testing.assert_array_equal(np.floor(voxels["points"] / 0.2), voxels["indices"])
        self.assertEqual(voxels["observations"].max(), 2)
        np.testing.assert_array_equal(voxel_map.labels(voxels["points"]),
                                      voxels["labels"])

    def test_a_transposed_pose_is_refused(self):
        pose = np.eye(4)
        pose[:3, 3] = [10, 20, 1]
        voxels = pcl_semantic.SemanticVoxelMap("kitti11", voxel_size=0.1)
        with self.assertRaisesRegex(ValueError, "expected 0 0 0 1 .is the matrix tr"):
            voxels.integrate(np.array([[5.0, 0, 0]]), pose.T)
        rounded = pose.copy()
        rounded[3] += [1e-16, -1e-9, 0, 1e-9]  # of an inverse
        voxels.integrate(np.array([[5.0, 0, 0]]), rounded)
        np.testing.assert_allclose(voxels.voxels()["points"], [[15, 20, 1]], atol=0.1)

    def test_what_it_cannot_take_is_refused(self):
        with self.assertRaisesRegex(ValueError, "none.yaml"):
            pcl_semantic.SemanticVoxelMap("none.yaml")
        with self.assertRaisesRegex(ValueError, "voxel_size"):
            pcl_semantic.SemanticVoxelMap(LABEL_SET, voxel_size=-1)
        voxel_map = pcl_semantic.SemanticVoxelMap(LABEL_SET)
        for message, arguments in [
                ("4 x 4", (np.zeros((2, 3)), np.eye(3))),
                ("not a rotation", (np.zeros((2, 3)), np.diag([2.0, 2, 2, 1]))),
                ("N x 3", (np.zeros((2, 2)), np.eye(4)))]:
            with self.assertRaisesRegex(ValueError, message):
                voxel_map.integrate(*arguments)
        with self.assertRaisesRegex(ValueError, "3"):
            voxel_map.integrate(np.ones((2, 3)), np.eye(4),
                                probabilities=np.ones((2, 3)))

    def test_an_archive_gives_the_map_back(self):
        voxel_map = pcl_semantic.SemanticVoxelMap("kitti11", voxel_size=0.2)
        for points, pose, probabilities in scans_of_walls():
            voxel_map.integrate(points, pose, probabilities=probabilities)
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "walls.map")
            voxel_map.save(path)
            with self.assertRaisesRegex(OSError, "walls.map"):
                voxel_map.save(path)
            loaded = pcl_semantic.load_map(path)
            cloud = os.path.join(folder, "walls.pcd")
            loaded.write(cloud, class_colours=True)
            fields = pcl_semantic.read_cloud(cloud)
        expected, found = voxel_map.voxels(), loaded.voxels()
        for name in expected:
            np.testing.assert_array_equal(found[name], expected[name])
        np.testing.assert_array_equal(fields["label"], expected["labels"])
        loaded.move_window([10, 0, 0])
        np.testing.assert_array_equal(loaded.labels(expected["points"]),
                                      expected["labels"])


class Mapper(unittest.TestCase):
    def test_clouds_become_a_refined_map(self):
        mapper = pcl_semantic.SemanticMapper(LABEL_SET, voxel_size=0.2, crf="dense")
        for points, pose, probabilities in scans_of_walls():
            frame = mapper.process(points, pose, probabilities=probabilities)
        mapper.finish()
        voxels = mapper.voxels()
        np.testing.assert_array_equal(frame["voxels"]["labels"], voxels["labels"])
        np.testing.assert_array_equal(
            voxels["labels"], np.where(voxels["points"][:, 1] > 0, 3, 1))

    def test_the_map_is_that_of_the_program_to_the_byte(self):
        programs = os.environ["PCL_SEMANTIC_BIN"]
        with tempfile.TemporaryDirectory() as folder:
            os.mkdir(os.path.join(folder, "clouds"))
            lines = []
            mapper = pcl_semantic.SemanticMapper(LABEL_SET, voxel_size=0.2)
            for i, (points, pose, probabilities) in enumerate(scans_of_walls()):
                points = points.astype(np.float32)
                x, y, z = points.T
                pcl_semantic.write_cloud(
                    os.path.join(folder, "clouds", f"{i}.pcd"),
                    {"x": x, "y": y, "z": z, "probability": probabilities})
                lines.append(" ".join(str(number) for number in pose[:3].ravel()))
                mapper.process(points, pose, probabilities=probabilities)
            mapper.finish()
            mapper.write(os.path.join(folder, "python.pcd"))
            with open(os.path.join(folder, "poses.txt"), "w") as file:
                file.write("\n".join(lines) + "\n")
            subprocess.run(
                [os.path.join(programs, "pcl_semantic_map"), "--clouds",
                 os.path.join(folder, "clouds"), "--poses",
                 os.path.join(folder, "poses.txt"), "--label-set", LABEL_SET,
                 "--voxel-size", "0.2", "--output", os.path.join(folder, "map"),
                 "--quiet"], check=True)
            with open(os.path.join(folder, "map", "map.pcd"), "rb") as file:
                expected = file.read()
            with open(os.path.join(folder, "python.pcd"), "rb") as file:
                self.assertEqual(file.read(), expected)

    def test_pairs_need_the_camera(self):
        image = np.zeros((40, 60), np.uint8)
        mapper = pcl_semantic.SemanticMapper(LABEL_SET)
        with self.assertRaisesRegex(ValueError, "camera="):
            mapper.process_pair(image, image, np.eye(4), np.ones((2400, 11)))
        with self.assertRaisesRegex(ValueError, "expected seven"):
            pcl_semantic.SemanticMapper(LABEL_SET, camera=[1, 2])
        with self.assertRaisesRegex(ValueError, "image size is 6.5 x 1e"):
            pcl_semantic.SemanticMapper(LABEL_SET, camera=[1, 2, 3, 4, 5, 6.5, 1e300])
        with self.assertRaisesRegex(ValueError, "size is 64.5 x 48, expected whole"):
            pcl_semantic.SemanticMapper(LABEL_SET, camera=[50, 50, 30, 20, 0.5, 64.5, 48])
        mapper = pcl_semantic.SemanticMapper(LABEL_SET, disparities=64,
                                             camera=[50, 50, 30, 20, 0.5, 60, 40])
        with self.assertRaisesRegex(ValueError, "probabilities are None, expected those of"):
            mapper.process_pair(image, image, np.eye(4), None)
        with self.assertRaisesRegex(ValueError, "the left image is 39 x 60, expected 40 x 60"):
            mapper.process_pair(image[1:], image, np.eye(4), np.ones((2400, 11)))

    def test_pairs_of_no_depth_are_told_of(self):
        random = np.random.default_rng(1)
        wide = np.kron(random.integers(0, 256, (60, 164), np.uint8),
                       np.ones((8, 4), np.uint8))
        left, right = wide[:, :640], wide[:, 16:]
        probabilities = np.full((480 * 640, 11), 1 / 11, np.float32)
        for pair, message in (((right, left), "swapped"), ((left, left), "the same image"),
                              ((left * 0, left * 0), "blank")):
            mapper = pcl_semantic.SemanticMapper(
                LABEL_SET, crf="none", camera=[400, 400, 320, 240, 0.5, 640, 480])
            with warnings.catch_warnings(record=True) as told:
                warnings.simplefilter("always")
                for _ in range(2):
                    mapper.process_pair(*pair, np.eye(4), probabilities)
            self.assertEqual(len(told), 1)
            self.assertRegex(str(told[0].message), "frame 0: .*" + message)

    def test_an_object_without_init_is_refused(self):
        for kind in (pcl_semantic.SemanticMapper, pcl_semantic.SemanticVoxelMap):
            with self.assertRaisesRegex(TypeError, "__init__"):
                kind.__new__(kind).voxels()

    def test_a_pair_becomes_voxels(self):
        random = np.random.default_rng(1)
        wide = random.integers(0, 256, (96, 168), np.uint8)
        left, right = wide[:, :160], wide[:, 8:]  # 8 px: 50 * 0.5 / 8 = 3.1 m ahead
        mapper = pcl_semantic.SemanticMapper(LABEL_SET, disparities=64, crf="none",
                                             camera=[50, 50, 80, 48, 0.5, 160, 96])
        probabilities = np.zeros((96 * 160, 11))
        probabilities[:, 4] = 1
        frame = mapper.process_pair(np.dstack([left] * 3), np.dstack([right] * 3),
                                    np.eye(4), probabilities)
        voxels = frame["voxels"]
        self.assertGreater(len(voxels["labels"]), 100)
        self.assertEqual(set(voxels["labels"]), {5})
        self.assertAlmostEqual(np.median(voxels["points"][:, 2]), 25 / 8, delta=0.1)

    def test_an_rgbd_frame_becomes_voxels(self):
        camera = [50, 50, 30, 20, 1, 60, 40]
        depths = np.full((40, 60), 2.0)
        depths[0] = [0, np.nan] * 30
        image = np.zeros((40, 60, 3), np.uint8)
        image[:] = 10, 20, 30
        probabilities = np.zeros((2400, 11))
        probabilities[:, 4] = 1
        for labels in (None, probabilities, probabilities.reshape(40, 60, 11)):
            mapper = pcl_semantic.SemanticMapper(LABEL_SET, crf="none", camera=camera)
            frame = mapper.process_rgbd(image, depths, np.eye(4), probabilities=labels)
            voxels = frame["voxels"]
            self.assertEqual(frame["invalid"], 60)
            self.assertAlmostEqual(np.median(voxels["points"][:, 2]), 2, delta=0.1)
            self.assertEqual(list(voxels["colours"][0]), [10, 20, 30])
            self.assertEqual(set(voxels["labels"]), {0} if labels is None else {5})
        with self.assertRaisesRegex(ValueError, "depths are no floats, expected metres"):
            mapper.process_rgbd(image, (1000 * np.ones((40, 60))).astype(np.uint16), np.eye(4))
        with self.assertRaisesRegex(ValueError, "depths"):
            mapper.process_rgbd(image, depths[1:], np.eye(4))
        with self.assertRaisesRegex(ValueError, "RGB-D frames need the camera"):
            pcl_semantic.SemanticMapper(LABEL_SET).process_rgbd(image, depths, np.eye(4))


class Cameras(unittest.TestCase):
    K = "K: [400, 0, 320, 0, 401, 240, 0, 0, 1]\n"

    def read(self, text):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "c.yaml")
            with open(path, "w") as file:
                file.write(text)
            return pcl_semantic.read_camera(path)

    def test_what_a_file_states(self):
        binned = "width: 640\nheight: 480\nbinning_x: 2\nbinning_y: 2\n" + self.K
        self.assertEqual(self.read(binned), {"fx": 200, "fy": 200.5, "cx": 160, "cy": 120,
                                             "width": 320, "height": 240})
        with self.assertRaisesRegex(ValueError, "c.yaml line 2: distortion_model is 'fov'"):
            self.read(self.K + "distortion_model: fov\n")
        with self.assertWarnsRegex(UserWarning, "not the left one of its pair"):
            self.read(self.K + "P: [400, 0, 320, -40, 0, 401, 240, 0, 0, 0, 1, 0]\n")

    def test_a_camera_of_other_images_is_doubtful(self):
        with self.assertWarnsRegex(UserWarning, "c.yaml: the principal point .*320 x 240"):
            self.read("width: 320\nheight: 240\n" + self.K)
        with self.assertWarnsRegex(UserWarning, "images of another size"):
            pcl_semantic.SemanticMapper(LABEL_SET, camera=[50, 50, 10, 8, 0.5, 60, 40])


class Files(unittest.TestCase):
    def test_arrays_of_the_other_byte_order_are_written_as_what_they_say(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "a.pcd")
            for floats, integers in ((">f4", ">i4"), (">f8", ">u2"), ("<f4", "<i8")):
                cloud = {a: np.array([1.5, 2.5], floats) for a in "xyz"}
                cloud["label"] = np.array([1, 2], integers)
                pcl_semantic.write_cloud(path, cloud)
                read = pcl_semantic.read_cloud(path)
                self.assertEqual(read["x"].tolist(), [1.5, 2.5])
                self.assertEqual(read["label"].tolist(), [1, 2])

    def test_fields_come_back(self):
        cloud = {"x": np.arange(3, dtype=np.float32), "intensity": np.arange(3.0),
                 "label": np.array([1, 2, 300], np.uint16),
                 "probability": np.arange(6, dtype=np.float32).reshape(3, 2)}
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "cloud.pcd")
            pcl_semantic.write_cloud(path, cloud)
            found = pcl_semantic.read_cloud(path)
            for broken in ({"x": np.zeros((2, 2, 2))}, {"x": np.array(["a"])},
                           {"x": np.zeros(2), "y": np.zeros(3)}, {"a b": np.zeros(2)}):
                with self.assertRaises(ValueError):
                    pcl_semantic.write_cloud(os.path.join(folder, "no.pcd"), broken)
            for name in ("a b", "_", "", "a\nb"):
                with self.assertRaisesRegex(ValueError, "cannot be the name of a field"):
                    pcl_semantic.write_cloud(os.path.join(folder, "no.pcd"),
                                             {name: np.zeros(2)})
            with self.assertRaisesRegex(TypeError, "the name of a field is 3, expected a str"):
                pcl_semantic.write_cloud(os.path.join(folder, "no.pcd"), {3: np.zeros(2)})
            with self.assertRaisesRegex(ValueError, "ends in .pcd"):
                pcl_semantic.write_cloud(os.path.join(folder, "no.ply"), cloud)
            self.assertEqual(os.listdir(folder), ["cloud.pcd"])
        self.assertEqual(list(found), list(cloud))
        for name, column in cloud.items():
            self.assertEqual(found[name].dtype, column.dtype)
            np.testing.assert_array_equal(found[name], column)
        with self.assertRaisesRegex(ValueError, "none.pcd"):
            pcl_semantic.read_cloud("none.pcd")


class Cliques(unittest.TestCase):
    def test_cubes_are_numbered(self):
        numbers = pcl_semantic.cliques([[0.5, 0.5, 0.5], [0.6, 0.5, 0.5], [5, 5, 5],
                                        [5.1, 5, 5], [np.nan, 0, 0]], "cubes:1")
        self.assertEqual(numbers[0], numbers[1])
        self.assertEqual(numbers[2], numbers[3])
        self.assertEqual(len({numbers[0], numbers[2], 0}), 3)
        self.assertEqual(numbers[4], 0)
        with self.assertRaisesRegex(ValueError, "squares"):
            pcl_semantic.cliques([[0, 0, 0]], "squares")


class Objects(unittest.TestCase):
    def test_planes(self):
        x, y = np.meshgrid(np.arange(0, 2, 0.05), np.arange(0, 1, 0.05))
        floor = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])
        wall = floor[:, [0, 2, 1]] + [0, 3, 5]
        points = np.concatenate([floor, wall]) + [1e6, 0, 0]  # too far for single precision
        labels = np.repeat([3, 1], x.size)
        numbers, planes = pcl_semantic.planes(points, labels=labels)
        np.testing.assert_array_equal(numbers, np.repeat([1, 2], x.size))
        self.assertEqual([each["label"] for each in planes], [3, 1])
        np.testing.assert_allclose(planes[0]["normal"], [0, 0, 1], atol=1e-6)
        np.testing.assert_allclose(planes[1]["normal"], [0, 1, 0], atol=1e-6)
        self.assertAlmostEqual(planes[1]["offset"], -3, places=5)
        self.assertAlmostEqual(planes[0]["area"], 2, delta=0.4)
        outer = np.array(planes[0]["polygons"][0]["outer"])
        self.assertLess(abs(outer[:, 0].mean() - 1e6 - 1), 0.3)
        self.assertEqual(pcl_semantic.planes(points, min_area=9)[0].max(), 0)
        self.assertEqual(pcl_semantic.planes([])[1], [])
        with self.assertRaisesRegex(Exception, "radius of planes"):
            pcl_semantic.planes(points, radius=-1)

    def test_groups_of_one_label_are_numbered(self):
        points = [[0, 0, 0], [0.5, 0, 0], [1, 0, 0], [3, 0, 0], [3.5, 0, 0], [0, 0.1, 0],
                  [np.nan, 0, 0]]
        labels = [6, 6, 6, 6, 6, 7, 6]
        np.testing.assert_array_equal(
            pcl_semantic.objects(points, labels, min_points=2), [1, 1, 1, 2, 2, 0, 0])
        np.testing.assert_array_equal(
            pcl_semantic.objects(points, labels, gap=2.5, min_points=1),
            [1, 1, 1, 1, 1, 2, 0])
        self.assertEqual(pcl_semantic.objects(points, labels).max(), 0)
        self.assertEqual(pcl_semantic.objects([], []).shape, (0,))
        for arguments, says in (({"gap": 0}, "gap"), ({"min_points": 0}, "min_points is 0"),
                                ({"labels": labels[:3]}, "labels")):
            with self.assertRaisesRegex(ValueError, says):
                pcl_semantic.objects(points, **{"labels": labels, **arguments})


class Evaluation(unittest.TestCase):
    def test_counts_by_truth_and_prediction(self):
        matrix = pcl_semantic.confusion_matrix([0, 1, 1, 2], [1, 1, 2, 2], 2)
        np.testing.assert_array_equal(matrix, [[0, 1, 0], [0, 1, 1], [0, 0, 1]])
        scores = pcl_semantic.scores(matrix)
        np.testing.assert_allclose(scores["iou"], [0.5, 0.5])
        self.assertAlmostEqual(scores["global_accuracy"], 2 / 3)
        for prediction, shape in (([1], "1"), ([[1, 1], [2, 2]], "2 x 2")):
            with self.assertRaisesRegex(ValueError, f"are 4, predicted ones {shape}, expected"):
                pcl_semantic.confusion_matrix([0, 1, 1, 2], prediction, 2)
        for counts, message in ((np.array([[0, 0], [0, -5]]), "counts hold -5, expected 0 to"),
                                (np.full((2, 2), 2**63, "u8"), "more than 64 bits")):
            with self.assertRaisesRegex(ValueError, message):
                pcl_semantic.scores(counts)
        with self.assertRaisesRegex(ValueError, "confusion_matrix"):
            pcl_semantic.scores([1, 2])


class Probabilities(unittest.TestCase):
    def test_sum_to_one_as_in_files(self):
        points, _, noisy = two_walls()
        softmax = np.full((4000, 2), 0.2)
        softmax[np.arange(4000), noisy - 1] = 0.8
        expected, _ = pcl_semantic.refine(points, probabilities=softmax)
        for same in (softmax * 1.05, softmax.astype(np.float16), softmax.astype(">f4"),
                     np.asfortranarray(softmax), softmax.tolist()):
            refined, _ = pcl_semantic.refine(points, probabilities=same)
            np.testing.assert_array_equal(refined, expected)
        unlabelled = softmax.copy()
        unlabelled[:7] = 0
        pcl_semantic.refine(points, probabilities=unlabelled)
        grid = pcl_semantic.SemanticVoxelMap("kitti11")
        logits = np.log(softmax)
        for message, wrong in [
                ("point 0 sum to (1e-50|9.99+e-51), expected 1", softmax * 1e-50),
                ("point 0 sum to 1.2, expected 1", softmax * 1.2),
                ("point 0 sum to .*softmax", logits + 3),
                ("point 0 hold -.*softmax", logits),
                ("point 0 hold nan", softmax * np.nan),
                ("point . sum to 2, expected 1", noisy[:, None]),
                ("point 0 sum to 255", np.where(softmax > 0.5, 255, 0).astype(np.uint8))]:
            with self.assertRaisesRegex(ValueError, message):
                pcl_semantic.refine(points, probabilities=wrong)
            with self.assertRaisesRegex(ValueError, message):
                grid.integrate(points, np.eye(4), probabilities=wrong)


class Precision(unittest.TestCase):
    """Positions of few digits are told of, once, wherever they come in."""

    UTM = np.array([691012.4, 5334765.2, 512.0])

    def warnings_of(self, call):
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always")
            call()
        return [str(each.message) for each in told]

    def test_of_maps(self):
        pose = np.eye(4)
        pose[:3, 3] = self.UTM
        points = two_walls()[0] + np.float32(1)
        grid = pcl_semantic.SemanticVoxelMap("kitti11", voxel_size=0.2)
        mapper = pcl_semantic.SemanticMapper("kitti11", voxel_size=0.2, crf="none")
        world = points + self.UTM
        self.assertEqual(self.warnings_of(lambda: grid.integrate(points, pose)), [])
        self.assertEqual(self.warnings_of(lambda: mapper.process(points, pose)), [])
        self.assertEqual(self.warnings_of(lambda: grid.labels(world)), [])
        for call, name in [(lambda: grid.integrate(points, pose.astype("f4")), "the pose"),
                           (lambda: mapper.process(points, pose.astype("f4")), "the pose"),
                           (lambda: grid.labels(world.astype("f4")), "points")]:
            told = self.warnings_of(call)
            self.assertEqual(len(told), 1, told)
            self.assertIn(f"{name}: single precision has steps of 0.5 m", told[0])
            self.assertIn("a tenth of a voxel, 0.2 m", told[0])
        told = self.warnings_of(lambda: grid.integrate(world, np.eye(4)))
        self.assertEqual(len(told), 1, told)  # doubles are no way out
        self.assertRegex(told[0], "steps of 0.5 m.*in the frame of the sensor, and its pose$")

    def test_of_half_precision(self):
        points = two_walls()[0]
        labels = np.ones(4000, int)
        grid = pcl_semantic.SemanticVoxelMap("kitti11")
        for shift, is_told in ((0, False), (200, True)):
            half = (points + shift).astype(np.float16)
            for call in (lambda: pcl_semantic.refine(half, labels=labels),
                         lambda: pcl_semantic.cliques(half),
                         lambda: grid.integrate(half, np.eye(4))):
                told = self.warnings_of(call)
                self.assertEqual(len(told), int(is_told), told)
                if is_told:
                    self.assertIn("half precision has steps of 0.125 m at 20", told[0])

    def test_of_files(self):
        points = two_walls()[0]
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "a.pcd")
            for shift, kind, count in ((0, "f4", 0), (self.UTM, "f4", 1), (self.UTM, "f8", 0)):
                pcl_semantic.write_cloud(
                    path, dict(zip("xyz", (points + shift).astype(kind).T)))
                told = self.warnings_of(lambda: pcl_semantic.read_cloud(path))
                self.assertEqual(len(told), count, told)
                if count:
                    self.assertIn("a.pcd: single precision has steps of 0.5 m", told[0])
            with open(path, "rb") as file:
                text = file.read().replace(b"VIEWPOINT 0 0 0", b"VIEWPOINT 7 0 0")
            with open(path, "wb") as file:
                file.write(text)
            with self.assertWarnsRegex(UserWarning, "VIEWPOINT, 7 0 0 1 0 0 0, is not read"):
                pcl_semantic.read_cloud(path)

    def test_a_map_far_away_comes_back_where_it_was(self):
        pose = np.eye(4)
        pose[:3, 3] = self.UTM
        grid = pcl_semantic.SemanticVoxelMap("kitti11", voxel_size=0.2)
        grid.integrate(two_walls()[0] + np.float32(1), pose)
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "a.pcd")
            grid.write(path)
            cloud = pcl_semantic.read_cloud(path)
            pcl_semantic.write_cloud(path, cloud)
            again = pcl_semantic.read_cloud(path)
        for found in (cloud, again):
            np.testing.assert_array_equal(
                np.column_stack([found[axis] for axis in "xyz"]), grid.voxels()["points"])


class Unread(unittest.TestCase):
    def test_parameters_without_effect_are_refused(self):
        points, _, noisy = two_walls()
        softmax = np.full((4000, 2), 0.5)
        refine = lambda **given: pcl_semantic.refine(points, **given)
        grid = lambda **given: pcl_semantic.SemanticVoxelMap("kitti11", **given)
        mapper = lambda **given: pcl_semantic.SemanticMapper("kitti11", **given)
        camera = (50, 50, 31.5, 23.5, 0.1, 64, 48)
        for call, given, message in [
                (refine, {"probabilities": softmax, "classes": 2},
                 "classes has no effect beside probabilities"),
                (refine, {"probabilities": softmax, "label_confidence": 0.9},
                 "label_confidence has no effect beside probabilities"),
                (refine, {"labels": noisy, "clique_weight": 9},
                 "clique_weight has no effect with crf='dense'"),
                (refine, {"labels": noisy, "crf": "unary", "smoothness_weight": 1},
                 "smoothness_weight has no effect with crf='unary'"),
                (refine, {"labels": noisy, "crf": "unary", "thin": [1]},
                 "thin has no effect with crf='unary'"),
                (refine, {"labels": noisy, "crf_keep_thin": True},
                 "crf_keep_thin has no effect without thin="),
                (refine, {"labels": noisy, "cliques": noisy},
                 "cliques has no effect with crf='dense'"),
                (refine, {"labels": noisy, "crf": "hierarchical"},
                 "crf='hierarchical' needs cliques"),
                (grid, {"crf": "dense"}, "crf has no effect in a SemanticVoxelMap"),
                (grid, {"stereo": "sgm"}, "stereo has no effect in a SemanticVoxelMap"),
                (grid, {"crf_iterations": 3}, "crf_iterations has no effect in a Sem"),
                (mapper, {"stereo": "sgm"}, "stereo has no effect without camera="),
                (mapper, {"network_every": 2}, "network_every has no effect without camera="),
                (mapper, {"label_confidence": 0.9}, "label_confidence has no effect beside"),
                (mapper, {"clique_weight": 9}, "clique_weight has no effect with crf='dense'"),
                (mapper, {"crf": "hierarchical", "superpixel_depth_jump": 1},
                 "superpixel_depth_jump has no effect with cliques='planes'"),
                (mapper, {"crf": "none", "crf_every": 2}, "crf_every has no effect with crf='none")]:
            with self.assertRaisesRegex(ValueError, message):
                call(**given)
        grid(window=(20, 20, 8), clearing="full", pixel_fusion="product", threads=1,
             max_depth=30, hit_probability=0.7)
        mapper(camera=camera, stereo="sgm", network_every=2)

    def test_values_out_of_range_are_refused(self):
        points, _, noisy = two_walls()
        for message, given in [
                ("thin labels hold 259, expected 1 to 255", {"thin": [259]}),
                ("thin labels hold -253", {"thin": [-253]}),
                ("thin labels hold 0", {"thin": [0]}),
                ("thin labels: 3, expected 1 to 2", {"thin": [3]}),
                ("classes is -5, expected 1 to 255, or 0", {"classes": -5}),
                ("labels: 4294967295 of point 0 is class 65535 of an instance",
                 {"labels": np.full(4000, 2**32 - 1, "u4")}),
                ("labels: -1 of point 0, expected", {"labels": np.full(4000, -1)}),
                ("labels hold 9223372036854775809", {"labels": np.full(4000, 2**63 + 1, "u8")})]:
            with self.assertRaisesRegex(ValueError, message):
                pcl_semantic.refine(points, **{"labels": noisy, **given})
        with self.assertRaisesRegex(ValueError, "max_depth is 1e.09 m, expected .* at most 1e4"):
            pcl_semantic.SemanticVoxelMap("kitti11", max_depth=1e9)
        pcl_semantic.SemanticVoxelMap("kitti11", voxel_size=np.array(0.3),
                                      per_ray_counting=np.bool_(True))


class Threads(unittest.TestCase):
    def test_others_run_while_the_crf_does(self):
        points, _, noisy = two_walls()
        expected = pcl_semantic.refine(points, labels=noisy)[1].tobytes()
        found = []

        def work():
            found.append(pcl_semantic.refine(points, labels=noisy)[1].tobytes())

        threads = [threading.Thread(target=work) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(found, [expected] * 4)


    def test_pairs_of_two_threads_wait_for_each_other(self):
        code = """if True:
            import threading, numpy as np, pcl_semantic
            wide = np.random.default_rng(1).integers(0, 256, (96, 168), np.uint8)
            mapper = pcl_semantic.SemanticMapper("kitti11", disparities=64, crf="none",
                                                 camera=[50, 50, 80, 48, 0.5, 160, 96])
            threads = [threading.Thread(target=lambda: [mapper.process_pair(
                wide[:, :160], wide[:, 8:], np.eye(4), np.full((96 * 160, 11), 1 / 11))
                for _ in range(5)]) for _ in range(3)]
            for thread in threads: thread.start()
            for thread in threads: thread.join()"""
        subprocess.run([sys.executable, "-c", code], check=True, timeout=60)


class Doubts(unittest.TestCase):
    def test_instances_are_taken_off_labels(self):
        points, _, noisy = two_walls()
        expected = pcl_semantic.refine(points, labels=noisy)[0]
        for number in (noisy + (7 << 16), (noisy + (40000 << 16)).astype(np.uint32),
                       (noisy + (40000 << 16)).astype(np.uint32).view(np.int32),
                       (noisy + (65535 << 16)).astype(np.uint32).view(np.int32)):
            np.testing.assert_array_equal(
                pcl_semantic.refine(points, labels=number)[0], expected)
        counts = pcl_semantic.confusion_matrix([1, 2 + (9 << 16)], [1, 2], 2)
        np.testing.assert_array_equal(counts, np.diag([0, 1, 1]))
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "a.pcd")
            x, y, z = points.T
            pcl_semantic.write_cloud(path, {"x": x, "y": y, "z": z,
                                            "label": (noisy + (7 << 16)).astype("u4")})
            cloud = pcl_semantic.read_cloud(path)
            np.testing.assert_array_equal(cloud["label"], noisy)
            pcl_semantic.write_cloud(path, cloud)
            self.assertEqual(set(pcl_semantic.read_cloud(path)["instance"]), {7})

    def test_nothing_gives_nothing(self):
        points, none = np.zeros((0, 3)), np.zeros(0, int)
        labels, probabilities = pcl_semantic.refine(points, labels=none, classes=4)
        self.assertEqual((labels.shape, probabilities.shape), ((0,), (0, 4)))
        self.assertEqual(pcl_semantic.refine(
            points, probabilities=np.zeros((0, 4)), crf="hierarchical",
            cliques="cubes:1")[1].shape, (0, 4))
        for kind in ("cubes:1", "supervoxel:1"):
            self.assertEqual(pcl_semantic.cliques(points, kind).shape, (0,))
        grid = pcl_semantic.SemanticVoxelMap("kitti11")
        self.assertEqual(grid.integrate(points, np.eye(4))["rays"], 0)
        self.assertEqual(grid.labels(points).shape, (0,))
        for camera in (None, [100, 100, 50, 40, 0.5, 100, 80]):
            mapper = pcl_semantic.SemanticMapper("kitti11", camera=camera)
            self.assertEqual(mapper.process(points, np.eye(4))["rays"], 0)
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "a.pcd")
            pcl_semantic.write_cloud(path, dict(zip("xyz", points.T)))
            self.assertEqual(pcl_semantic.read_cloud(path)["x"].shape, (0,))
        labels, probabilities = pcl_semantic.refine([], probabilities=np.zeros((0, 0)))
        self.assertEqual((labels.shape, probabilities.shape), ((0,), (0, 0)))
        self.assertEqual(pcl_semantic.refine([], labels=[], colours=[])[0].shape, (0,))
        self.assertEqual(pcl_semantic.cliques([]).shape, (0,))
        self.assertEqual(grid.integrate([], np.eye(4), probabilities=[])["points"], 0)
        self.assertEqual(grid.labels([]).shape, (0,))

    def test_no_returns_are_passed_over_and_told(self):
        points, _, noisy = two_walls()
        points[:100] = 0
        with self.assertWarnsRegex(UserWarning, "100 points at exactly 0 0 0"):
            labels, _ = pcl_semantic.refine(points, labels=noisy)
        np.testing.assert_array_equal(labels[:100], noisy[:100])
        with self.assertWarnsRegex(UserWarning, "100 points at exactly 0 0 0"):
            self.assertFalse(pcl_semantic.cliques(points)[:100].any())
        counts = pcl_semantic.SemanticVoxelMap("kitti11").integrate(points, np.eye(4))
        self.assertEqual(counts["invalid"], 100)

    def test_fields_and_columns_that_are_not_read(self):
        values = np.random.default_rng(1).uniform(0, 1, (40, 5)).astype(np.float32)
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "a.pcd")
            cloud = dict(zip(["x", "y", "z", "r", "my_label"], values.T))
            pcl_semantic.write_cloud(path, cloud)
            with self.assertWarnsRegex(UserWarning, "'my_label' is not read as labels"):
                pcl_semantic.read_cloud(path)
            with self.assertRaisesRegex(ValueError, "scan columns are for .bin"):
                pcl_semantic.read_cloud(path, scan_columns=5)
            path = os.path.join(folder, "a.bin")
            values.tofile(path)
            for columns in (5, "x,y,z,intensity,ring", ["x", "y", "z", "_", "ring"]):
                found = pcl_semantic.read_cloud(path, scan_columns=columns)
                np.testing.assert_array_equal(found["ring"], values[:, 4])


class Guide(unittest.TestCase):
    def run_script(self, folder, *command):
        return subprocess.run([sys.executable, *command], cwd=folder, check=True,
                              capture_output=True, text=True).stdout

    def test_its_blocks_run_as_they_are(self):
        with open(os.path.join(HERE, "..", "doc", "python.md")) as file:
            blocks = re.findall(r"```python\n(.*?)```", file.read(), re.DOTALL)
        self.assertEqual(len(blocks), 4)
        with tempfile.TemporaryDirectory() as folder:
            output = self.run_script(folder, "-c", "\n".join(blocks))
            self.assertEqual(sorted(os.listdir(folder)),
                             ["drive.map", "grouped.pcd", "map.pcd"])
        self.assertTrue(output.endswith("1.0\n"), output)

    def test_the_example_mends_labels(self):
        script = os.path.join(HERE, "softmax_to_labels.py")
        points, labels, _ = two_walls()
        with tempfile.TemporaryDirectory() as folder:
            output = self.run_script(folder, script)
            found = [float(x) for x in re.findall(r"mean IoU ([0-9.]+)", output)]
            self.assertLess(found[0], 0.7)
            self.assertGreater(found[1], 0.95)
            pcl_semantic.write_cloud(os.path.join(folder, "in.pcd"),
                                     {**dict(zip("xyz", points.T)), "ring": labels})
            np.save(os.path.join(folder, "softmax.npy"), np.eye(2)[labels - 1])
            self.run_script(folder, script, "in.pcd", "softmax.npy", "out.pcd")
            refined = pcl_semantic.read_cloud(os.path.join(folder, "out.pcd"))
        np.testing.assert_array_equal(refined["label"], labels)
        np.testing.assert_array_equal(refined["ring"], labels)


class Paths(unittest.TestCase):
    def test_a_nul_is_refused_and_writes_nothing(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "a.pcd\0.pcd")
            empty = pcl_semantic.SemanticVoxelMap("kitti11")
            for call in (lambda: pcl_semantic.read_cloud(path),
                         lambda: pcl_semantic.write_cloud(path, {"x": np.zeros(1)}),
                         lambda: pcl_semantic.load_map(path),
                         lambda: pcl_semantic.SemanticVoxelMap("kitti11\0"),
                         lambda: pcl_semantic.SemanticMapper("kitti11\0"),
                         lambda: empty.write(path), lambda: empty.save(path)):
                with self.assertRaisesRegex(ValueError, "embedded null"):
                    call()
            self.assertEqual(os.listdir(folder), [])

    def test_may_be_of_pathlib_and_bytes(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "a.pcd"
            pcl_semantic.write_cloud(path, {"x": np.ones(1, np.float32)})
            for each in (path, bytes(path), str(path)):
                self.assertEqual(pcl_semantic.read_cloud(each)["x"][0], 1)
            empty = pcl_semantic.SemanticVoxelMap(pathlib.Path(LABEL_SET))
            empty.save(pathlib.Path(folder) / "a.map")
            pcl_semantic.load_map(pathlib.Path(folder) / "a.map")
        with self.assertRaises(TypeError):
            pcl_semantic.read_cloud(7)


class ComplexNumbers(unittest.TestCase):
    def test_are_refused(self):
        points, _, noisy = two_walls()
        mapper = pcl_semantic.SemanticMapper("kitti11")
        for call in (lambda: pcl_semantic.refine(points + 1j, labels=noisy),
                     lambda: pcl_semantic.refine(points, probabilities=np.eye(2)[noisy - 1] * 1j),
                     lambda: pcl_semantic.refine(points, labels=noisy * 1j),
                     lambda: pcl_semantic.cliques(points + 0j),
                     lambda: mapper.process(points, np.eye(4) + 0j),
                     lambda: mapper.labels(points + 0j)):
            with self.assertRaises(ValueError):
                call()


class Interrupted(unittest.TestCase):
    def test_ctrl_c_ends_a_long_run(self):
        points, _, noisy = two_walls()
        press = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
        press.start()
        with self.assertRaises(KeyboardInterrupt):
            pcl_semantic.refine(points, labels=noisy, crf="dense", crf_iterations=10**7)
        press.join()


class Forked(unittest.TestCase):
    def run_in_child(self, work):
        child = multiprocessing.get_context("fork").Process(target=work)
        child.start()
        child.join(60)
        hangs = child.is_alive()
        if hangs:
            child.kill()
        self.assertFalse(hangs)
        self.assertEqual(child.exitcode, 0)

    def test_a_child_computes_what_its_parent_does(self):
        points, _, noisy = two_walls()
        for threads in (1, 2, 0):
            with self.subTest(threads=threads):
                def refine():
                    return pcl_semantic.refine(points, labels=noisy, threads=threads,
                                               crf="hierarchical", cliques="supervoxel:0.5")

                expected, _ = refine()
                def child():
                    np.testing.assert_array_equal(refine()[0], expected)
                self.run_in_child(child)

    def test_a_child_refuses_stereo_pairs(self):
        camera = (100, 100, 40, 30, 0.5, 80, 60)
        mapper = pcl_semantic.SemanticMapper("kitti11", camera=camera)
        image = np.zeros((60, 80), np.uint8)
        def child():
            with self.assertRaisesRegex(ValueError, "fork"):
                mapper.process_pair(image, image, np.eye(4), np.full((4800, 11), 1 / 11))
            with self.assertRaisesRegex(ValueError, "fork"):
                pcl_semantic.pixel_features(image, image, camera, np.full((4800, 11), 1 / 11))

        self.run_in_child(child)


class PixelFeatures(unittest.TestCase):
    CAMERA = (100, 100, 60, 40, 0.5, 120, 80)

    def test_a_floor_has_heights_and_a_wall_stands_on_it(self):
        # A floor 1.5 m below the camera up to a wall at 6.25 m, textured at random.
        rows = np.arange(80)[:, None] * np.ones((1, 120))
        disparity = np.where(rows < 64, 8, (rows - 40) / 3).round().astype(int)
        texture = np.random.default_rng(3).integers(0, 256, (80, 200, 3), np.uint8)
        columns = np.arange(120) + 40
        left = texture[:, columns]
        right = texture[rows.astype(int), columns + disparity]
        floor = np.zeros((80, 120, 2), np.float32)
        floor[:64, :, 1] = floor[64:, :, 0] = 1
        found = pcl_semantic.pixel_features(left, right, self.CAMERA, floor.reshape(-1, 2),
                                            ground=[1])
        at = {name: found[:, 30:110, i]
              for i, name in enumerate(pcl_semantic.pixel_feature_names)}
        self.assertLess(abs(np.nanmedian(at["height"][68:76])), 0.1)
        self.assertAlmostEqual(np.nanmedian(at["height"][24]), 1.5 + 16 * 6.25 / 100, delta=0.15)
        self.assertAlmostEqual(np.nanmedian(at["distance"][10:50]), 6.25, delta=0.1)
        np.testing.assert_allclose(found[..., 4], left.mean(2) / 255, atol=1e-6)
        alone = pcl_semantic.pixel_features(left, right, self.CAMERA, floor.reshape(-1, 2))
        self.assertTrue(np.isnan(alone[..., 0]).all())

    def test_bad_arguments(self):
        image, labels = np.zeros((80, 120), np.uint8), np.full((9600, 2), 0.5)
        for says, arguments, options in [
                ("seven", (image, image, (1, 2), labels), {}),
                ("the right image is 120 x 80", (image, image.T, self.CAMERA, labels), {}),
                ("ground is 3, expected 1 to 2", (image, image, self.CAMERA, labels),
                 {"ground": [3]}),
                ("stereo", (image, image, self.CAMERA, labels), {"stereo": "x"})]:
            with self.assertRaisesRegex(ValueError, says):
                pcl_semantic.pixel_features(*arguments, **options)
        with self.assertRaises(TypeError):
            pcl_semantic.pixel_features(image, image, self.CAMERA, labels, voxel_size=0.1)


class Stub(unittest.TestCase):
    def test_names_all_that_the_module_has(self):
        with open(os.path.join(os.path.dirname(pcl_semantic.__file__),
                               "pcl_semantic.pyi")) as stub:
            text = stub.read()
        for name in dir(pcl_semantic):
            if not name.startswith("__"):
                self.assertRegex(text, rf"(?m)^((def|class) {name}\b|{name}:)")


if __name__ == "__main__":
    unittest.main()
