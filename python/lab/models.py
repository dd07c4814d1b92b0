# SPDX-License-Identifier: BSD-3-Clause
"""The models of the tables: their titles, and the options of pcl_semantic_map. {calibration}
stands for what was learned without the sequence."""

# In every table, also in 3D and by distance.
MAIN = ["dense", "superpixel", "calibrated_dense", "calibrated_superpixel",
        "calibrated_supervoxel", "fine"]
# Table I, what the paper compares: its models, all with the same network as it comes.
COMPARED = ["dense", "pn_potts", "superpixel", "clique_kernels", "no_free_label", "supervoxel"]
# And the systems, each on a map of its own.
PRESETS = ["paper", "paper_dense", "released", "sengupta13", "hermans14", "vineet15", "zhao16",
           "sengupta15"]
# One thing changed of the model `superpixel`.
ABLATIONS = ["every_4", "five_updates", "write_back", "product"]

SUPERPIXEL = "--crf hierarchical --cliques superpixel"
SUPERVOXEL = "--crf hierarchical --cliques supervoxel"
LABELS = "--label-calibration {calibration}"
MODELS = {
    "none": ("", "--crf none"),  # for the pictures and the objects
    "dense": ("after dense CRF", "--crf dense"),
    "pn_potts": ("after P^n Potts CRF, superpixels", "--crf pn-potts --cliques superpixel"),
    "superpixel": ("after hierarchical CRF, superpixels", SUPERPIXEL),
    "clique_kernels": (
        "hierarchical with kernels between cliques",
        f"{SUPERPIXEL} --clique-appearance-weight 8"),
    "no_free_label": ("hierarchical without the free label",
                      f"{SUPERPIXEL} --clique-free-label false"),
    "supervoxel": ("after hierarchical CRF, supervoxels", SUPERVOXEL),
    "calibrated_dense": ("calibrated, after dense CRF", f"--crf dense {LABELS}"),
    "calibrated_superpixel": ("calibrated, after hierarchical CRF, superpixels",
                              f"{SUPERPIXEL} {LABELS}"),
    "calibrated_supervoxel": ("calibrated, after hierarchical CRF, supervoxels",
                              f"{SUPERVOXEL} {LABELS}"),
    "fine": ("calibrated, in voxels of 0.06 m, preset fine",
             f"--config data/presets/fine.yaml {LABELS}"),
    "every_4": ("CRF at every fourth frame", f"{SUPERPIXEL} --crf-every 4"),
    "five_updates": ("five updates a frame", f"{SUPERPIXEL} --crf-iterations 5"),
    "write_back": ("the posterior is the next prior", f"{SUPERPIXEL} --config python/lab/write_back.yaml"),
    "product": ("product of pixels instead of their mean",
                f"{SUPERPIXEL} --pixel-fusion product"),
    **{name: (f"preset {name}", f"--config data/presets/{name}.yaml") for name in PRESETS}}

# Table II, over the pixels of an image: titles, and the options of pcl_semantic_image_crf.
IMAGE_MODELS = {
    "unary": ("2D network", "--crf unary"),
    "dense": ("dense CRF", "--crf dense"),
    "pn_potts": ("P^n Potts CRF", "--crf pn-potts --cliques slic"),
    "hierarchical": ("hierarchical CRF", "--crf hierarchical --cliques slic")}


def title(model):
    return MODELS[model][0]
