# SPDX-License-Identifier: BSD-3-Clause
"""Reads and writes the files of sequences, maps and label images (doc/formats.md)."""

import json
import os
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import yaml
from PIL import Image
from scipy.spatial.transform import Rotation

ROOT = Path(__file__).resolve().parents[2]
KITTI_CLASSES = ROOT / "data" / "label_sets" / "kitti11.yaml"


def label_set(path=KITTI_CLASSES):
    """Classes as dictionaries (name, colour); the first is label 1."""
    return yaml.safe_load(Path(path).read_text())["classes"]


def label_mapping(path, classes):
    """Our label of each of 65536 numbers; 0 = unlabelled."""
    number = {each["name"]: i for i, each in enumerate(classes, 1)}
    labels = np.zeros(65536, np.uint8)
    for name, ids in yaml.safe_load(Path(path).read_text())["classes"].items():
        if name not in number:
            raise ValueError(f"{path}: '{name}' is no class of the label set")
        labels[ids] = number[name]
    return labels


def frames(folder, extension):
    """Paths of NNNNNN.extension by frame number, in order."""
    found = {int(p.stem): p for p in sorted(Path(folder).glob(f"*{extension}"))
             if p.stem.isdigit()}
    if not found:
        raise ValueError(f"{folder}: holds no files, expected 000000{extension} ...")
    return found


def read_image(path):
    with Image.open(path) as image:
        return np.asarray(image)


def write_image(path, image):
    replace(path, lambda file: Image.fromarray(image).save(file, "png"))


def read_scan_labels(path, points=None):
    """Numbers of the classes, without the instances of SemanticKITTI."""
    labels = read_array(path, "<u4")
    if points not in (None, len(labels)):
        raise ValueError(f"{path}: has {len(labels)} labels, expected {points}")
    return labels & 0xFFFF


def read_array(path, kind):
    size = os.path.getsize(path)
    if size % np.dtype(kind).itemsize:
        raise ValueError(f"{path}: has {size} bytes, expected {kind} a point")
    return np.fromfile(path, kind)


def read_distributions(folder, frame, shape):
    """Probabilities of the classes of an image, H x W x L, from .npy or .bin."""
    path = Path(folder) / f"{frame:06}.npy"
    if path.exists():
        values = np.load(path)
    else:
        path = path.with_suffix(".bin")
        values = read_array(path, "<f4")
        if len(values) == 0 or len(values) % (shape[0] * shape[1]):
            raise ValueError(f"{path}: has {len(values)} values, expected L for each of "
                             f"{shape[1]} x {shape[0]} pixels")
        values = values.reshape(*shape, -1)
    if values.ndim != 3 or values.shape[:2] != tuple(shape):
        raise ValueError(f"{path}: has shape {values.shape}, expected {shape[0]} x {shape[1]} x L")
    values = values.astype(np.float32)
    return values / np.maximum(values.sum(2, keepdims=True), np.finfo(np.float32).tiny)


def write_array(path, values, kind):
    replace(path, lambda file: file.write(np.asarray(values, kind).tobytes()))


def replace(path, write):
    """Leaves no partial file under its final name."""
    unfinished = f"{path}.{os.getpid()}.tmp"
    with open(unfinished, "wb") as file:
        write(file)
    os.replace(unfinished, path)


def rotation(block):
    """The rotation nearest to a block of rounded numbers, as Eigen's quaternions give it."""
    trace = np.trace(block)
    if trace <= 0:
        return Rotation.from_matrix(block).as_matrix()
    skew = block - block.T
    return Rotation.from_quat([skew[2, 1], skew[0, 2], skew[1, 0], 1 + trace]).as_matrix()


def calibration_rows(folder):
    """The 3 x 4 matrices of KITTI's calib.txt by their names: P0, P2, Tr ..."""
    rows = {}
    for line in (Path(folder) / "calib.txt").read_text().splitlines():
        name, _, numbers = line.partition(":")
        if name in ("P0", "P1", "P2", "P3", "Tr"):
            rows[name] = np.array(numbers.split(), float).reshape(3, 4)
    return rows


class Sequence:
    """A KITTI sequence with laser scans. Points and poses are in metres."""

    def __init__(self, folder):
        self.folder = Path(folder)
        colour = (self.folder / "image_2").is_dir()
        rows = calibration_rows(self.folder)
        if "Tr" not in rows:
            raise ValueError(f"{folder}/calib.txt: has no row 'Tr:', the scanner's pose")
        left, tr = rows["P2" if colour else "P0"], rows["Tr"]
        image = next(iter(frames(self.folder / f"image_{2 if colour else 0}", ".png").values()))
        self.camera = SimpleNamespace(fx=left[0, 0], fy=left[1, 1], cx=left[0, 2],
                                      cy=left[1, 2])
        self.camera.height, self.camera.width = read_image(image).shape[:2]
        # Of the left camera in camera 0, along the axes of both.
        self.camera0_to_camera = np.linalg.solve(left[:, :3], left[:, 3])
        self.scanner_rotation = rotation(tr[:, :3])
        self.scanner_translation = tr[:, 3] + self.camera0_to_camera

    def camera0_from_camera(self):
        """Pose of the left camera in camera 0, 4 x 4."""
        pose = np.eye(4)
        pose[:3, 3] = -self.camera0_to_camera
        return pose

    def inputs(self):
        """Its folders that must not be written to."""
        names = ["labels", "velodyne"] + [f"image_{i}" for i in range(4)]
        return [self.folder.resolve() / name for name in names]

    def scans(self):
        return frames(self.folder / "velodyne", ".bin")

    def scan(self, frame):
        """Points of a scan in the scanner's frame, N x 3."""
        path = self.scans()[frame]
        values = read_array(path, "<f4")
        if len(values) == 0 or len(values) % 4 or not np.isfinite(values).all():
            raise ValueError(f"{path}: expected four finite float32 a point")
        return values.reshape(-1, 4)[:, :3].astype(float)

    def in_camera(self, scan):
        """Points in the left camera's frame."""
        return scan @ self.scanner_rotation.T + self.scanner_translation


def as_json(value):
    """Text of figures; what is no number is null."""
    def plain(each):
        if isinstance(each, dict):
            return {key: plain(inner) for key, inner in each.items()}
        if isinstance(each, (list, tuple)):
            return [plain(inner) for inner in each]
        if isinstance(each, (float, np.floating)):
            return float(each) if np.isfinite(each) else None
        return each
    return json.dumps(plain(value))


def program(name, *arguments):
    """Output of pcl_semantic_NAME."""
    folder = os.environ.get("PCL_SEMANTIC_BIN", ROOT / "build" / "bin")
    return subprocess.run([f"{folder}/pcl_semantic_{name}", *map(str, arguments)], check=True,
                          stdout=subprocess.PIPE, text=True).stdout


def run(command):
    """Runs a command; what is wrong with its input is one line."""
    try:
        command()
    except (OSError, ValueError, KeyError, subprocess.CalledProcessError) as error:
        sys.exit(f"{Path(sys.argv[0]).stem}: {error}")
