# SPDX-License-Identifier: BSD-3-Clause
"""The laboratory: ground truth against loops over all pairs, scores against the program."""

import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path
from types import SimpleNamespace

import numpy as np

from lab import compare, files, lidar_truth, models, plots, scores, tables

DATA = os.environ.get("PCL_SEMANTIC_DATA")


def program(name, *arguments):
    return subprocess.run(
        [os.path.join(os.environ["PCL_SEMANTIC_BIN"], f"pcl_semantic_{name}"),
         *map(str, arguments)], check=True, stdout=subprocess.PIPE, text=True).stdout


def write_labels(path, labels):
    Path(path).parent.mkdir(parents=True, exist_ok=True)
    if str(path).endswith(".label"):
        files.write_array(path, labels, "<u4")
    else:
        files.write_image(path, labels.astype(np.uint8))


class Folder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)


class LidarTruth(Folder):
    CAMERA = SimpleNamespace(fx=50, fy=50, cx=30, cy=20, width=60, height=40)

    def test_seen_is_what_a_loop_over_all_pairs_says(self):
        random = np.random.default_rng(7)
        points = random.uniform([-15, -15, -3], [15, 15, 50], (1500, 3))
        camera = self.CAMERA
        rows, columns, depths = lidar_truth.seen(points, camera)
        u = np.floor(camera.fx * points[:, 0] / points[:, 2] + camera.cx + 0.5)
        v = np.floor(camera.fy * points[:, 1] / points[:, 2] + camera.cy + 0.5)
        z = np.where((points[:, 2] > 0.1) & (u >= 0) & (u < 60) & (v >= 0) & (v < 40),
                     points[:, 2], np.inf)
        hidden = 0
        for i in range(len(points)):
            nearer = ((abs(u - u[i]) <= 3) & (abs(v - v[i]) <= 7) & (z < z[i] - 0.5) &
                      (z < 0.95 * z[i]))
            is_hidden = np.any(nearer & (v <= v[i])) and np.any(nearer & (v >= v[i]))
            hidden += is_hidden and z[i] <= 40
            expected = 0 if is_hidden or z[i] > 40 else z[i]
            self.assertAlmostEqual(depths[i], expected, places=4)
            if expected:
                self.assertEqual((rows[i], columns[i]), (v[i], u[i]))
        self.assertGreater(hidden, 20)
        self.assertGreater(np.count_nonzero(depths), 100)
        labels = random.integers(0, 12, len(points))
        truth, depth = lidar_truth.images(rows, columns, depths, labels, camera)
        for row, column in np.argwhere(truth > 0):
            here = (u == column) & (v == row) & (depths > 0)
            nearest = np.argmin(np.where(here, depths, np.inf))
            self.assertEqual(truth[row, column], labels[nearest])
            self.assertEqual(depth[row, column], depths[nearest])
        self.assertEqual(np.count_nonzero(depth), np.count_nonzero(truth))

    def sequence(self):
        """Two points, the second too far; another class and an instance in the label."""
        for name in ("image_0", "image_1"):
            write_labels(self.folder / name / "000002.png", np.full((40, 60), 90))
        (self.folder / "calib.txt").write_text(
            "P0: 50 0 30 0 0 50 20 0 0 0 1 0\nP1: 50 0 30 -25 0 50 20 0 0 0 1 0\n"
            "Tr: 0 -1 0 0 0 0 -1 0 1 0 0 0\n")
        (self.folder / "velodyne").mkdir()
        files.write_array(self.folder / "velodyne/000002.bin", [10, 2, 1, 0, 50, 0, 0, 0], "<f4")
        write_labels(self.folder / "labels/000002.label", [40 | 9 << 16, 40])
        return self.folder

    def test_files_of_a_sequence(self):
        folder, classes = self.sequence(), files.label_set()
        mapping = files.label_mapping(
            files.ROOT / "data/label_mappings/semantic_kitti_to_kitti11.yaml", classes)
        out = [folder / name for name in ("truth", "depth", "points", "point_depth")]
        self.assertEqual(lidar_truth.write(folder, out[0], mapping, *out[1:]), 1)
        truth = files.read_image(out[0] / "000002.png")
        self.assertEqual(np.argwhere(truth).tolist(), [[15, 20]])
        self.assertEqual(truth[15, 20], 3)
        self.assertEqual(files.read_image(out[1] / "000002.png")[15, 20], 2560)
        self.assertEqual(files.read_scan_labels(out[2] / "000002.label").tolist(), [3, 0])
        self.assertEqual(files.read_array(out[3] / "000002.bin", "<f4").tolist(), [10, 0])
        for message, arguments in [("a folder of the sequence", {"output": folder / "labels"}),
                                   ("given twice", {"output": out[0], "depth": out[0]}),
                                   ("no scan", {"output": out[0], "first": 3})]:
            with self.assertRaisesRegex(ValueError, message):
                lidar_truth.write(folder, mapping=mapping, **arguments)
        (folder / "labels/000002.label").write_bytes(b"1234")
        with self.assertRaisesRegex(ValueError, "000002.label: has 1 labels, expected 2"):
            lidar_truth.write(folder, out[0], mapping)

    @unittest.skipUnless(DATA, "PCL_SEMANTIC_DATA is not set")
    def test_agrees_with_the_hand_made_image(self):
        sequence = Path(DATA) / "kitti" / "05"
        subprocess.run([sys.executable, "-m", "lab.lidar_truth", sequence, "--output",
                        self.folder, "--frames", "0:1"], check=True, stdout=subprocess.DEVNULL)
        truth = files.read_image(self.folder / "000000.png")
        drawn = files.read_image(sequence / "gt" / "000000.png")
        building, road = (truth == 1) & (drawn > 0), (truth == 3) & (drawn > 0)
        self.assertGreater(np.mean(drawn[building] == 1), 0.9)
        self.assertGreater(np.mean(drawn[road] == 3), 0.97)


