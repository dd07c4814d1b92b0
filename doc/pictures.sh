#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
#
# The pictures of one sequence: its map at an angle, from above, where the CRF changed
# it, and a figure a frame. Those of the synthetic street in doc/images are made after
# ./dev demo by
#   build/bin/pcl_semantic_map build/demo/sequence --labels build/demo/sequence/labels \
#     --crf none --output build/demo/map_none
#   doc/pictures.sh build/demo/map build/demo/map_none \
#     build/demo/sequence/image_2 build/demo/sequence/gt build/demo/pictures 1000x560
#   build/bin/pcl_semantic_render build/demo/map build/demo/pictures/things.png \
#     --size 1000x560
#   build/bin/pcl_semantic_view build/demo/map --screenshot build/demo/pictures/view.png \
#     --size 1000x560 --hide sky --keys h
set -euo pipefail
(($# == 5 || $# == 6)) ||
  { echo "usage: doc/pictures.sh MAP MAP_WITHOUT_CRF IMAGES TRUTH OUT [SIZE]" >&2; exit 2; }
map=$1 before=$2 images=$3 truth=$4 out=$5 size=${6:-1600x900}
bin=$(dirname "$(realpath "${BASH_SOURCE[0]}")")/../build/bin

mkdir -p "$out"
"$bin/pcl_semantic_render" "$map" "$out/angle.png" --size "$size" --objects none
"$bin/pcl_semantic_render" "$map" "$out/above.png" --view above --size "$size" --objects none
"$bin/pcl_semantic_render" "$map" "$out/measured.png" --colour rgb --size "$size" --objects none
"$bin/pcl_semantic_render" "$map" "$out/changes.png" --compare "$before" --size "$size"
PYTHONPATH=$bin/../../python /usr/bin/python3 -m lab.compare --image "$images" --truth "$truth" \
  --labels "$map/network_labels" "$before/labels" "$map/labels" \
  --names "2D network,fused,after the CRF" --output "$out/sheets" --width "${size%x*}"
