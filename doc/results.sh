#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
#
# Maps KITTI sequences with several models, evaluates them, and writes doc/results.md.
# Called by ./dev results; PCL_SEMANTIC_DATA holds kitti/{15,00,01,03,05,06,07,09} and nets/.
# Labels of the network are computed once and kept in build/results. To try a change:
# STREETS="00 05 07" ./dev results takes these alone, three or more, and leaves
# doc/results.md as it is. ./dev results page maps what the first page needs, a
# tenth of it all, and writes that; ./dev results tables writes all pages and the pictures of
# what an earlier run has mapped.
# What is mapped is in doc/results_models.sh, what is said of it in doc/results_tables.sh.
set -euo pipefail
cd "$(dirname "$(realpath "${BASH_SOURCE[0]}")")/.."
[[ -n ${PCL_SEMANTIC_DATA:-} ]] ||
  { echo "results: set PCL_SEMANTIC_DATA to the folder of real data" >&2; exit 2; }

kitti=$PCL_SEMANTIC_DATA/kitti
label_set=data/label_sets/kitti11.yaml
network=data/networks/espnetv2_city_1280x480.yaml
model_file=$PCL_SEMANTIC_DATA/nets/espnetv2_s2.0_city_1280x480_halfres.onnx
read -ra streets <<<"${STREETS:-00 01 03 05 06 07 09}" # with lidar
# A street's calibrations come from the others, and the labels of each of these again.
((${#streets[@]} >= 3)) ||
  { echo "results: STREETS are ${streets[*]}, expected three or more" >&2; exit 2; }
out=build/results
# shellcheck source=doc/results_models.sh
source doc/results_models.sh
# shellcheck source=doc/results_tables.sh
source doc/results_tables.sh

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
  local also=() calibration=$out/calibration/without_$1.yaml
  if [[ " ${main_models[*]} " == *" $2 "* ]]; then
    also=(--also measured)
    [[ ! -d $kitti/$1/velodyne ]] || also=(--also "measured,scans" --scan-within 0.3)
  fi
  [[ -f $calibration ]] || calibration=$out/calibration/calibration.yaml
  local words=${options[$2]//\{calibration\}/$calibration}
  say "sequence $1: $2"
  # shellcheck disable=SC2086 # the options of a model are words
  build/bin/pcl_semantic_map "$kitti/$1" --labels "$out/$1/network_distributions" \
    "${also[@]}" ${words//\{cliques\}/$out/$1/cliques/calibration.yaml} \
    --output "$out/$1/$2" >/dev/null
}

learn() { # OUTPUT SEQUENCES OPTIONS...
  local output=$1 learned_from
  read -ra learned_from <<<"$2"
  build/bin/pcl_semantic_calibrate "${learned_from[@]/#/$kitti/}" \
    --label-set "$label_set" --labels "$out/{name}/network_distributions" \
    --truth "$out/{name}/truth" --output "$output" "${@:3}" >&2
}

# Of cliques, for a sequence, from the others alone: the labels of each of these are
# calibrated by the rest of them.
learn_cliques() { # SEQUENCE
  local others=${streets[*]/#$1/}
  say "calibration of cliques for sequence $1"
  learn "$out/$1/cliques/labels" "$others"
  learn "$out/$1/cliques" "$others" \
    --clique-config data/presets/calibrated_cliques.yaml \
    --label-calibration "$out/$1/cliques/labels/without_{name}.yaml"
}

# Table II: the classes of the images that have hand-made truth.
refine_images() { # SEQUENCE MODEL
  local image frame stored
  mkdir -p "$out/$1/image_$2"
  for image in "$kitti/$1"/gt/*.png; do
    frame=$(basename "$image" .png)
    stored=("$out/$1/network_distributions/$frame".*)
    # shellcheck disable=SC2086
    build/bin/pcl_semantic_image_crf "$kitti/$1/image_2/$frame.png" "${stored[0]}" \
      "$out/$1/image_$2/$frame.png" ${image_options[$2]} >/dev/null
  done
}

# truth, truth_scan (point by point), and the depth of both; or the hand-made images,
# which are truth_images where a street has both.
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
  [[ ! -d $kitti/$1/gt ]] || ln -sfn "$(realpath "$kitti/$1/gt")" "$out/$1/truth_images"
}

drawn_sequences() { # with hand-made truth
  local sequence
  for sequence in 15 "${streets[@]}"; do
    [[ ! -d $out/$sequence/truth_images ]] || echo "$sequence"
  done
}

pictures() { # SEQUENCES...: maps, changes and sheets of each; they stay untracked
  local sequence
  for sequence in "$@"; do
    echo "== pictures of sequence $sequence"
    doc/pictures.sh "$out/$sequence/calibrated_cliques" "$out/$sequence/none" \
      "$kitti/$sequence/image_2" "$out/$sequence/truth" "$out/$sequence/pictures"
  done
}

map_models() { # SEQUENCES MODELS...
  local sequences sequence model
  read -ra sequences <<<"$1"
  for sequence in "${sequences[@]}"; do
    mkdir -p "$out/$sequence"
    label_sequence "$sequence"
    make_truth "$sequence"
  done
  say "calibration of the network"
  learn "$out/calibration" "${streets[*]}"
  if [[ " ${*:2} " == *" calibrated_cliques "* ]]; then
    for sequence in "${sequences[@]}"; do
      learn_cliques "$sequence"
    done
  fi
  for sequence in "${sequences[@]}"; do
    for model in "${@:2}"; do
      map_sequence "$sequence" "$model"
    done
  done
}

say_made() { # LOAD FILE
  printf 'Made on %s, %s x %s (load at the beginning %s), with the defaults of that day.\n' \
    "$(date +%Y-%m-%d)" "$(nproc)" \
    "$(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -n 1)" "$1" >"$out/$2.md"
}

map_everything() {
  local sequence model
  map_models "15 ${streets[*]}" none "${all_models[@]}" # none: for the pictures
  for sequence in $(drawn_sequences); do
    for model in "${image_models[@]}"; do
      refine_images "$sequence" "$model"
    done
  done
  say "times, with the network"
  build/bench/bench_frame >"$out/times.md"
}

load=$(cut -d' ' -f1 /proc/loadavg) # of other programs: the times suffer from it
case ${1:-} in
  "") map_everything; say_made "$load" made; cp "$out/made.md" "$out/made_page.md" ;;
  page)
    map_models "${streets[*]}" dense calibrated_dense
    say_made "$load" made_page
    write_page >"$out/results.md"
    [[ -n ${STREETS:-} ]] || cp "$out/results.md" doc
    exit ;;
  tables) [[ -s $out/made.md ]] || { echo "results: no earlier run has ended" >&2; exit 2; } ;;
  *) echo "results: '$1', expected nothing, page or tables" >&2; exit 2 ;;
esac
say "tables"
write_page >"$out/results.md"
write_appendix >"$out/results_appendix.md"
[[ -n ${STREETS:-} ]] || cp "$out"/results{,_appendix}.md doc
echo "tables:   $out/results.md"
pictures 15 "${streets[@]}"
echo "pictures: $out/SEQUENCE/pictures and $out/SEQUENCE/MODEL/overlay"
