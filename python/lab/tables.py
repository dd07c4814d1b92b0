# SPDX-License-Identifier: BSD-3-Clause
"""The tables of doc/results.md and its appendix, from what lab.results has mapped."""

from lab import geometry, models, scores

DEPTH, RENDERED, NETWORK = "labels_at_depth", "labels", "network_labels"
BANDS = ((0, 10), (10, 20), (20, 40))


def header(ignored=scores.IGNORED):
    classes = [each for each in scores.CLASSES if each not in ignored]
    return scores.header(classes + ["mean", "global accuracy", "mean inclusive", "coverage"])


class Tables:
    """Tables as lists of lines. Each street has a folder in `out`, with folders of ground
    truth and of models."""

    def __init__(self, out, streets, kitti):
        self.out, self.streets, self.kitti = out, streets, kitti

    def figures(self, sequences, model, prediction, truth="truth", covered=None, band=None,
                ignored=scores.IGNORED):
        """Pooled over sequences; `covered` is a folder of the model, as the prediction is."""
        counts = 0
        for folder in (f"{self.out}/{each}" for each in sequences):
            counts = counts + scores.confusion(
                f"{folder}/{model}/{prediction}", f"{folder}/{truth}",
                covered and f"{folder}/{model}/{covered}", band and f"{folder}/{truth}_depth",
                band)
        return scores.figures(counts, ignored)

    def row(self, name, *given, band=None, **options):
        name += f", {band[0]}-{band[1]} m" if band else ""
        return scores.row(name, self.figures(*given, band=band, **options).values())

    def rows(self, sequences, name, prediction, which=None, bands=(None,)):
        """The network on what the map covers, the fused measurements, every model."""
        scans = prediction.endswith("scan_labels")
        network, truth = ("network_scan_labels", "truth_scan") if scans else (NETWORK, "truth")
        final = "final_" if prediction.startswith("final_") else ""
        fused = f"{final}measured_{prediction[len(final):]}"
        given = [("2D network, covered", "dense", network, prediction),
                 ("fused, before CRF", "dense", fused, None)]
        for model in which or models.MAIN:
            if model == "calibrated_dense":
                given.append(("calibrated, fused, before CRF", model, fused, None))
            if model == "fine":  # it covers other pixels
                given.append(("2D network where the next covers", model, network, prediction))
            given.append((models.title(model), model, prediction, None))
        return [self.row(f"{name}: {title}", sequences, model, labels, truth, covered, band=band)
                for title, model, labels, covered in given for band in bands]

    def both(self, sequences, which=None):
        return (self.rows(sequences, "at depth", DEPTH, which) +
                self.rows(sequences, "rendered", RENDERED, which))

    def finished(self, sequences):
        return self.rows(sequences, "rendered, finished map", "final_labels")

    def models(self, sequences):
        """Table I: the paper's models, then the calibrated ones."""
        others = [each for each in models.MAIN if each not in models.COMPARED]
        return header() + self.both(sequences, models.COMPARED + others)

    def presets(self, sequences):
        """Its systems. Each covers pixels of its own, on which the network is scored too."""
        lines = header()
        for model in models.PRESETS:
            lines += [self.row(f"at depth: 2D network where {model} covers", sequences, model,
                               NETWORK, covered=DEPTH),
                      self.row(f"at depth: {model}", sequences, model, DEPTH)]
        return lines

    def ablations(self):
        return header() + [
            self.row(f"{name}: {models.title(model)}", self.streets, model, view)
            for name, view in (("at depth", DEPTH), ("rendered", RENDERED))
            for model in ["superpixel"] + models.ABLATIONS]

    def pixels(self, sequences):
        """Table II: the truth is drawn by hand, and sky counts as in the paper."""
        ignored = ("pedestrian", "cyclist")
        return header(ignored) + [
            self.row(title, sequences, "", f"image_{model}", "truth_images", ignored=ignored)
            for model, (title, _) in models.IMAGE_MODELS.items()]

    def by_sequence(self, view):
        def line(title, model, prediction):
            def mean(sequences, labels):
                return round(self.figures(sequences, model, labels, covered=view)["mean"], 1)
            cells = [f"{mean([street], prediction):.1f}" for street in self.streets]
            for group in (self.streets, ["15"]):
                ours = mean(group, prediction)
                cells += [f"{ours:.1f}", f"{ours - mean(group, NETWORK):+.1f}"]
            return f"| {title} | {' | '.join(cells)} |"
        which = list(dict.fromkeys(models.COMPARED + models.PRESETS + models.MAIN))
        return (scores.header(self.streets + ["pooled", "over network", "15", "over network"]) +
                [line("2D network, covered", "dense", NETWORK),
                 line("fused, before CRF", "dense", f"measured_{view}")] +
                [line(models.title(model), model, view) for model in which])

    def distances(self):
        return (header() + self.rows(self.streets, "rendered", RENDERED, bands=BANDS) +
                self.rows(self.streets, "in 3D to 0.3 m", "near_scan_labels", bands=BANDS))

    def scans(self):
        lines = header()
        for name, prefix in (("causal", ""), ("final", "final_")):
            lines += self.rows(self.streets, name, f"{prefix}scan_labels")
            lines += self.rows(self.streets, f"{name}, to 0.3 m", f"{prefix}near_scan_labels")
        return lines

    def gains(self, view, sequences):
        """Mean IoU and global accuracy, to a tenth: of the network where the map covers, then
        how far maps (causal, final, calibrated) are above it, and what the CRF adds to the
        calibrated measurements."""
        def pair(model, prediction, covered=None):
            found = self.figures(sequences, model, prediction, covered=covered)
            return round(found["mean"], 1), round(found["global accuracy"], 1)

        def over(ours, other):
            return tuple(a - b for a, b in zip(ours, other))
        network = pair("dense", NETWORK, view)
        calibrated = pair("calibrated_dense", view)
        final = f"final_{view}"
        return [network, over(pair("dense", view), network),
                over(pair("dense", final), pair("dense", NETWORK, final)),
                over(calibrated, pair("calibrated_dense", NETWORK, view)),
                over(calibrated, pair("calibrated_dense", f"measured_{view}"))]

    def answer(self, view):
        def line(name, found):
            return scores.gains_row(name, found[0], found[1:])
        found = {street: self.gains(view, [street]) for street in self.streets}
        worst_first = sorted(found, key=lambda street: round(found[street][1][0], 1))
        return (["| street | 2D network | map | map, final | calibrated | the CRF's part |",
                 "|---|---:|---:|---:|---:|---:|"] +
                [line(street, found[street]) for street in worst_first] +
                [line("**pooled**", self.gains(view, self.streets))])

    def things(self):
        """Panoptic quality in the map at each frame: fused, dense, hierarchical."""
        def quality(sequences, model):
            return scores.panoptic(
                *(tuple(f"{self.out}/{each}/{which}/near_scan_labels" for each in sequences)
                  for which in (model, "dense")),
                tuple(f"{self.kitti}/{each}/labels" for each in sequences))

        def line(name, sequences):
            found = [quality(sequences, model) for model in ("none", "dense", "superpixel")]
            cells = [str(found[0][1])] + [f"{each:.1f}" for each, _ in found]
            return f"| {name} | {' | '.join(cells)} |"
        worst_first = sorted(self.streets, key=lambda street: quality([street], "dense")[0] -
                             quality([street], "none")[0])
        return (["| street | objects | fused | dense CRF | hierarchical CRF |",
                 "|---|---:|---:|---:|---:|"] +
                [line(street, [street]) for street in worst_first] +
                [line("**pooled**", self.streets)])

    def geometry(self):
        def row(name, sequences):
            return geometry.rows([f"{self.out}/{each}/dense" for each in sequences],
                                 [f"{self.kitti}/{each}" for each in sequences], name)
        return ([geometry.header(), row("all", self.streets)] +
                [row(street, [street]) for street in self.streets])

    def page(self, made, others):
        """`others` are tables of other sensors by their titles."""
        return sections({
            "Streets from stereo, at depth": self.answer(DEPTH),
            "Streets from stereo, rendered": self.answer(RENDERED), **others,
            "Objects in the scans": self.things(),
            "Geometry of the finished maps against the lidar": self.geometry() + ["", made]})

    def appendix(self, made, drawn, times):
        streets, pooled = self.streets, " ".join(self.streets)
        tables = {
            f"Table I, models: sequences {pooled} pooled, lidar ground truth to 40 m":
                self.models(streets),
            f"Table I, systems: sequences {pooled} pooled": self.presets(streets),
            f"Table II: CRFs over the pixels of images, sequences {' '.join(drawn)}":
                self.pixels(drawn),
            "Table III: seconds a frame, 1226 x 370 pixels": times,
            "Table I, models: sequence 15, hand-made ground truth of frames 0 and 3":
                self.models(["15"]),
            "Table I, systems: sequence 15": self.presets(["15"]),
            "Table I by sequence: mean IoU at depth": self.by_sequence(DEPTH),
            "Table I by sequence: mean IoU rendered": self.by_sequence(RENDERED),
            "Ablations of the hierarchical model with superpixels": self.ablations(),
            "By distance": ["![Mean IoU by distance, rendered](images/results_distance.png)", ""]
                           + self.distances(),
            "In 3D: labelled points against their voxels": self.scans(),
            f"Finished maps, sequences {pooled} pooled": header() + self.finished(streets),
            "Finished maps, sequence 15": header() + self.finished(["15"])}
        if "05 07" in pooled:
            tables["Sequences 05 and 07 alone"] = (header() + self.both(["05", "07"]) +
                                                   self.finished(["05", "07"]))
        return f"\n{made}\n" + sections(tables)


def sections(tables):
    return "".join(f"\n## {title}\n\n" + "\n".join(lines) + "\n"
                   for title, lines in tables.items())