class Scores(Folder):
    def row(self, prediction, truth, *options):
        return program("evaluate", "--label-set", files.KITTI_CLASSES, "--row", "x",
                       "--prediction", prediction, "--truth", truth, *options)

    def test_rows_are_those_of_the_program(self):
        random = np.random.default_rng(1)
        names = ("truth", "prediction", "covered", "truth_depth")
        truth, prediction, covered, depth = (str(self.folder / each) for each in names)
        for frame in range(3):
            name = f"{frame:06}.png"
            labels = random.integers(0, 12, (20, 30))
            wrong = random.integers(0, 12, (20, 30))
            write_labels(f"{truth}/{name}", labels)
            write_labels(f"{prediction}/{name}",
                         np.where(random.random((20, 30)) < 0.4, wrong, labels))
            write_labels(f"{covered}/{name}", random.integers(0, 3, (20, 30)))
            Path(depth).mkdir(exist_ok=True)
            files.write_image(f"{depth}/{name}",
                              random.integers(0, 40 * 256, (20, 30)).astype(np.uint16))
        for given, options in [
                ({}, []), ({"covered_by": covered}, ["--covered-by", covered]),
                ({"depth": depth, "band": (10, 20)},
                 ["--truth-depth", depth, "--range", "10:20"])]:
            found = scores.figures(scores.confusion(prediction, truth, **given))
            name = "x, 10-20 m" if "band" in given else "x"
            self.assertEqual(scores.row(name, found.values()) + "\n",
                             self.row(prediction, truth, *options))
        found = scores.figures(scores.confusion(prediction, truth), ("pedestrian",))
        self.assertEqual(scores.row("x", found.values()) + "\n",
                         self.row(prediction, truth, "--ignore", "pedestrian"))
        header = program("evaluate", "--label-set", files.KITTI_CLASSES, "--header",
                         "--prediction", prediction, "--truth", truth)
        self.assertEqual("\n".join(tables.header()) + "\n", header)

    def test_scans_point_by_point(self):
        truth, prediction = self.folder / "truth", self.folder / "prediction"
        write_labels(truth / "000003.label", [3, 1, 1, 1, 0, 9])
        write_labels(prediction / "000003.label", [3, 3, 1, 0, 1, 9])
        (self.folder / "truth_depth").mkdir()
        files.write_array(self.folder / "truth_depth/000003.bin", [4, 4, 30, 30, 4, 0], "<f4")
        for band, options in [(None, []), ((0, 10), ["--range", "0:10", "--truth-depth",
                                                     self.folder / "truth_depth"])]:
            counts = scores.confusion(str(prediction), str(truth), None,
                                      str(self.folder / "truth_depth"), band)
            name = "x, 0-10 m" if band else "x"
            self.assertEqual(scores.row(name, scores.figures(counts).values()) + "\n",
                             self.row(prediction, truth, *options))


