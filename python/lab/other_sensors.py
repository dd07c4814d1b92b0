# SPDX-License-Identifier: BSD-3-Clause
"""The results of an RGB-D camera and of a laser scanner, with labels of real networks."""

from lab import files, scores

PASCAL = "espnetv2_pascal_640x480.yaml"


def figures(*folders):
    """Mean exclusive IoU and global accuracy in percent; arguments of scores.evaluate()."""
    found = scores.evaluate(*folders)
    return (round(100 * found["mean"]["iou_exclusive"], 1),
            round(100 * found["global_accuracy"], 1))


def row(name, network, others):
    return scores.gains_row(name, network, [(iou - network[0], accuracy - network[1])
                                            for iou, accuracy in others])


def kitchen(data, out):
    """The finished map has no images of RGB-D cameras: all columns are causal, at depth."""
    folder, network = data / "kitchen", data / "kitchen" / "pascal"
    classes = ("--label-set", network / "pascal9.yaml", "--label-mapping",
               network / "nyu40_to_pascal9.yaml")
    lines = ["| voxels | 2D network | fused | map |", "|---|---:|---:|---:|"]
    for size in ("0.05", "0.02"):
        for name, options in (("fused", ["--crf", "none"]), ("map", [])):
            files.program(
                "map", "-q", "--rgbd", folder, "--calibration", folder / "camera.yaml",
                "--poses", folder / "poses.txt", "--network", network / PASCAL, "--model",
                data / "nets" / "espnetv2_s2.0_pascal_640x480.onnx", "--voxel-size", size,
                "--max-depth", "4", *options, "--output", out / f"{name}_{size}")
        covered = [out / f"map_{size}" / "labels_at_depth"]
        found = [figures([out / each], [folder / "gt"], covered, *classes)
                 for each in (f"map_{size}/network_labels", f"fused_{size}/labels_at_depth",
                              f"map_{size}/labels_at_depth")]
        lines.append(row(f"{size} m", found[0], found[1:]))
    return lines


def lidar(kitti, streets, distributions, out):
    """Scans get the labels of the image network, in the camera's view. The worst is first."""
    for street in streets:
        sequence = kitti / street
        files.program(
            "label", "-q", "--clouds", sequence / "velodyne", sequence, "--labels",
            str(distributions).replace("{name}", street), "--output", out / street / "scans")
        files.program(
            "map", "-q", "--clouds", out / street / "scans", "--calibration",
            sequence / "calib.txt", "--poses", sequence / "poses.txt", "--sensor", "laser",
            "--also", "scans,measured", "--output", out / street / "map")

    def line(name, chosen):
        # The CRF also labels points around the camera's view, which have no other label.
        found = [figures([out / each / "map" / labels for each in chosen],
                         [kitti / each / "labels" for each in chosen],
                         [out / each / "map" / "network_scan_labels" for each in chosen],
                         *scores.SCANS)
                 for labels in ("network_scan_labels", "measured_scan_labels", "scan_labels",
                                "final_scan_labels")]
        return found[2][0] - found[0][0], row(name, found[0], found[1:])
    lines = sorted((line(street, [street]) for street in streets), key=lambda each: each[0])
    return ["| street | labels of the scans | fused | map | map, final |",
            "|---|---:|---:|---:|---:|", *(text for _, text in lines),
            line("**pooled**", streets)[1]]
