# SPDX-License-Identifier: BSD-3-Clause
"""Maps KITTI sequences with several models, scores them, and writes doc/results.md.

PCL_SEMANTIC_DATA holds kitti/{15,00,01,03,05,06,07,09} and nets/. Labels of the network are
computed once and kept in build/results. STREETS="00 05 07" takes these alone, three or more,
and leaves doc/ as it is. With `page` only what the first page needs is mapped, a tenth of it
all; `tables` maps nothing and writes all pages and pictures of what is there."""

import argparse
import datetime
import hashlib
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

from lab import calibrate, files, lidar_truth, models, other_sensors, plots, tables

NETWORK = "data/networks/espnetv2_city_1280x480.yaml"
MODEL = "nets/espnetv2_s2.0_city_1280x480_halfres.onnx"
LABEL_SET = "data/label_sets/kitti11.yaml"
OUT = Path("build/results")


def say(*words):
    print("==", *words, file=sys.stderr, flush=True)


class Run:
    def __init__(self, data):
        self.data, self.kitti = Path(data), Path(data) / "kitti"
        self.streets = os.environ.get("STREETS", "00 01 03 05 06 07 09").split()
        if len(self.streets) < 3:  # calibrations come from the others
            sys.exit(f"results: STREETS are {self.streets}, expected three or more")
        self.tables = tables.Tables(OUT, self.streets, self.kitti)
        self.load = os.getloadavg()[0]  # of other programs: the times suffer from it

    def label(self, sequence):
        """Distributions of the network, unless those that are there are of the same files."""
        folder, images = OUT / sequence / "network_distributions", self.kitti / sequence / "image_2"
        digest = hashlib.sha256()
        for path in [Path(NETWORK), self.data / MODEL, *files.frames(images, ".png").values()]:
            digest.update(path.read_bytes())
        stamp = folder / "made_from"
        if stamp.exists() and stamp.read_text().split()[0] == digest.hexdigest():
            return
        say(f"sequence {sequence}: network")
        shutil.rmtree(folder, ignore_errors=True)
        files.program("label", self.kitti / sequence, "--network", NETWORK, "--model", self.data / MODEL,
             "--output", folder)
        stamp.write_text(digest.hexdigest() + "\n")

    def truth(self, sequence):
        """truth, truth_scan (point by point), and the depth of both; or the hand-made images,
        which are truth_images where a street has both."""
        folder, source = OUT / sequence, self.kitti / sequence
        for old in folder.glob("truth*"):
            old.unlink() if old.is_symlink() else shutil.rmtree(old)
        if (source / "labels").is_dir():
            mapping = files.label_mapping("data/label_mappings/semantic_kitti_to_kitti11.yaml",
                                          files.label_set())
            lidar_truth.write(source, folder / "truth", mapping, folder / "truth_depth",
                              folder / "truth_scan", folder / "truth_scan_depth")
        else:
            (folder / "truth").symlink_to((source / "gt").resolve())
        if (source / "gt").is_dir():
            (folder / "truth_images").symlink_to((source / "gt").resolve())

    def learn(self):
        say("calibration of the network")
        calibrate.write([self.kitti / each for each in self.streets],
                        OUT / "{name}" / "network_distributions", OUT / "{name}" / "truth",
                        OUT / "calibration", label_set=LABEL_SET)

    def map(self, sequence, model):
        also = []
        if model in models.MAIN or model == "none":  # whose objects are compared, too
            scans = (self.kitti / sequence / "velodyne").is_dir()
            also = (["--also", "measured,depth,scans", "--scan-within", "0.3"] if scans
                    else ["--also", "measured,depth"])
        calibration = OUT / "calibration" / f"without_{sequence}.yaml"
        if not calibration.exists():
            calibration = OUT / "calibration" / "calibration.yaml"
        options = models.MODELS[model][1].format(calibration=calibration)
        say(f"sequence {sequence}: {model}")
        files.program("map", self.kitti / sequence, "--labels", OUT / sequence / "network_distributions",
             *also, *options.split(), "--output", OUT / sequence / model)

    def map_models(self, sequences, which):
        for sequence in sequences:
            (OUT / sequence).mkdir(parents=True, exist_ok=True)
            self.label(sequence)
            self.truth(sequence)
        self.learn()
        for sequence in sequences:
            for model in which:
                self.map(sequence, model)

    def map_others(self):
        say("RGB-D and lidar")
        (OUT / "others.json").write_text(json.dumps({
            "Kitchen from RGB-D, at depth": other_sensors.kitchen(self.data, OUT / "kitchen"),
            "Streets from lidar, at the points of the scans": other_sensors.lidar(
                self.kitti, self.streets, OUT / "{name}" / "network_distributions",
                OUT / "lidar")}))

    def drawn(self):
        """Sequences with hand-made truth."""
        return [each for each in ["15", *self.streets] if (OUT / each / "truth_images").exists()]

    def refine_images(self, sequence):
        """Table II: the classes of the images that have hand-made truth."""
        for model, (_, options) in models.IMAGE_MODELS.items():
            folder = OUT / sequence / f"image_{model}"
            folder.mkdir(exist_ok=True)
            for frame, truth in files.frames(self.kitti / sequence / "gt", ".png").items():
                stored = next((OUT / sequence / "network_distributions").glob(f"{frame:06}.*"))
                files.program("image_crf", self.kitti / sequence / "image_2" / truth.name, stored,
                     folder / truth.name, *options.split())

    def map_everything(self):
        self.map_models(["15", *self.streets], models.MODELS)
        for sequence in self.drawn():
            self.refine_images(sequence)
        say("times, with the network")
        times = subprocess.run("build/bench/bench_frame", check=True, stdout=subprocess.PIPE)
        (OUT / "times.md").write_bytes(times.stdout)

    def made(self, name):
        """Notes on what machine and when it was made."""
        processor = next((line.split(":")[1].strip() for line in open("/proc/cpuinfo")
                          if line.startswith("model name")), "unknown")
        (OUT / name).write_text(
            f"Made on {datetime.date.today()}, {os.cpu_count()} x {processor} (load at the "
            f"beginning {self.load:.2f}), with the defaults of that day.\n")

    def write(self, name, text, pictures):
        """A page, and what it shows; both also in doc/ if they are of all streets."""
        head = Path("doc", name.replace(".md", "_head.md")).read_text()
        (OUT / name).write_text(head + text)
        if "STREETS" not in os.environ:
            shutil.copy(OUT / name, "doc")
            for picture in pictures:
                shutil.copy(picture, "doc/images")

    def write_page(self):
        made = (OUT / "made_page.md").read_text().strip()
        others = json.loads((OUT / "others.json").read_text())
        self.write("results.md", self.tables.page(made, others),
                   plots.page(self.tables, OUT / "images"))

    def write_appendix(self):
        made = (OUT / "made.md").read_text().strip()
        times = [line for line in (OUT / "times.md").read_text().splitlines()
                 if line.startswith("|")]
        self.write("results_appendix.md", self.tables.appendix(made, self.drawn(), times),
                   plots.appendix(self.tables, OUT / "images"))

    def pictures(self, sequence):
        """Maps, changes and sheets; they stay untracked."""
        folder = OUT / sequence
        subprocess.run(["doc/pictures.sh", folder / "calibrated_superpixel", folder / "none",
                        self.kitti / sequence / "image_2", folder / "truth",
                        folder / "pictures"], check=True)


def main():
    parser = argparse.ArgumentParser(prog="python3 -m lab.results", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", nargs="?", choices=["page", "tables"])
    what = parser.parse_args().what
    if "PCL_SEMANTIC_DATA" not in os.environ:
        sys.exit("results: set PCL_SEMANTIC_DATA to the folder of real data")
    data = os.path.abspath(os.environ["PCL_SEMANTIC_DATA"])
    os.chdir(files.ROOT)
    run = Run(data)
    if what == "page":
        run.map_models(run.streets, ["none", "dense", "superpixel", "calibrated_dense"])
        run.map_others()
        run.made("made_page.md")
        run.write_page()
        return
    if what is None:
        run.map_everything()
        run.map_others()
        run.made("made.md")
        shutil.copy(OUT / "made.md", OUT / "made_page.md")
    elif not (OUT / "made.md").exists():
        sys.exit("results: no earlier run has ended")
    say("tables")
    run.write_page()
    run.write_appendix()
    for sequence in ["15", *run.streets]:
        run.pictures(sequence)
    print(f"tables:   {OUT}/results.md\npictures: {OUT}/SEQUENCE/pictures and "
          f"{OUT}/SEQUENCE/MODEL/overlay")


if __name__ == "__main__":
    files.run(main)
