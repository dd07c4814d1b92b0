# SPDX-License-Identifier: BSD-3-Clause
#
# The tables of doc/results.md, from what doc/results.sh has mapped.
# shellcheck shell=bash disable=SC2154 # of the scripts beside it

# scores NAME MODEL PREDICTION TRUTH [COVERED_BY]: a row of a table, pooled over
# ${sequences[@]}; with ${bands[@]} a row a band. NAME "" is the header of the table.
sequences=() bands=() ignored=()
scores() {
  local what=(--row "$1") folders=() sequence
  [[ -n $1 ]] || what=(--header)
  for sequence in "${sequences[@]}"; do
    folders+=(--prediction "$out/$sequence/$2/$3" --truth "$out/$sequence/$4")
    [[ $# -lt 5 ]] || folders+=(--covered-by "$out/$sequence/$2/$5")
    [[ ${#bands[@]} == 0 ]] || folders+=(--truth-depth "$out/$sequence/$4_depth")
  done
  build/bin/pcl_semantic_evaluate --label-set "$label_set" "${what[@]}" "${folders[@]}" \
    "${bands[@]}" "${ignored[@]}"
}

header() { # TRUTH
  local prediction=labels
  [[ $1 != truth_scan ]] || prediction=scan_labels
  scores "" dense "$prediction" "$1"
}

# The network on what the map covers, the fused measurements, every model.
rows() { # NAME PREDICTION FUSED_PREDICTION NETWORK_PREDICTION TRUTH [MODELS...]
  local model models=("${@:6}")
  ((${#models[@]})) || models=("${main_models[@]}")
  scores "$1: 2D network, covered" dense "$4" "$5" "$2"
  scores "$1: fused, before CRF" dense "$3" "$5"
  for model in "${models[@]}"; do
    [[ $model != calibrated_dense ]] ||
      scores "$1: calibrated, fused, before CRF" calibrated_dense "$3" "$5"
    [[ $model != fine ]] || # it covers other pixels
      scores "$1: 2D network where the next covers" fine "$4" "$5" "$2"
    scores "$1: ${title[$model]}" "$model" "$2" "$5"
  done
}

# Table I: the paper's models, then the calibrated ones.
model_table() { # SEQUENCES...
  local models=("${compared_models[@]}" "${main_models[@]:2}")
  sequences=("$@") bands=()
  header truth
  rows "at depth" labels_at_depth measured_labels_at_depth network_labels truth \
    "${models[@]}"
  rows "rendered" labels measured_labels network_labels truth "${models[@]}"
}

# Its systems. Each covers pixels of its own, on which the network is scored too.
preset_table() { # SEQUENCES...
  local preset
  sequences=("$@") bands=()
  header truth
  for preset in "${presets[@]}"; do
    scores "at depth: 2D network where $preset covers" "$preset" network_labels truth \
      labels_at_depth
    scores "at depth: $preset" "$preset" labels_at_depth truth
  done
}

ablation_table() { # SEQUENCES...
  local view model
  sequences=("$@") bands=()
  header truth
  for view in labels_at_depth labels; do
    for model in superpixel "${ablations[@]}"; do
      scores "${view_name[$view]}: ${title[$model]}" "$model" "$view" truth
    done
  done
}
declare -A view_name=([labels_at_depth]="at depth" [labels]="rendered")

means() { # as scores: mean IoU and global accuracy of the row
  scores "$@" | awk -F ' *[|] *' '{ print $(NF - 4), $(NF - 3) }'
}

over() { # IOU ACCURACY IOU ACCURACY: the first less the second
  awk '{ printf "%+.1f / %+.1f", $1 - $3, $2 - $4 }' <<<"$*"
}

# answer_row VIEW STREETS...: the network where the map covers, how far maps are above it,
# and what the CRF adds to the calibrated measurements.
answer_row() {
  local view=$1 model row network calibrated
  sequences=("${@:2}") bands=()
  row="$(means x dense network_labels truth "$view")"
  row="| ${row/ / / } |"
  for model in dense calibrated_dense; do
    network=$(means x "$model" network_labels truth "$view")
    row+=" $(over "$(means x "$model" "$view" truth)" "$network") |"
  done
  calibrated=$(means x calibrated_dense "$view" truth)
  row+=" $(over "$calibrated" "$(means x calibrated_dense "measured_$view" truth)") |"
  echo "$row"
}

answer_table() { # VIEW
  local street
  echo "| street | 2D network | map | calibrated | the CRF's part |"
  echo "|---|---:|---:|---:|---:|"
  for street in "${streets[@]}"; do
    echo "| $street $(answer_row "$1" "$street")"
  done | sort -t '|' -k 5,5g # the worst first
  echo "| **pooled** $(answer_row "$1" "${streets[@]}")"
}

mean() { # as scores: the mean of the row
  scores "$@" | awk -F ' *[|] *' '{ print $(NF - 4) }'
}

# sequence_row NAME MODEL PREDICTION COVERED_BY: means of each street, of all together and
# of 15; of the last two also how far above the network's on the same pixels.
sequence_row() {
  local row="| $1 |" sequence group ours
  for sequence in "${streets[@]}"; do
    sequences=("$sequence")
    row+=" $(mean "$1" "$2" "$3" truth "$4") |"
  done
  for group in "${streets[*]}" 15; do
    read -ra sequences <<<"$group"
    ours=$(mean "$1" "$2" "$3" truth "$4")
    row+=" $ours | $(mean "$1" "$2" network_labels truth "$4" |
      awk -v ours="$ours" '{ printf "%+.1f", ours - $1 }') |"
  done
  echo "$row"
}

sequence_table() { # VIEW: labels_at_depth or labels
  local model models=("${compared_models[@]}" "${presets[@]}" "${main_models[@]:2}")
  bands=()
  printf '| | %s' "$(printf '%s | ' "${streets[@]}")"
  printf 'pooled | over network | 15 | over network |\n|---|'
  printf -- '---:|%.0s' "${streets[@]}" 1 2 3 4
  printf '\n'
  sequence_row "2D network, covered" dense network_labels "$1"
  sequence_row "fused, before CRF" dense "measured_$1" "$1"
  for model in "${models[@]}"; do
    sequence_row "${title[$model]}" "$model" "$1" "$1"
  done
}

# Table II: the truth is drawn by hand, and sky counts as in the paper.
pixel_table() { # SEQUENCES...
  local model
  sequences=("$@") bands=() ignored=(--ignore "pedestrian,cyclist")
  scores "" "" image_unary truth_images
  for model in "${image_models[@]}"; do
    scores "${image_title[$model]}" "" "image_$model" truth_images
  done
  ignored=()
}

# The models of every other table, causal and finished.
image_table() { # SEQUENCES...
  sequences=("$@") bands=()
  header truth
  rows "at depth" labels_at_depth measured_labels_at_depth network_labels truth
  rows "rendered" labels measured_labels network_labels truth
  rows "rendered, finished map" final_labels final_measured_labels network_labels truth
}

final_table() { # SEQUENCES...
  sequences=("$@") bands=()
  header truth
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
    all+=(--map "$out/$sequence/dense" --sequence "$kitti/$sequence")
  done
  build/bin/pcl_semantic_evaluate_map "${all[@]}" --header --row "all"
  for sequence in "$@"; do
    build/bin/pcl_semantic_evaluate_map "$out/$sequence/dense" \
      "$kitti/$sequence" --row "$sequence"
  done
}

write_page() {
  cat doc/results_head.md
  printf '\n## At depth\n\n'
  answer_table labels_at_depth
  printf '\n## Rendered\n\n'
  answer_table labels
  printf '\n## Geometry of the finished maps against the lidar\n\n'
  geometry_table "${streets[@]}"
  printf '\n'
  cat "$out/made_page.md"
}

# The tables that one looks up.
write_appendix() {
  local drawn
  read -ra drawn <<<"$(drawn_sequences | xargs)"
  cat doc/results_appendix_head.md
  printf '\n'
  cat "$out/made.md"
  printf '\n## Table I, models: sequences %s pooled, lidar ground truth to 40 m\n\n' "${streets[*]}"
  model_table "${streets[@]}"
  printf '\n## Table I, systems: sequences %s pooled\n\n' "${streets[*]}"
  preset_table "${streets[@]}"
  printf '\n## Table II: CRFs over the pixels of images, sequences %s\n\n' "${drawn[*]}"
  pixel_table "${drawn[@]}"
  printf '\n## Table III: seconds a frame, 1226 x 370 pixels\n\n'
  grep '^|' "$out/times.md"
  printf '\n## Table I, models: sequence 15, hand-made ground truth of frames 0 and 3\n\n'
  model_table 15
  printf '\n## Table I, systems: sequence 15\n\n'
  preset_table 15
  printf '\n## Table I by sequence: mean IoU at depth\n\n'
  sequence_table labels_at_depth
  printf '\n## Table I by sequence: mean IoU rendered\n\n'
  sequence_table labels
  printf '\n## Ablations of the hierarchical model with superpixels\n\n'
  ablation_table "${streets[@]}"
  printf '\n## By distance\n\n'
  band_table "${streets[@]}"
  printf '\n## In 3D: labelled points against their voxels\n\n'
  scan_table "${streets[@]}"
  printf '\n## Finished maps, sequences %s pooled\n\n' "${streets[*]}"
  final_table "${streets[@]}"
  printf '\n## Finished maps, sequence 15\n\n'
  final_table 15
  if [[ "${streets[*]}" == *"05 07"* ]]; then
    printf '\n## Sequences 05 and 07 alone\n\n'
    image_table 05 07
  fi
}
