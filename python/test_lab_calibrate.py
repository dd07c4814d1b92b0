# SPDX-License-Identifier: BSD-3-Clause
"""Learning of calibrations: against loops, a known model, and the program that applies them."""

import copy
import json
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np
import yaml

import pcl_semantic
from lab import calibrate, files

BIN = os.environ["PCL_SEMANTIC_BIN"]
HEIGHT = pcl_semantic.pixel_feature_names.index("height")


def program(name, *arguments):
    subprocess.run([os.path.join(BIN, f"pcl_semantic_{name}"), "-q", *map(str, arguments)],
                   check=True, stdout=subprocess.DEVNULL)


def softmax(values):
    values = np.exp(values - values.max(1, keepdims=True))
    return values / values.sum(1, keepdims=True)


def pixels(count, seed=1):
    random = np.random.default_rng(seed)
    features = np.full((count, 7), np.nan, np.float32)
    features[:, HEIGHT] = random.uniform(-1, 6, count)
    features[::10, HEIGHT] = np.nan
    return random, softmax(random.normal(0, 2, (count, 4))).astype(np.float32), features


def setting(**changes):
    given = copy.copy(calibrate.DEFAULTS)
    vars(given).update(changes)
    return given


def known():
    """Of class 3 nothing is known."""
    curve = np.zeros((3, 11))
    curve[0] = np.linspace(1, -1, 11)
    curve[2, 4:] = 0.7
    return calibrate.Calibration(0.6, np.array([1, 2, 4]), np.array([0.5, -0.5, 0.0]),
                                 {"height": curve}, {})


class Model(unittest.TestCase):
    def test_weights_interpolate_and_are_constant_beyond_the_knots(self):
        knots, curve = calibrate.KNOTS["height"], np.arange(11.0) ** 2
        values = np.array([-3, -0.5, 0.05, 0.2, 4.9, 5, 9, np.nan])
        found = calibrate.weights_on(knots, values) @ curve
        np.testing.assert_allclose(found[:-1], np.interp(values[:-1], knots, curve))
        self.assertEqual(found[-1], 0)

    def test_apply_is_the_formula(self):
        _, network, features = pixels(200)
        model = known()
        found = calibrate.apply(model, network, features)
        for i in range(len(network)):
            weights = []
            for k, label in enumerate(model.labels):
                height = features[i, HEIGHT]
                curve = 0 if np.isnan(height) else np.interp(
                    height, calibrate.KNOTS["height"], model.curves["height"][k])
                weights.append(max(network[i, label - 1], 1e-4) ** model.sharpness *
                               np.exp(model.bias[k] + curve))
            expected = np.array(weights) / sum(weights) * network[i, model.labels - 1].sum()
            np.testing.assert_allclose(found[i, model.labels - 1], expected, rtol=1e-6)
            self.assertEqual(found[i, 2], network[i, 2])

    def test_sequences_weigh_the_same_and_classes_by_a_power_of_their_number(self):
        weights = calibrate.balanced_weights([np.array([1, 1, 1, 1, 2]), np.array([3])], 0.5)
        np.testing.assert_allclose(weights[:5] / weights[4], [0.5, 0.5, 0.5, 0.5, 1])
        self.assertAlmostEqual(weights[:5].sum(), 0.5)
        self.assertAlmostEqual(weights[5], 0.5)

    def test_fit_finds_the_model_that_made_the_truth(self):
        random, network, features = pixels(60000)
        network[:, 2] = 0
        network /= network.sum(1, keepdims=True)
        model = known()
        chances = calibrate.apply(model, network, features).cumsum(1)
        truth = (random.random((len(chances), 1)) < chances).argmax(1) + 1
        samples = calibrate.Samples(network, features, truth, [])
        free = setting(features=["height"], balance=0, shrinkage=0, bias_penalty=0,
                       curve_penalty=1e-7)
        found = calibrate.fit([samples], free)
        self.assertEqual(found.labels.tolist(), [1, 2, 4])
        self.assertAlmostEqual(found.sharpness, 0.6, delta=0.02)
        error = abs(calibrate.apply(found, network, features) -
                    calibrate.apply(model, network, features))
        self.assertLess(error.mean(), 0.01)
        half = calibrate.fit([samples], setting(**{**vars(free), "shrinkage": 0.5}))
        np.testing.assert_allclose(half.bias, found.bias / 2)
        np.testing.assert_allclose(half.curves["height"], found.curves["height"] / 2)
        self.assertEqual(half.sharpness, found.sharpness)
        with self.assertRaisesRegex(ValueError, "fewer than two classes"):
            calibrate.fit([calibrate.Samples(network, features, np.ones(60000, int), [])])


