#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
#
# Maps sequences with every combination of some options and prints the mean IoU of the map's
# labels for each sequence, one combination a line:
#
#   doc/grid.sh OUTPUT LABELS TRUTH '--smoothness-weight 1 3 6' '--crf none dense' -- SEQUENCE...
#
# {name} in LABELS and TRUTH stands for the last part of a sequence's path, {sequence} for all
# of it. A run whose map is already in OUTPUT is not made again.
set -euo pipefail
bin=${BIN:-build/bin}
fail() {
  echo "grid.sh: $*" >&2
  exit 2
}
((${#} >= 5)) || fail "expected OUTPUT LABELS TRUTH 'OPTION VALUE...'... -- SEQUENCE..."
output=$1 labels=$2 truth=$3
shift 3

combinations=("")
while (($#)) && [[ $1 != -- ]]; do
  read -ra words <<<"$1"
  ((${#words[@]} > 1)) || fail "'$1' names no values"
  longer=()
  for combination in "${combinations[@]}"; do
    for value in "${words[@]:1}"; do
      longer+=("$combination ${words[0]} $value")
    done
  done
  combinations=("${longer[@]}")
  shift
done
(($# > 1)) || fail "no sequence is given after --"
sequences=("${@:2}")

# filled PATTERN SEQUENCE
filled() {
  local text=${1//"{name}"/"$(basename "$2")"}
  printf '%s' "${text//"{sequence}"/"$2"}"
}

# The exclusive IoU of the classes' mean, in percent.
mean_iou() {
  "$bin/pcl_semantic_evaluate" --quiet --prediction "$1/labels" --truth "$2" \
    --output "$1/evaluation" | awk '$1 == "mean" { print $2 }'
}

printf '%s\t' "${sequences[@]##*/}"
echo "options"
for combination in "${combinations[@]}"; do
  read -ra options <<<"$combination"
  for sequence in "${sequences[@]}"; do
    map="$output/${combination// /_}/$(basename "$sequence")"
    [[ -f $map/map.pcd ]] ||
      "$bin/pcl_semantic_map" "$sequence" --quiet --labels "$(filled "$labels" "$sequence")" \
        --output "$map" "${options[@]}" >&2
    printf '%s\t' "$(mean_iou "$map" "$(filled "$truth" "$sequence")")"
  done
  echo "$combination"
done
