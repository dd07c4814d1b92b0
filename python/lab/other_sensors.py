# SPDX-License-Identifier: BSD-3-Clause
"""The results of an RGB-D camera and of a laser scanner, with labels of real networks."""

import json
import subprocess

from lab import files

PASCAL = "espnetv2_pascal_640x480.yaml"
KITTI11 = ("--label-set", files.KITTI_CLASSES, "--label-mapping",
           files.ROOT / "data/label_mappings/semantic_kitti_to_kitti11.yaml")


def program(name, *arguments):
    return subprocess.run(
        [files.ROOT / f"build/bin/pcl_semantic_{name}", *map(str, arguments)], check=True,
        stdout=subprocess.PIPE).stdout


def scores(prediction, truth, covered_by, classes):
    """Mean exclusive IoU and global accuracy in percent; lists of folders are pooled."""
    command = ["--json", *classes]
    for each in zip(prediction, truth, covered_by):
        for option, folder in zip(("--prediction", "--truth", "--covered-by"), each):
            command += [option, folder]
    found = json.loads(program("evaluate", *command))
    return (round(100 * found["mean"]["iou_exclusive"], 1),
            round(100 * found["global_accuracy"], 1))


def row(name, network, others):
    cells = [f"{network[0]:.1f} / {network[1]:.1f}"]
    cells += [f"{iou - network[0]:+.1f} / {accuracy - network[1]:+.1f}"
              for iou, accuracy in others]
    return f"| {name} | {' | '.join(cells)} |"


def kitchen(data, out):
    """The finished map has no images of RGB-D cameras: all columns are causal, at depth."""
    folder, network = data / "kitchen", data / "kitchen" / "pascal"
    classes = ("--label-set", network / "pascal9.yaml", "--label-mapping",
               network / "nyu40_to_pascal9.yaml")
    lines = ["| voxels | 2D network | fused | map |", "|---|---:|---:|---:|"]
    for size in ("0.05", "0.02"):
        for name, options in (("fused", ["--crf", "none"]), ("map", [])):
            program("map", "-q", "--rgbd", folder, "--calibration", folder / "camera.yaml",
                    "--poses", folder / "poses.txt", "--network", network / PASCAL, "--model",
                    data / "nets" / "espnetv2_s2.0_pascal_640x480.onnx", "--voxel-size", size,
                    "--max-depth", "4", *options, "--output", out / f"{name}_{size}")
        covered = [out / f"map_{size}" / "labels_at_depth"]
        found = [scores([out / each], [folder / "gt"], covered, classes)
                 for each in (f"map_{size}/network_labels", f"fused_{size}/labels_at_depth",
                              f"map_{size}/labels_at_depth")]
        lines.append(row(f"{size} m", found[0], found[1:]))
    return lines


def lidar(kitti, streets, distributions, out):
    """Scans get the labels of the image network, in the camera's view. The worst is first."""
    for street in streets:
        sequence = kitti / street
        program("label", "-q", "--clouds", sequence / "velodyne", sequence, "--labels",
                str(distributions).replace("{name}", street), "--output", out / street / "scans")
        program("map", "-q", "--clouds", out / street / "scans", "--calibration",
                sequence / "calib.txt", "--poses", sequence / "poses.txt", "--sensor", "laser",
                "--also", "scans,measured", "--output", out / street / "map")

    def line(name, chosen):
        # The CRF also labels points around the camera's view, which have no other label.
        found = [scores([out / each / "map" / labels for each in chosen],
                        [kitti / each / "labels" for each in chosen],
                        [out / each / "map" / "network_scan_labels" for each in chosen], KITTI11)
                 for labels in ("network_scan_labels", "measured_scan_labels", "scan_labels",
                                "final_scan_labels")]
        return found[2][0] - found[0][0], row(name, found[0], found[1:])
    lines = sorted((line(street, [street]) for street in streets), key=lambda each: each[0])
    return ["| street | labels of the scans | fused | map | map, final |",
            "|---|---:|---:|---:|---:|", *(text for _, text in lines),
            line("**pooled**", streets)[1]]
