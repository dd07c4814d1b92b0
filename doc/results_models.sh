# SPDX-License-Identifier: BSD-3-Clause
#
# What doc/results.sh maps: of each model what the tables call it and what
# pcl_semantic_map is told. Another row is a name in a list and a line in each of the
# others. {calibration} and {cliques} stand for what was learned without the sequence.
# shellcheck shell=bash disable=SC2034 # for the script that reads it

# In every table, also in 3D and by distance.
main_models=(dense superpixel calibrated_dense calibrated_superpixel calibrated_supervoxel
  calibrated_cliques fine)
# Table I, what the paper compares: its models, all with the same network as it comes.
compared_models=(dense pn_potts superpixel clique_kernels no_free_label supervoxel)
# And the systems, each on a map of its own.
presets=(paper paper_dense released sengupta13 hermans14 vineet15 zhao16 sengupta15)
# One thing changed of the model `superpixel`.
ablations=(every_4 five_updates write_back product)
all_models=("${main_models[@]}" pn_potts clique_kernels no_free_label supervoxel
  "${presets[@]}" "${ablations[@]}")

hierarchical="--crf hierarchical --cliques superpixel"
calibrated_cliques="--config data/presets/calibrated_cliques.yaml
  --label-calibration {calibration} --clique-calibration {cliques}"
write_back=build/write_back.yaml # a key that is no option
mkdir -p build && echo "crf_write_back: true" >"$write_back"
fine="--voxel-size 0.06 --max-deviation 3" # data/presets/fine.yaml
declare -A title=(
  [dense]="after dense CRF"
  [pn_potts]="after P^n Potts CRF, superpixels"
  [superpixel]="after hierarchical CRF, superpixels"
  [clique_kernels]="hierarchical with kernels between cliques"
  [no_free_label]="hierarchical without the free label"
  [supervoxel]="after hierarchical CRF, supervoxels"
  [calibrated_dense]="calibrated, after dense CRF"
  [calibrated_superpixel]="calibrated, after hierarchical CRF, superpixels"
  [calibrated_supervoxel]="calibrated, after hierarchical CRF, supervoxels"
  [calibrated_cliques]="calibrated labels and cliques, after hierarchical CRF, superpixels"
  [fine]="calibrated labels and cliques in voxels of 0.06 m, preset fine"
  [every_4]="CRF at every fourth frame"
  [five_updates]="five updates a frame"
  [write_back]="the posterior is the next prior"
  [product]="product of pixels instead of their mean")
declare -A options=(
  [none]="--crf none"
  [dense]="--crf dense"
  [pn_potts]="--crf pn-potts --cliques superpixel"
  [superpixel]="$hierarchical"
  [clique_kernels]="$hierarchical --clique-appearance-weight 8"
  [no_free_label]="$hierarchical --clique-free-label false"
  [supervoxel]="--crf hierarchical --cliques supervoxel"
  [calibrated_dense]="--crf dense --label-calibration {calibration}"
  [calibrated_superpixel]="$hierarchical --label-calibration {calibration}"
  [calibrated_supervoxel]="--crf hierarchical --cliques supervoxel --label-calibration {calibration}"
  [calibrated_cliques]="$calibrated_cliques"
  [fine]="$calibrated_cliques $fine"
  [every_4]="$hierarchical --crf-every 4"
  [five_updates]="$hierarchical --crf-iterations 5"
  [write_back]="$hierarchical --config $write_back"
  [product]="$hierarchical --pixel-fusion product")
for preset in "${presets[@]}"; do
  title[$preset]="preset $preset"
  options[$preset]="--config data/presets/$preset.yaml"
done

# Table II, over the pixels of an image: what pcl_semantic_image_crf is told.
image_models=(unary dense pn_potts hierarchical)
declare -A image_title=(
  [unary]="2D network"
  [dense]="dense CRF"
  [pn_potts]="P^n Potts CRF"
  [hierarchical]="hierarchical CRF")
declare -A image_options=(
  [unary]="--crf unary"
  [dense]="--crf dense"
  [pn_potts]="--crf pn-potts --cliques slic"
  [hierarchical]="--crf hierarchical --cliques slic")
