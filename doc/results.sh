#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
#
# Maps KITTI sequences with several models, evaluates them, and writes doc/results.md.
# Called by ./dev results; PCL_SEMANTIC_DATA holds kitti/{15,00,03,05,07,09} and nets/.
# Labels of the network are computed once and kept in build/results.
set -euo pipefail
cd "$(dirname "$(realpath "${BASH_SOURCE[0]}")")/.."
[[ -n ${PCL_SEMANTIC_DATA:-} ]] ||
  { echo "results: set PCL_SEMANTIC_DATA to the folder of real data" >&2; exit 2; }

kitti=$PCL_SEMANTIC_DATA/kitti
label_set=data/label_sets/kitti11.yaml
network=data/networks/espnetv2_city_1280x480.yaml
model_file=$PCL_SEMANTIC_DATA/nets/espnetv2_s2.0_city_1280x480_halfres.onnx
streets=(00 03 05 07 09) # with lidar
out=build/results

# The models of the tables, in their order: a name, what the tables call it, and what
# pcl_semantic_map is told. Another row is another line in each of the three.
# {calibration} stands for the calibration that was learned without the sequence.
models=(dense superpixel calibrated_dense calibrated_superpixel calibrated_supervoxel)
declare -A title=(
  [dense]="after dense CRF"
  [superpixel]="after hierarchical CRF, superpixels"
  [calibrated_dense]="calibrated, after dense CRF"
  [calibrated_superpixel]="calibrated, after hierarchical CRF, superpixels"
  [calibrated_supervoxel]="calibrated, after hierarchical CRF, supervoxels")
declare -A options=(
  [none]="--crf none"
  [dense]="--crf dense"
  [superpixel]="--crf hierarchical --cliques superpixel"
  [calibrated_dense]="--crf dense --label-calibration {calibration}"
  [calibrated_superpixel]="--crf hierarchical --cliques superpixel --label-calibration {calibration}"
  [calibrated_supervoxel]="--crf hierarchical --cliques supervoxel --label-calibration {calibration}")

say() { echo "== $*" >&2; }

