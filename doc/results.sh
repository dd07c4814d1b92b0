#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
#
# Maps KITTI sequences with and without CRF, evaluates them, and writes doc/results.md.
# Called by ./dev results; PCL_SEMANTIC_DATA holds kitti/{15,00,03,05,07,09} and nets/.
set -euo pipefail
cd "$(dirname "$(realpath "${BASH_SOURCE[0]}")")/.."
[[ -n ${PCL_SEMANTIC_DATA:-} ]] ||
  { echo "results: set PCL_SEMANTIC_DATA to the folder of real data" >&2; exit 2; }

kitti=$PCL_SEMANTIC_DATA/kitti
label_set=data/label_sets/kitti11.yaml
network=data/networks/espnetv2_city_1280x480.yaml
model=$PCL_SEMANTIC_DATA/nets/espnetv2_s2.0_city_1280x480_halfres.onnx
streets=(00 03 05 07 09)
out=build/results
mkdir -p "$out"

map_sequence() { # SEQUENCE MODEL
  echo "== sequence $1, CRF: $2"
  build/bin/pcl_semantic_map "$kitti/$1" --network "$network" --model "$model" \
    --crf "$2" --output "$out/$1/$2" >/dev/null
}

# row NAME MODEL IMAGES COVERED_BY SEQUENCES...: a row of a table, pooled.
row() {
  local name=$1 crf=$2 images=$3 covered=$4 sequence arguments=()
  for sequence in "${@:5}"; do
    arguments+=(--prediction "$out/$sequence/$crf/$images" --truth "$out/$sequence/truth")
    [[ $covered == - ]] || arguments+=(--covered-by "$out/$sequence/$crf/$covered")
  done
  build/bin/pcl_semantic_evaluate --label-set "$label_set" --row "$name" "${arguments[@]}"
}

table() { # SEQUENCES...
  build/bin/pcl_semantic_evaluate --label-set "$label_set" --header \
    --row header --prediction "$out/$1/dense/labels" --truth "$out/$1/truth" | head -n 2
  row "at depth: 2D network, covered pixels" dense network_labels labels_at_depth "$@"
  row "at depth: fused, before CRF" none labels_at_depth - "$@"
  row "at depth: after dense CRF" dense labels_at_depth - "$@"
  row "rendered: 2D network, covered pixels" dense network_labels labels "$@"
  row "rendered: fused, before CRF" none labels - "$@"
  row "rendered: after dense CRF" dense labels - "$@"
  row "rendered from the finished map: fused" none final_labels - "$@"
  row "rendered from the finished map: after dense CRF" dense final_labels - "$@"
}

times() { # SEQUENCES...: median seconds of each stage, over the sequences' medians
  local sequence
  for sequence in "$@"; do
    sed -n '/"seconds"/,/^  }/p' "$out/$sequence/dense/summary.json" |
      awk '/": \{/ { gsub(/[" :{]/, ""); stage = $0 }
           /"median"/ { gsub(/[",]/, ""); if (stage != "seconds") print stage, $2 }'
  done | sort -k1,1 -k2,2g | awk '
    function flush() { if (n) printf "| %s | %.3f |\n", stage, values[int((n + 1) / 2)] }
    $1 != stage { flush(); stage = $1; n = 0 }
    { values[++n] = $2 }
    END { flush() }'
}

pictures() { # SEQUENCES...: maps, changes and sheets of each; they stay untracked
  local sequence
  for sequence in "$@"; do
    echo "== pictures of sequence $sequence"
    doc/pictures.sh "$out/$sequence/dense" "$out/$sequence/none" \
      "$kitti/$sequence/image_2" "$out/$sequence/truth" "$out/$sequence/pictures"
  done
}

for sequence in 15 "${streets[@]}"; do
  mkdir -p "$out/$sequence"
  map_sequence "$sequence" none
  map_sequence "$sequence" dense
  if [[ -d $kitti/$sequence/labels ]]; then
    rm -rf "${out:?}/$sequence/truth"
    build/bin/pcl_semantic_lidar_truth "$kitti/$sequence" --output "$out/$sequence/truth" \
      --label-set "$label_set" \
      --label-mapping data/label_mappings/semantic_kitti_to_kitti11.yaml >/dev/null
  else
    ln -sfn "$kitti/$sequence/gt" "$out/$sequence/truth"
  fi
done

{
  cat doc/results_head.md
  printf '\nMade on %s, %s x %s, with the defaults of that day.\n' "$(date +%Y-%m-%d)" \
    "$(nproc)" "$(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -n 1)"
  printf '\n## Sequences 00, 03, 05, 07, 09 pooled: lidar truth to 40 m\n\n'
  table "${streets[@]}"
  printf '\n## Sequences 05 and 07 alone\n\n'
  table 05 07
  printf '\n## Sequence 15: hand-made truth of frames 0 and 3\n\n'
  table 15
  printf '\n## Seconds a frame, 1241 x 376 pixels\n\n| stage | median |\n|---|---:|\n'
  times "${streets[@]}"
} >"$out/results.md"
cp "$out/results.md" doc/results.md
echo "tables:   doc/results.md"
pictures 15 "${streets[@]}"
echo "pictures: $out/SEQUENCE/pictures and $out/SEQUENCE/dense/overlay"
