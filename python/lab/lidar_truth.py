# SPDX-License-Identifier: BSD-3-Clause
"""Ground truth of label images from labelled laser scans: what the camera sees of them."""

import argparse
from pathlib import Path

import numpy as np
from scipy.ndimage import minimum_filter

from lab import files

ROWS, COLUMNS = 7, 3  # half the window that covers the gaps between 64 beams [px]


def pixels(points, camera):
    """Rows, columns, depths (float32, [m]) and which points in the camera's frame lie in the
    image; 0 for the others."""
    x, y, z = points.T
    with np.errstate(all="ignore"):
        u = np.floor(camera.fx * x / z + camera.cx + 0.5)
        v = np.floor(camera.fy * y / z + camera.cy + 0.5)
    inside = (z > 0.1) & (u >= 0) & (u < camera.width) & (v >= 0) & (v < camera.height)
    rows, columns = (np.where(inside, each, 0).astype(int) for each in (v, u))
    return rows, columns, np.where(inside, z, 0).astype(np.float32), inside


def seen(points, camera, max_depth=40.0, margin=0.5, relative_margin=0.05):
    """Rows, columns and depths (float32, [m]) of points in the camera's frame; depth 0 is
    outside of the image, hidden or too far.

    The scanner looks from another place than the camera, so what is behind an object shines
    through between its returns: a point is hidden if nearer returns (by both margins) lie
    within the window both at or above and at or below its row."""
    rows, columns, depths, inside = pixels(points, camera)
    nearest = np.full((camera.height, camera.width), np.inf, np.float32)
    np.minimum.at(nearest, (rows[inside], columns[inside]), depths[inside])
    wide = minimum_filter(nearest, (1, 2 * COLUMNS + 1), mode="constant", cval=np.inf)
    half = (ROWS + 1) // 2
    above, below = (minimum_filter(wide, (ROWS + 1, 1), mode="constant", cval=np.inf,
                                   origin=(shift, 0)) for shift in (half - 1, -half))
    far = depths.astype(float)
    limit = far - np.maximum(margin, relative_margin * far)
    hidden = np.maximum(above, below)[rows, columns] < limit
    return rows, columns, np.where((depths > max_depth) | hidden, np.float32(0), depths)


def images(rows, columns, depths, labels, camera):
    """Labels and depths of the pixels: of each the nearest point that is seen, if labelled."""
    order = np.argsort(depths, kind="stable")[::-1]  # the last one written stays
    order = order[depths[order] > 0]
    truth = np.zeros((camera.height, camera.width), np.uint8)
    depth = np.zeros(truth.shape, np.float32)
    truth[rows[order], columns[order]] = labels[order]
    depth[rows[order], columns[order]] = depths[order]
    return truth, np.where(truth > 0, depth, 0)


def write(folder, output, mapping, depth=None, scan_labels=None, scan_depth=None,
          max_depth=40.0, first=0, end=None):
    """Writes the ground truth of each scan; returns how many there are."""
    sequence = files.Sequence(folder)
    scans = [n for n in sequence.scans() if n >= first and (end is None or n < end)]
    if not scans:
        raise ValueError(f"{folder}/velodyne: holds no scan of these frames")
    folders = [Path(each).resolve() for each in (output, depth, scan_labels, scan_depth) if each]
    for each in folders:
        if each in sequence.inputs() or folders.count(each) > 1:
            raise ValueError(f"{each}: is a folder of the sequence, or given twice")
        each.mkdir(parents=True, exist_ok=True)
    for n in scans:
        points = sequence.in_camera(sequence.scan(n))
        labels = mapping[files.read_scan_labels(
            sequence.folder / "labels" / f"{n:06}.label", len(points))]
        rows, columns, depths = seen(points, sequence.camera, max_depth)
        truth, image = images(rows, columns, depths, labels, sequence.camera)
        files.write_image(f"{output}/{n:06}.png", truth)
        if depth:
            steps = np.rint(image * 256).clip(0, 65534).astype(np.uint16)
            files.write_image(f"{depth}/{n:06}.png", steps)
        if scan_labels:
            files.write_array(f"{scan_labels}/{n:06}.label",
                              np.where(depths > 0, labels, 0), "<u4")
        if scan_depth:
            files.write_array(f"{scan_depth}/{n:06}.bin", depths, "<f4")
    return len(scans)


def main():
    parser = argparse.ArgumentParser(prog="python3 -m lab.lidar_truth", description=__doc__)
    parser.add_argument("sequence", help="KITTI sequence with velodyne/ and labels/")
    parser.add_argument("--output", required=True, help="folder of label images")
    parser.add_argument("--depth", help="folder of their depths (16-bit PNG, 256 x metres)")
    parser.add_argument("--scan-labels", help="folder of the classes of the points seen")
    parser.add_argument("--scan-depth", help="folder of the depths of these (float32)")
    parser.add_argument("--label-set", default=files.KITTI_CLASSES)
    parser.add_argument("--label-mapping", default=files.ROOT / "data" / "label_mappings" /
                        "semantic_kitti_to_kitti11.yaml")
    parser.add_argument("--max-depth", type=float, default=40.0, help="[m]")
    parser.add_argument("--frames", default=":", help="A:B, only frames A <= n < B")
    given = parser.parse_args()
    first, _, end = given.frames.partition(":")
    mapping = files.label_mapping(given.label_mapping, files.label_set(given.label_set))
    count = write(given.sequence, given.output, mapping, given.depth, given.scan_labels,
                  given.scan_depth, given.max_depth, int(first or 0), int(end) if end else None)
    print(f"images: {count}")


if __name__ == "__main__":
    files.run(main)
