# SPDX-License-Identifier: BSD-3-Clause
"""The tables of doc/results.md and its appendix, from what lab.results has mapped."""

from lab import geometry, models, scores

DEPTH, RENDERED = "labels_at_depth", "labels"
BANDS = ((0, 10), (10, 20), (20, 40))


class Tables:
    """Tables as lists of lines. A street is a folder of \\a out, which holds folders of
    ground truth and of models."""

    def __init__(self, out, streets, kitti):
        self.out, self.streets, self.kitti = out, streets, kitti

    def figures(self, sequences, model, prediction, truth="truth", covered=None, band=None,
                ignored=scores.IGNORED):
        """Pooled over sequences."""
        def of(sequence):
            folder = f"{self.out}/{sequence}"
            return scores.confusion(
                f"{folder}/{model}/{prediction}", f"{folder}/{truth}",
                covered and f"{folder}/{model}/{covered}",
                band and f"{folder}/{truth}_depth", band)
        return scores.figures(sum(of(sequence) for sequence in sequences), ignored)

    def rows(self, sequences, name, prediction, network="network_labels", truth="truth",
             which=None, bands=(None,)):
        """The network on what the map covers, the fused measurements, every model."""
        final = "final_" if prediction.startswith("final_") else ""
        fused = f"{final}measured_{prediction[len(final):]}"
        lines = []

        def add(title, *given):
            for band in bands:
                text = f"{name}: {title}" + (f", {band[0]}-{band[1]} m" if band else "")
                found = self.figures(sequences, *given[:2], truth, *given[2:], band=band)
                lines.append(scores.row(text, found.values()))

        add("2D network, covered", "dense", network, prediction)
        add("fused, before CRF", "dense", fused)
        for model in which or models.MAIN:
            if model == "calibrated_dense":
                add("calibrated, fused, before CRF", model, fused)
            if model == "fine":  # it covers other pixels
                add("2D network where the next covers", model, network, prediction)
            add(models.TITLES[model], model, prediction)
        return lines

    def header(self, ignored=scores.IGNORED):
        classes = [each for each in scores.CLASSES if each not in ignored]
        return scores.header(classes + ["mean", "global accuracy", "mean inclusive", "coverage"])

    def both(self, sequences, which=None):
        return (self.rows(sequences, "at depth", DEPTH, which=which) +
                self.rows(sequences, "rendered", RENDERED, which=which))

    def finished(self, sequences):
        return self.rows(sequences, "rendered, finished map", "final_labels")

    def models(self, sequences):
        """Table I: the paper's models, then the calibrated ones."""
        calibrated = [each for each in models.MAIN if each not in models.COMPARED]
        return self.header() + self.both(sequences, models.COMPARED + calibrated)

    def presets(self, sequences):
        """Its systems. Each covers pixels of its own, on which the network is scored too."""
        lines = self.header()
        for model in models.PRESETS:
            for title, prediction in ((f"2D network where {model} covers", "network_labels"),
                                      (model, DEPTH)):
                found = self.figures(sequences, model, prediction,
                                     covered=None if prediction == DEPTH else DEPTH)
                lines.append(scores.row(f"at depth: {title}", found.values()))
        return lines

    def ablations(self):
        lines = self.header()
        for name, view in (("at depth", DEPTH), ("rendered", RENDERED)):
            for model in ["superpixel"] + models.ABLATIONS:
                found = self.figures(self.streets, model, view)
                lines.append(scores.row(f"{name}: {models.TITLES[model]}", found.values()))
        return lines

    def pixels(self, sequences):
        """Table II: the truth is drawn by hand, and sky counts as in the paper."""
        ignored = ("pedestrian", "cyclist")
        return self.header(ignored) + [
            scores.row(title, self.figures(sequences, "", f"image_{model}", "truth_images",
                                           ignored=ignored).values())
            for model, (title, _) in models.IMAGE_MODELS.items()]

    def by_sequence(self, view):
        def line(title, model, prediction):
            def mean(sequences, labels):
                found = self.figures(sequences, model, labels, covered=view)
                return round(found["mean"], 1)
            cells = [f"{mean([street], prediction):.1f}" for street in self.streets]
            for group in (self.streets, ["15"]):
                ours = mean(group, prediction)
                cells += [f"{ours:.1f}", f"{ours - mean(group, 'network_labels'):+.1f}"]
            return f"| {title} | {' | '.join(cells)} |"
        compared = models.COMPARED + models.PRESETS
        which = compared + [each for each in models.MAIN if each not in compared]
        return (scores.header(self.streets + ["pooled", "over network", "15", "over network"]) +
                [line("2D network, covered", "dense", "network_labels"),
                 line("fused, before CRF", "dense", f"measured_{view}")] +
                [line(models.TITLES[model], model, view) for model in which])

    def distances(self):
        return (self.header() +
                self.rows(self.streets, "rendered", RENDERED, bands=BANDS) +
                self.rows(self.streets, "in 3D to 0.3 m", "near_scan_labels",
                          "network_scan_labels", "truth_scan", bands=BANDS))

    def scans(self):
        lines = self.header()
        for name, prediction in (("causal", "scan_labels"),
                                 ("causal, to 0.3 m", "near_scan_labels"),
                                 ("final", "final_scan_labels"),
                                 ("final, to 0.3 m", "final_near_scan_labels")):
            lines += self.rows(self.streets, name, prediction, "network_scan_labels",
                               "truth_scan")
        return lines

    def gains(self, view, sequences):
        """Mean IoU and global accuracy, to a tenth: of the network where the map covers, then
        how far maps are above it, and what the CRF adds to the calibrated measurements."""
        def pair(model, prediction, covered=None):
            found = self.figures(sequences, model, prediction, covered=covered)
            return round(found["mean"], 1), round(found["global accuracy"], 1)

        def over(ours, other):
            return tuple(a - b for a, b in zip(ours, other))
        calibrated = pair("calibrated_dense", view)
        return [pair("dense", "network_labels", view),
                *(over(pair(model, view), pair(model, "network_labels", view))
                  for model in ("dense", "calibrated_dense")),
                over(calibrated, pair("calibrated_dense", f"measured_{view}"))]

    def answer(self, view):
        def line(name, found):
            first = "{:.1f} / {:.1f}".format(*found[0])
            return f"| {name} | {first} | " + " | ".join(
                "{:+.1f} / {:+.1f}".format(*each) for each in found[1:]) + " |"
        found = {street: self.gains(view, [street]) for street in self.streets}
        worst_first = sorted(found, key=lambda street: round(found[street][2][0], 1))
        return (["| street | 2D network | map | calibrated | the CRF's part |",
                 "|---|---:|---:|---:|---:|"] +
                [line(street, found[street]) for street in worst_first] +
                [line("**pooled**", self.gains(view, self.streets))])

    def geometry(self):
        def row(name, sequences):
            return geometry.rows([f"{self.out}/{each}/dense" for each in sequences],
                                 [f"{self.kitti}/{each}" for each in sequences], name)
        return ([geometry.header(), row("all", self.streets)] +
                [row(street, [street]) for street in self.streets])

    def page(self, made):
        return sections([
            ("At depth", self.answer(DEPTH)), ("Rendered", self.answer(RENDERED)),
            ("Geometry of the finished maps against the lidar", self.geometry() + ["", made])])

    def appendix(self, made, drawn, times):
        streets, pooled = self.streets, " ".join(self.streets)
        tables = [
            (f"Table I, models: sequences {pooled} pooled, lidar ground truth to 40 m",
             self.models(streets)),
            (f"Table I, systems: sequences {pooled} pooled", self.presets(streets)),
            (f"Table II: CRFs over the pixels of images, sequences {' '.join(drawn)}",
             self.pixels(drawn)),
            ("Table III: seconds a frame, 1226 x 370 pixels", times),
            ("Table I, models: sequence 15, hand-made ground truth of frames 0 and 3",
             self.models(["15"])),
            ("Table I, systems: sequence 15", self.presets(["15"])),
            ("Table I by sequence: mean IoU at depth", self.by_sequence(DEPTH)),
            ("Table I by sequence: mean IoU rendered", self.by_sequence(RENDERED)),
            ("Ablations of the hierarchical model with superpixels", self.ablations()),
            ("By distance", ["![Mean IoU by distance, rendered](images/results_distance.png)", "",
                             *self.distances()]),
            ("In 3D: labelled points against their voxels", self.scans()),
            (f"Finished maps, sequences {pooled} pooled",
             self.header() + self.finished(streets)),
            ("Finished maps, sequence 15", self.header() + self.finished(["15"]))]
        if "05 07" in pooled:
            pair = ["05", "07"]
            tables.append(("Sequences 05 and 07 alone",
                           self.header() + self.both(pair) + self.finished(pair)))
        return f"\n{made}\n" + sections(tables)


def sections(tables):
    return "".join("\n## " + "\n".join([title, "", *lines]) + "\n" for title, lines in tables)
