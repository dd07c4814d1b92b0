#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
#
# Runs the programs and compares the bytes of their results with test/same_bytes.sha256:
#
#   test/same_bytes.sh [--record] [BIN]
#
# BIN holds the programs (default: build/bin). --record writes the checksums anew.
# Results of real data are skipped unless PCL_SEMANTIC_DATA names its folder.
set -euo pipefail
top=$(dirname "$(dirname "$(realpath "${BASH_SOURCE[0]}")")")
record=
[[ ${1:-} != --record ]] || { record=yes && shift; }
bin=$(realpath "${1:-$top/build/bin}")
expected=$top/test/same_bytes.sha256
classes=$top/data/label_sets/kitti11.yaml
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cd "$scratch"

map_street() { # OUTPUT OPTIONS...
  "$bin/pcl_semantic_map" street --labels street/labels --output "$1" --quiet "${@:2}"
}

demo() {
  "$bin/pcl_semantic_synthesize" street --frames 30 --quiet
  map_street map --archive street.map
  "$bin/pcl_semantic_archive" export street.map export.pcd --quiet
  "$bin/pcl_semantic_archive" export "$top/test/io/archive_version_2.map" \
    old_export.pcd --quiet
  cat map/final_labels/*.png map/labels/*.png >labels
  "$bin/pcl_semantic_crf" map/map.pcd crf_map.pcd --label-set "$classes" --quiet
}

presets() {
  local file name
  for file in "$top"/data/presets/*.yaml; do
    name=$(basename "$file" .yaml)
    map_street "preset_$name" --config "$file" --frames 0:4 --map-only
  done
}

fleet() {
  cat >plan.yaml <<'END'
output: city
options: {submap_every: 2, voxel_size: 0.2}
drives:
  - {name: begin, frames: '0:3', sequence: street, labels: street/labels}
  - {name: end, frames: '3:6', sequence: street, labels: street/labels}
END
  "$bin/pcl_semantic_fleet" plan.yaml --quiet
}

real_clouds() {
  local kitti=$PCL_SEMANTIC_DATA/kitti/07
  cp "$kitti/velodyne/000000.bin" "$kitti/labels/000000.label" .
  "$bin/pcl_semantic_crf" 000000.bin crf_scan.pcd --label-set "$classes" \
    --label-mapping semantic_kitti_to_kitti11 --quiet
  "$bin/pcl_semantic_crf" "$PCL_SEMANTIC_DATA/clouds/mosd_learn0.pcd" crf_objects.pcd \
    --quiet
}

demo
presets
fleet
results=(map/map.pcd map/objects.json export.pcd old_export.pcd labels crf_map.pcd preset_*/map.pcd city/map.tiles
  city/tiles/*.map city/objects.map)
if [[ -n ${PCL_SEMANTIC_DATA:-} ]]; then
  real_clouds
  results+=(crf_scan.pcd crf_objects.pcd)
else
  echo "PCL_SEMANTIC_DATA is not set: results of real clouds are skipped"
  grep -vE '  crf_(scan|objects)\.pcd$' "$expected" >checked
  expected=$scratch/checked
fi
if [[ -n $record ]]; then
  [[ -n ${PCL_SEMANTIC_DATA:-} ]] || { echo "--record needs PCL_SEMANTIC_DATA" >&2; exit 2; }
  {
    echo "# Results on every platform, with every SIMD tier and any number of threads."
    echo "# A change that is meant to change one says so and records it again (same_bytes.sh)."
    sha256sum "${results[@]}"
  } >"$expected"
fi
sha256sum --check "$expected"
