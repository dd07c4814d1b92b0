# SPDX-License-Identifier: BSD-3-Clause
"""The models of the tables: what they are called and what pcl_semantic_map is told.
{calibration} and {cliques} stand for what was learned without the sequence."""

HIERARCHICAL = "--crf hierarchical --cliques superpixel"
SUPERVOXEL = "--crf hierarchical --cliques supervoxel"
LABELS = " --label-calibration {calibration}"
CLIQUES = ("--config data/presets/calibrated_cliques.yaml --clique-calibration {cliques}"
           + LABELS)

# In every table, also in 3D and by distance.
MAIN = ["dense", "superpixel", "calibrated_dense", "calibrated_superpixel",
        "calibrated_supervoxel", "calibrated_cliques", "fine"]
# Table I, what the paper compares: its models, all with the same network as it comes.
COMPARED = ["dense", "pn_potts", "superpixel", "clique_kernels", "no_free_label", "supervoxel"]
# And the systems, each on a map of its own.
PRESETS = ["paper", "paper_dense", "released", "sengupta13", "hermans14", "vineet15", "zhao16",
           "sengupta15"]
# One thing changed of the model `superpixel`.
ABLATIONS = ["every_4", "five_updates", "write_back", "product"]

TITLES = {
    "dense": "after dense CRF",
    "pn_potts": "after P^n Potts CRF, superpixels",
    "superpixel": "after hierarchical CRF, superpixels",
    "clique_kernels": "hierarchical with kernels between cliques",
    "no_free_label": "hierarchical without the free label",
    "supervoxel": "after hierarchical CRF, supervoxels",
    "calibrated_dense": "calibrated, after dense CRF",
    "calibrated_superpixel": "calibrated, after hierarchical CRF, superpixels",
    "calibrated_supervoxel": "calibrated, after hierarchical CRF, supervoxels",
    "calibrated_cliques":
        "calibrated labels and cliques, after hierarchical CRF, superpixels",
    "fine": "calibrated labels and cliques in voxels of 0.06 m, preset fine",
    "every_4": "CRF at every fourth frame",
    "five_updates": "five updates a frame",
    "write_back": "the posterior is the next prior",
    "product": "product of pixels instead of their mean",
    **{preset: f"preset {preset}" for preset in PRESETS}}

OPTIONS = {
    "none": "--crf none",
    "dense": "--crf dense",
    "pn_potts": "--crf pn-potts --cliques superpixel",
    "superpixel": HIERARCHICAL,
    "clique_kernels":
        HIERARCHICAL + " --clique-smoothness-weight 3 --clique-appearance-weight 8",
    "no_free_label": HIERARCHICAL + " --clique-free-label false",
    "supervoxel": SUPERVOXEL,
    "calibrated_dense": "--crf dense" + LABELS,
    "calibrated_superpixel": HIERARCHICAL + LABELS,
    "calibrated_supervoxel": SUPERVOXEL + LABELS,
    "calibrated_cliques": CLIQUES,
    "fine": CLIQUES + " --voxel-size 0.06 --max-deviation 3",  # data/presets/fine.yaml
    "every_4": HIERARCHICAL + " --crf-every 4",
    "five_updates": HIERARCHICAL + " --crf-iterations 5",
    "write_back": HIERARCHICAL + " --crf-write-back true",
    "product": HIERARCHICAL + " --pixel-fusion product",
    **{preset: f"--config data/presets/{preset}.yaml" for preset in PRESETS}}

# Table II, over the pixels of an image: titles, and what pcl_semantic_image_crf is told.
IMAGE_MODELS = {
    "unary": ("2D network", "--crf unary"),
    "dense": ("dense CRF", "--crf dense"),
    "pn_potts": ("P^n Potts CRF", "--crf pn-potts --cliques slic"),
    "hierarchical": ("hierarchical CRF", "--crf hierarchical --cliques slic")}


def mapped():
    """All of them; `none` is for the pictures."""
    return list(dict.fromkeys(["none"] + MAIN + COMPARED + PRESETS + ABLATIONS))
