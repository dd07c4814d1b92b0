#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""From what a network says of points to labels that fit together.

    softmax_to_labels.py                                  a generated room
    softmax_to_labels.py CLOUD SOFTMAX.npy OUTPUT.pcd     CLOUD: .pcd, .ply or .bin;
                                                          SOFTMAX: N x L, float

A network for clouds (or for images, looked up at the points) ends in a soft-max: for each
of N points L numbers that sum to one. That array is all that is needed.
"""

import sys

import numpy as np

import pcl_semantic


def generated_room(seed=1):
    """Floor, wall and a table, 30 % of the points told wrongly: points, soft-max, truth."""
    random = np.random.default_rng(seed)
    corners = {1: ([0, 0, 0], [5, 5, 0.02]),       # floor
               2: ([0, 4.98, 0.1], [5, 5, 2.5]),   # wall
               3: ([1, 1, 0.7], [2.5, 2.5, 0.75])} # table
    points = np.concatenate([random.uniform(*corners[c], (4000, 3)) for c in corners])
    truth = np.repeat(list(corners), 4000)
    logits = random.normal(0, 1, (len(points), 3))
    logits[np.arange(len(points)), truth - 1] += 1.5
    softmax = np.exp(logits)
    return points, softmax / softmax.sum(axis=1, keepdims=True), truth


def main():
    if len(sys.argv) == 4:
        cloud = pcl_semantic.read_cloud(sys.argv[1])
        points = np.column_stack([cloud[axis] for axis in "xyz"])
        softmax, truth = np.load(sys.argv[2]), None
    else:
        points, softmax, truth = generated_room()
        cloud = dict(zip("xyz", points.astype(np.float32).T))

    # Most likely class of each point by itself; class numbers begin at 1.
    network = softmax.argmax(axis=1) + 1

    # Near points probably have one class; in a cubicle of half a metre most of them do.
    labels, probabilities = pcl_semantic.refine(
        points, probabilities=softmax, crf="hierarchical", cliques="cubes:0.5")
    print(f"{np.count_nonzero(labels != network)} of {len(labels)} labels changed")

    if truth is not None:
        classes = softmax.shape[1]
        for name, found in [("network", network), ("refined", labels)]:
            matrix = pcl_semantic.confusion_matrix(truth, found, classes)
            print(f"{name}: mean IoU {pcl_semantic.scores(matrix)['mean_iou']:.3f}")
    if len(sys.argv) == 4:
        # Colours, intensity and what else the file had stay beside the labels.
        pcl_semantic.write_cloud(
            sys.argv[3],
            {**cloud, "label": labels.astype(np.uint32), "probability": probabilities})


if __name__ == "__main__":
    main()