class Tables(Folder):
    def test_the_worst_street_is_first_and_differences_are_of_tenths(self):
        for street, wrong in (("00", 10), ("01", 40)):
            truth = np.repeat([[1], [3]], 60, axis=1).repeat(10, axis=0)
            network, better = truth.copy(), truth.copy()
            network[:, :wrong], better[:, :wrong // 4] = 5, 5
            write_labels(self.folder / street / "truth/000000.png", truth)
            for model in ("dense", "calibrated_dense"):
                for name, labels in (("network_labels", network), ("labels_at_depth", better),
                                     ("final_labels_at_depth", truth),
                                     ("measured_labels_at_depth", network)):
                    write_labels(self.folder / street / model / name / "000000.png", labels)
        found = tables.Tables(self.folder, ["01", "00"], None)
        self.assertEqual(found.answer("labels_at_depth"), [
            "| street | 2D network | map | map, final | calibrated | the CRF's part |",
            "|---|---:|---:|---:|---:|---:|",
            "| 00 | 83.3 / 83.3 | +13.4 / +13.4 | +16.7 / +16.7 | +13.4 / +13.4 | +13.4 / +13.4 |",
            "| 01 | 33.3 / 33.3 | +50.0 / +50.0 | +66.7 / +66.7 | +50.0 / +50.0 | +50.0 / +50.0 |",
            "| **pooled** | 58.3 / 58.3 | +31.7 / +31.7 | +41.7 / +41.7 | +31.7 / +31.7 | "
            "+31.7 / +31.7 |"])
        for path in plots.page(found, self.folder / "images"):
            self.assertLess(path.stat().st_size, 60000)


class Models(unittest.TestCase):
    def test_their_options_are_understood(self):
        for model, (_, options) in models.MODELS.items():
            options = options.format(calibration="none.yaml").split()
            with self.subTest(model):
                subprocess.run([os.path.join(os.environ["PCL_SEMANTIC_BIN"], "pcl_semantic_map"),
                                *options, "--print-config"], check=True, cwd=files.ROOT,
                               stdout=subprocess.DEVNULL)


class Compare(Folder):
    def test_marks_what_became_right_and_wrong(self):
        # Columns of 80 pixels: the same, right, wrong, no truth.
        image = np.full((100, 320, 3), 100)
        before, truth = np.ones((100, 320), int), np.ones((100, 320), int)
        after = before.copy()
        after[:, 80:], truth[:, 80:160], truth[:, 240:] = 2, 2, 0
        colours = np.array([(0, 0, 0), (1, 2, 3), (30, 40, 50)])
        picture, text = compare.changes(image, before, after, truth, colours)
        self.assertEqual(len(set(picture[50, 40])), 1)  # grey
        for column, colour in ((120, compare.RIGHT), (200, compare.WRONG), (280, (30, 40, 50))):
            self.assertEqual(tuple(picture[50, column]), colour)
        self.assertEqual(text, "75.0 % differ, 8000 pixels became right, 8000 wrong")
        sparse = np.zeros((100, 320), int)
        sparse[50, 100] = 2
        picture, _ = compare.changes(image, before, after, sparse, colours)
        self.assertEqual(tuple(picture[48, 102]), compare.RIGHT)
        self.assertEqual(tuple(picture[50, 104]), (30, 40, 50))

    def test_a_figure_of_given_width(self):
        image, labels = np.full((50, 100, 3), 90), np.ones((50, 100), np.uint8)
        for truth in (None, labels):
            compare.draw(self.folder / "a.png", image, {"a": labels, "b": labels}, truth,
                         files.label_set(), 640)
            self.assertEqual(files.read_image(self.folder / "a.png").shape[1], 640)
        with self.assertRaisesRegex(ValueError, "b: labels are of another size"):
            compare.draw(self.folder / "a.png", image, {"b": labels.T}, None, files.label_set())


if __name__ == "__main__":
    unittest.main()
