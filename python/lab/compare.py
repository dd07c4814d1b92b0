# SPDX-License-Identifier: BSD-3-Clause
"""Draws label images of one frame below each other, and beside each where it differs from
the one above: green where a change is right, red where it is wrong, yellow where both are,
in the colour of the new class where there is no ground truth. Given folders, draws one
figure for each frame."""

import argparse
from pathlib import Path

import matplotlib
import numpy as np
from PIL import Image
from scipy.ndimage import grey_dilation

from lab import files

matplotlib.use("Agg")
from matplotlib import patches, pyplot  # noqa: E402, after the choice of a backend

RIGHT, WRONG, STILL_WRONG = (40, 190, 70), (235, 40, 50), (250, 200, 60)


def blend(image, labels, colours):
    """The image under the colours of its labels."""
    return np.where((labels > 0)[..., None], 0.4 * image + 0.6 * colours[labels],
                    image).astype(np.uint8)


def larger(labels, truth):
    """Truth of a laser scan is dots that would not be seen: they are drawn larger."""
    sparse = np.count_nonzero(truth) < 0.2 * truth.size
    return grey_dilation(labels, (5, 5)) if sparse else labels


def changes(image, before, after, truth, colours):
    """A pale image with the pixels that changed, and what is said of them."""
    both = (before > 0) & (after > 0)
    changed = both & (before != after)
    right, wrong = (changed & (truth > 0) & (truth == each) for each in (after, before))
    picture = np.repeat(0.45 * image.mean(axis=2, keepdims=True) + 120, 3, axis=2)
    unknown = changed & (truth == 0)
    picture[unknown] = colours[after[unknown]]
    kinds = larger(np.select([right, wrong, changed & (truth > 0)], [1, 2, 3]), truth)
    for kind, colour in enumerate((RIGHT, WRONG, STILL_WRONG), 1):
        picture[kinds == kind] = colour
    text = f"{100 * changed.sum() / max(1, both.sum()):.1f} % differ"
    if truth.any():
        text += f", {right.sum()} pixels became right, {wrong.sum()} wrong"
    return picture.astype(np.uint8), text


def draw(path, image, labels, truth, classes, width=1920):
    """Writes a figure of label images by their names; truth may be None."""
    for name, each in {**labels, "truth": truth}.items():
        if each is not None and (each.shape != image.shape[:2] or each.max() > len(classes)):
            raise ValueError(f"{name}: labels are of another size, or beyond the label set")
    colours = np.array([(0, 0, 0)] + [each["colour"] for each in classes])
    known = truth if truth is not None else np.zeros(image.shape[:2], np.uint8)
    side = ("ground truth", blend(image, larger(known, known), colours)) if known.any() else (
        "image", image)
    height, below = width / 2 * image.shape[0] / image.shape[1] + 30, 60  # [px]
    figure, axes = pyplot.subplots(len(labels), 2, squeeze=False, layout="constrained", dpi=100,
                                   figsize=(width / 100, (height * len(labels) + below) / 100))
    before = None
    for (name, each), (left, right) in zip(labels.items(), axes):
        left.imshow(blend(image, each, colours))
        left.set_title(name, fontsize=9)
        title, picture = side
        if before is not None:
            picture, title = changes(image, before, each, known, colours)
        right.imshow(picture)
        right.set_title(title, fontsize=9)
        before = each
    for each in axes.flat:
        each.axis("off")
    there = np.unique(np.concatenate([each.ravel() for each in [known, *labels.values()]]))
    entries = [(classes[i - 1]["name"], colours[i]) for i in there if i > 0]
    if known.any():
        entries += [("became right", RIGHT), ("became wrong", WRONG),
                    ("wrong before and after", STILL_WRONG)]
    figure.legend(handles=[patches.Patch(color=np.array(colour) / 255, label=name)
                           for name, colour in entries],
                  loc="lower center", ncols=7, fontsize=8, frameon=False)
    below /= height * len(labels) + below
    figure.get_layout_engine().set(rect=(0, below, 1, 1 - below))
    figure.canvas.draw()
    picture = Image.fromarray(np.asarray(figure.canvas.buffer_rgba())[..., :3])
    picture = picture.quantize(256, Image.Quantize.MAXCOVERAGE)  # half the bytes
    files.replace(path, lambda file: picture.save(file, "png"))
    pyplot.close(figure)


def main():
    parser = argparse.ArgumentParser(prog="python3 -m lab.compare", description=__doc__)
    parser.add_argument("--image", required=True, help="image, or folder of them")
    parser.add_argument("--labels", required=True, nargs="+",
                        help="label images or folders, in the order of their making")
    parser.add_argument("--names", help="what they are called, with commas between")
    parser.add_argument("--truth", help="ground truth; a folder need not have all frames")
    parser.add_argument("--label-set", default=files.KITTI_CLASSES)
    parser.add_argument("--output", required=True, help="figure (.png), or folder of them")
    parser.add_argument("--width", type=int, default=1920, help="[px]")
    given = parser.parse_args()
    names = given.names.split(",") if given.names else [Path(p).stem for p in given.labels]
    if len(names) != len(given.labels):
        raise ValueError(f"--names has {len(names)} names for {len(given.labels)} --labels")
    classes = files.label_set(given.label_set)
    folder = Path(given.image).is_dir()
    if folder:
        Path(given.output).mkdir(parents=True, exist_ok=True)
    found = files.frames(given.labels[0], ".png").values() if folder else [None]
    for name in (each.name if folder else "" for each in found):
        image = np.asarray(Image.open(Path(given.image, name)).convert("RGB"))
        truth = given.truth and Path(given.truth, name)
        labels = {title: files.read_image(Path(path, name))
                  for title, path in zip(names, given.labels)}
        draw(Path(given.output, name), image, labels,
             files.read_image(truth) if truth and truth.exists() else None, classes, given.width)
    print(f"figures: {len(found)}")


if __name__ == "__main__":
    files.run(main)