class Program(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.temporary.name)
        for seed, name in enumerate(("one", "two")):
            program("synthesize", cls.folder / name, "--frames", 2, "--seed", seed, "--size",
                    "310x94")
        (cls.folder / "two/gt/000001.png").unlink()
        cls.report = calibrate.write([cls.folder / "one", cls.folder / "two"],
                                     "{sequence}/labels", "{sequence}/gt", cls.folder / "out")

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def test_the_map_applies_what_was_learned(self):
        out, street = self.folder / "out", self.folder / "one"
        self.assertEqual(sorted(p.name for p in out.iterdir()), [
            "calibration.yaml", "report.md", "without_one.yaml", "without_two.yaml"])
        for name, options in (("plain", []),
                              ("map", ["--label-calibration", out / "calibration.yaml"])):
            program("map", street, "--labels", street / "labels", "--crf", "none",
                    "--output", self.folder / name, *options)
        labels = [files.read_image(self.folder / name / "labels_at_depth/000001.png")
                  for name in ("plain", "map")]
        self.assertFalse(np.array_equal(*labels))
        # The program measures the distance from the training data as the laboratory does.
        learned = yaml.safe_load((out / "calibration.yaml").read_text())
        names = [each["name"] for each in files.label_set()]
        seen = {name: np.array([learned["seen"][name].get(each, [0] * len(knots))
                                for each in names])
                for name, knots in learned["knots"].items()}
        samples = calibrate.read_samples(street, street / "labels", street / "gt",
                                         [names.index(each) + 1 for each in learned["ground"]],
                                         calibrate.DEFAULTS)
        found = sorted(calibrate.distance(frame, seen) for frame in samples.frames)
        summary = json.loads((self.folder / "map/summary.json").read_text())
        self.assertAlmostEqual(summary["domain_shift"],
                               np.mean(found) / learned["seen"]["usual_distance"], delta=0.02)

    def test_without_a_street_is_from_the_other_alone(self):
        calibrate.write([self.folder / "one"], "{sequence}/labels", "{sequence}/gt",
                        self.folder / "alone")
        self.assertEqual((self.folder / "alone/calibration.yaml").read_text(),
                         (self.folder / "out/without_two.yaml").read_text())

    def test_the_report_has_the_scores_of_the_network(self):
        total = 0
        for name, frames in (("one", 2), ("two", 1)):
            for frame in range(frames):
                street = self.folder / name
                truth = files.read_image(street / f"gt/{frame:06}.png")
                network = files.read_distributions(street / "labels", frame, truth.shape)
                total = total + pcl_semantic.confusion_matrix(
                    truth,
                    (network.argmax(2) + 1).astype(np.uint8), network.shape[2])
        mean = 100 * pcl_semantic.scores(total)["mean_iou"]
        row = next(each for each in self.report.splitlines() if "| the network" in each)
        self.assertAlmostEqual(float(row.split("|")[-3]), mean, delta=0.051)

    def test_bad_input_is_one_line(self):
        for options, says in [
                (["--labels", "none"], "none/000000.bin"),
                (["--features", "smell"], "--features: 'smell' is no feature"),
                (["--ground", "lawn"], "--ground: class 'lawn' is not in the label set"),
                (["--balance", "2"], "--balance is 2.0, expected 0 to 1"),
                (["--frames", "7:9"], "has no ground truth image")]:
            done = subprocess.run(
                [sys.executable, "-m", "lab.calibrate", self.folder / "one", "--labels",
                 "{sequence}/labels", "--truth", "{sequence}/gt", "--output",
                 self.folder / "bad", *options], stderr=subprocess.PIPE, text=True)
            self.assertNotEqual(done.returncode, 0)
            self.assertIn(says, done.stderr)
            self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
        self.assertFalse((self.folder / "bad").exists())


if __name__ == "__main__":
    unittest.main()