# Distributions of the network, unless those that are there are of the same files.
label_sequence() { # SEQUENCE
  local folder=$out/$1/network_distributions stamp
  stamp=$(cat "$network" "$model_file" "$kitti/$1"/image_2/*.png | sha256sum)
  [[ $(cat "$folder/made_from" 2>/dev/null) != "$stamp" ]] || return 0
  say "sequence $1: network"
  rm -rf "$folder"
  build/bin/pcl_semantic_label "$kitti/$1" --network "$network" --model "$model_file" \
    --output "$folder" >&2
  echo "$stamp" >"$folder/made_from"
}

map_sequence() { # SEQUENCE MODEL
  local also=measured
  [[ ! -d $kitti/$1/velodyne ]] || also+=,scans
  local calibration=$out/calibration/without_$1.yaml
  [[ -f $calibration ]] || calibration=$out/calibration/calibration.yaml
  say "sequence $1: $2"
  # shellcheck disable=SC2086 # the options of a model are words
  build/bin/pcl_semantic_map "$kitti/$1" --labels "$out/$1/network_distributions" \
    --also $also --scan-within 0.3 ${options[$2]//\{calibration\}/$calibration} --output "$out/$1/$2" >/dev/null
}

# truth, truth_scan (point by point), and the depth of both; or the hand-made images.
make_truth() { # SEQUENCE
  rm -rf "${out:?}/$1"/truth*
  if [[ -d $kitti/$1/labels ]]; then
    build/bin/pcl_semantic_lidar_truth "$kitti/$1" --label-set "$label_set" \
      --label-mapping data/label_mappings/semantic_kitti_to_kitti11.yaml \
      --output "$out/$1/truth" --depth "$out/$1/truth_depth" \
      --scan-labels "$out/$1/truth_scan" --scan-depth "$out/$1/truth_scan_depth" >/dev/null
  else
    ln -sfn "$(realpath "$kitti/$1/gt")" "$out/$1/truth"
  fi
}

# scores NAME MODEL PREDICTION TRUTH [COVERED_BY]: a row of a table, pooled over
# ${sequences[@]}; with ${bands[@]} a row a band. NAME "" is the header of the table.
sequences=() bands=()
scores() {
  local what=(--row "$1") folders=() sequence
  [[ -n $1 ]] || what=(--header)
  for sequence in "${sequences[@]}"; do
    folders+=(--prediction "$out/$sequence/$2/$3" --truth "$out/$sequence/$4")
    [[ $# -lt 5 ]] || folders+=(--covered-by "$out/$sequence/$2/$5")
    [[ ${#bands[@]} == 0 ]] || folders+=(--truth-depth "$out/$sequence/$4_depth")
  done
  build/bin/pcl_semantic_evaluate --label-set "$label_set" "${what[@]}" "${folders[@]}" \
    "${bands[@]}"
}

# The network on what the map covers, the fused measurements, every model.
rows() { # NAME PREDICTION FUSED_PREDICTION NETWORK_PREDICTION TRUTH
  local first=${models[0]} model
  scores "$1: 2D network, covered" "$first" "$4" "$5" "$2"
  scores "$1: fused, before CRF" "$first" "$3" "$5"
  scores "$1: calibrated, fused, before CRF" calibrated_dense "$3" "$5"
  for model in "${models[@]}"; do
    scores "$1: ${title[$model]}" "$model" "$2" "$5"
  done
}

header() { # TRUTH
  local prediction=labels
  [[ $1 != truth_scan ]] || prediction=scan_labels
  scores "" "${models[0]}" "$prediction" "$1"
}

image_table() { # SEQUENCES...
  sequences=("$@") bands=()
  header truth
  rows "at depth" labels_at_depth measured_labels_at_depth network_labels truth
  rows "rendered" labels measured_labels network_labels truth
  rows "rendered, finished map" final_labels final_measured_labels network_labels truth
}

scan_table() { # SEQUENCES...
  sequences=("$@") bands=()
  header truth_scan
  rows "causal" scan_labels measured_scan_labels network_scan_labels truth_scan
  rows "causal, to 0.3 m" near_scan_labels measured_near_scan_labels network_scan_labels \
    truth_scan
  rows "final" final_scan_labels final_measured_scan_labels network_scan_labels truth_scan
  rows "final, to 0.3 m" final_near_scan_labels final_measured_near_scan_labels \
    network_scan_labels truth_scan
}

band_table() { # SEQUENCES...
  sequences=("$@") bands=(--range 0:10 --range 10:20 --range 20:40)
  header truth
  rows "rendered" labels measured_labels network_labels truth
  rows "in 3D to 0.3 m" near_scan_labels measured_near_scan_labels network_scan_labels \
    truth_scan
}

geometry_table() { # SEQUENCES...
  local sequence all=()
  for sequence in "$@"; do
    all+=(--map "$out/$sequence/${models[0]}" --sequence "$kitti/$sequence")
  done
  build/bin/pcl_semantic_evaluate_map "${all[@]}" --header --row "all"
  for sequence in "$@"; do
    build/bin/pcl_semantic_evaluate_map "$out/$sequence/${models[0]}" \
      "$kitti/$sequence" --row "$sequence"
  done
}

times() { # MAP: median seconds of each stage
  sed -n '/"seconds"/,/^  }/p' "$1/summary.json" | awk '
    /": \{/ { gsub(/[" :{]/, ""); stage = $0 }
    /"median"/ { gsub(/[",]/, ""); if (stage != "seconds") printf "| %s | %.3f |\n", stage, $2 }'
}

pictures() { # SEQUENCES...: maps, changes and sheets of each; they stay untracked
  local sequence
  for sequence in "$@"; do
    echo "== pictures of sequence $sequence"
    doc/pictures.sh "$out/$sequence/calibrated_superpixel" "$out/$sequence/none" \
      "$kitti/$sequence/image_2" "$out/$sequence/truth" "$out/$sequence/pictures"
  done
}

load=$(cut -d' ' -f1 /proc/loadavg) # of other programs: the times suffer from it
for sequence in 15 "${streets[@]}"; do
  mkdir -p "$out/$sequence"
  label_sequence "$sequence"
  make_truth "$sequence"
done
say "calibration of the network"
build/bin/pcl_semantic_calibrate "${streets[@]/#/$kitti/}" --label-set "$label_set" \
  --labels "$out/{name}/network_distributions" --truth "$out/{name}/truth" \
  --output "$out/calibration" >&2
for sequence in 15 "${streets[@]}"; do
  for model in none "${models[@]}"; do # none: for the pictures
    map_sequence "$sequence" "$model"
  done
done
say "sequence 07: times, with the network"
build/bin/pcl_semantic_map "$kitti/07" --network "$network" --model "$model_file" \
  --output "$out/07/times" >/dev/null

say "tables"
{
  cat doc/results_head.md
  printf '\nMade on %s, %s x %s (load at the beginning %s), with the defaults of that day.\n' \
    "$(date +%Y-%m-%d)" "$(nproc)" \
    "$(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -n 1)" "$load"
  printf '\n## Sequences 00, 03, 05, 07, 09 pooled: lidar truth to 40 m\n\n'
  image_table "${streets[@]}"
  printf '\n## The same by distance\n\n'
  band_table "${streets[@]}"
  printf '\n## The same in 3D: labelled points against their voxels\n\n'
  scan_table "${streets[@]}"
  printf '\n## Sequences 05 and 07 alone\n\n'
  image_table 05 07
  printf '\n## Sequence 15: hand-made truth of frames 0 and 3\n\n'
  image_table 15
  printf '\n## Geometry of the finished maps against the lidar\n\n'
  geometry_table "${streets[@]}"
  printf '\n## Seconds a frame, 1241 x 376 pixels, sequence 07\n\n| stage | median |\n|---|---:|\n'
  times "$out/07/times"
} >"$out/results.md"
cp "$out/results.md" doc/results.md
echo "tables:   doc/results.md"
pictures 15 "${streets[@]}"
echo "pictures: $out/SEQUENCE/pictures and $out/SEQUENCE/MODEL/overlay"
