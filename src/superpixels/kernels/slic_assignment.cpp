// SPDX-License-Identifier: BSD-3-Clause
#include "slic_assignment.h"
#include "core/simd_choice.h"

#define HWY_TARGET_INCLUDE "superpixels/kernels/slic_assignment.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace pcl_semantic::HWY_NAMESPACE {

namespace {

// Vectorised by compilers: no branch, and no fused products, so that every tier gives
// identical bits.
void
assign(const SlicRow& row, const SlicCentre& centre, int label, int first, int end,
       float spatial_weight)
{
  const float* HWY_RESTRICT const l = row.lab[0];
  const float* HWY_RESTRICT const a = row.lab[1];
  const float* HWY_RESTRICT const b = row.lab[2];
  float* HWY_RESTRICT const distances = row.distances;
  int* HWY_RESTRICT const labels = row.labels;
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

} // namespace

} // namespace pcl_semantic::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_semantic {

AssignSlicRow
slicAssignment(SimdTier tier)
{
  return PCL_SEMANTIC_OF_TIER(tier, assign);
}

} // namespace pcl_semantic
#endif
