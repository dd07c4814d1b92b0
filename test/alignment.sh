#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
#
# Headers refuse a program whose flags have Eigen align in another way than in PCL and
# the library. Only preprocesses and parses: alignment.sh COMPILER INCLUDE_FOLDER...
set -euo pipefail
compiler=$1
shift
[[ $("$compiler" -dumpmachine) == x86_64* ]] || exit 77 # nothing changes the alignment
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
mkdir -p "$scratch/pcl_semantic/core"
failures=0

# A library for ALIGNMENT and a program with FLAGS: taken | refused ALIGNMENT [FLAGS]
check() {
  local expected=$1 alignment=$2 found=taken
  echo "#define PCL_SEMANTIC_ALIGNMENT $alignment" >"$scratch/pcl_semantic/core/alignment.h"
  "$compiler" -std=c++17 -fsyntax-only "${@:3}" -I "$scratch" "${folders[@]}" \
    -x c++ "$scratch/program" >/dev/null 2>"$scratch/message" || found=refused
  if [[ $found != "$expected" ]] ||
    { [[ $found == refused ]] && ! grep -q "pcl_semantic: " "$scratch/message"; }; then
    echo "library for $alignment bytes, program with '${*:3}': $found, expected $expected"
    cat "$scratch/message"
    failures=$((failures + 1))
  fi
}

folders=()
for folder in "$@"; do
  folders+=(-isystem "$folder")
done
echo "#include <pcl_semantic/core/export.h>" >"$scratch/program"
check taken 16
check refused 16 -mavx
check refused 16 -mavx512f
check taken 16 -mavx2 -DPCL_SEMANTIC_ALLOW_AVX
check taken 32 -mavx2
check refused 32
check refused 32 -mavx512f
check taken 64 -mavx512f
check refused 64 -mavx2

# What Eigen makes of the flags, and of its macros.
echo "#include <pcl_semantic/core/abi_check.h>" >"$scratch/program"
check refused 16 -DEIGEN_MAX_ALIGN_BYTES=32
check taken 32 -mavx2
check taken 64 -mavx512f -mfma
((failures == 0))
