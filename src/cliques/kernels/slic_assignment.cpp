/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "slic_assignment.h"

namespace pcl_semantic {

namespace {

// Written without a branch and without fused products, so that compilers vectorise it
// and every tier gives the same bits.
inline __attribute__((always_inline)) void
assign(const SlicRow& row, const SlicCentre& centre, int label, int first, int end,
       float spatial_weight)
{
  const float* __restrict const l = row.lab[0];
  const float* __restrict const a = row.lab[1];
  const float* __restrict const b = row.lab[2];
  float* __restrict const distances = row.distances;
  int* __restrict const labels = row.labels;
  const float dy = row.y - centre.y;
  const float row_distance = spatial_weight * (dy * dy);
  for (int x = first; x < end; ++x) {
    const float dl = l[x] - centre.l;
    const float da = a[x] - centre.a;
    const float db = b[x] - centre.b;
    const float dx = float(x) - centre.x;
    const float distance =
        dl * dl + da * da + db * db + (row_distance + spatial_weight * (dx * dx));
    const bool nearer = distance < distances[x];
    distances[x] = nearer ? distance : distances[x];
    labels[x] = nearer ? label : labels[x];
  }
}

void
assignPlain(const SlicRow& row, const SlicCentre& centre, int label, int first, int end,
            float spatial_weight)
{
  assign(row, centre, label, first, end, spatial_weight);
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) void
assignAvx2(const SlicRow& row, const SlicCentre& centre, int label, int first, int end,
           float spatial_weight)
{
  assign(row, centre, label, first, end, spatial_weight);
}

__attribute__((
    target("avx512f,avx512bw,avx512dq,avx512vl,prefer-vector-width=512"))) void
assignAvx512(const SlicRow& row, const SlicCentre& centre, int label, int first,
             int end, float spatial_weight)
{
  assign(row, centre, label, first, end, spatial_weight);
}
#endif

} // namespace

AssignSlicRow
slicAssignment(SimdTier tier)
{
#if defined(__x86_64__)
  if (tier == SimdTier::avx512)
    return assignAvx512;
  if (tier == SimdTier::avx2)
    return assignAvx2;
#endif
  static_cast<void>(tier);
  return assignPlain;
}

} // namespace pcl_semantic
