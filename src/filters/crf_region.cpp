// SPDX-License-Identifier: BSD-3-Clause
#include "crf_region.h"

#include "element_crf.h"

#include <pcl_semantic/core/voxel_index.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

namespace pcl_semantic {

namespace {

// One mark per block of the bounding box of the voxels.
class BlockMarks {
public:
  explicit BlockMarks(const std::vector<VoxelIndex>& voxels)
  {
    low_ = blockOf(voxels.front());
    VoxelIndex high = low_;
    for (const VoxelIndex& voxel : voxels) {
      low_ = low_.cwiseMin(blockOf(voxel));
      high = high.cwiseMax(blockOf(voxel));
    }
    size_ = high - low_ + VoxelIndex::Ones();
    marks_.resize(std::size_t(size_.x()) * std::size_t(size_.y()) *
                  std::size_t(size_.z()));
  }

  std::uint8_t&
  at(const VoxelIndex& block)
  {
    return marks_[cellOf(block - low_)];
  }

  // All blocks within some blocks of a marked one, per axis.
  BlockMarks
  dilated(int blocks) const
  {
    BlockMarks result = *this;
    std::size_t step = 1; // between neighbours along the axis
    for (const int length : {size_.x(), size_.y(), size_.z()}) {
      for (std::size_t cell = 0; cell < marks_.size(); ++cell)
        if (cell / step % std::size_t(length) == 0)
          dilateLine(&result.marks_[cell], step, length, blocks);
      step *= std::size_t(length);
    }
    return result;
  }

private:
  std::size_t
  cellOf(const VoxelIndex& cell) const
  {
    return (std::size_t(cell.z()) * std::size_t(size_.y()) + std::size_t(cell.y())) *
               std::size_t(size_.x()) +
           std::size_t(cell.x());
  }

  static void
  dilateLine(std::uint8_t* line, std::size_t step, int length, int blocks)
  {
    std::vector<std::uint8_t> marked;
    for (int k = 0; k < length; ++k)
      marked.push_back(line[std::size_t(k) * step]);
    int next = 0; // everything before it is done
    for (int k = 0; k < length; ++k)
      if (marked[std::size_t(k)])
        for (next = std::max(next, k - blocks); next < length && next <= k + blocks;
             ++next)
          line[std::size_t(next) * step] = 1;
  }

  VoxelIndex low_, size_; // [blocks]
  std::vector<std::uint8_t> marks_;
};

pcl::Indices
voxelsIn(BlockMarks& marks, const std::vector<VoxelIndex>& voxels)
{
  pcl::Indices found;
  for (std::size_t i = 0; i < voxels.size(); ++i)
    if (marks.at(blockOf(voxels[i])))
      found.push_back(pcl::index_t(i));
  return found;
}

} // namespace

double
crfReach(const SemanticCRFParameters& parameters, double voxel_size)
{
  double reach = 0.0;
  for (const bool has_colours : {false, true}) {
    const SemanticCRFParameters values = parameters.resolved(voxel_size, has_colours);
    const double deviation =
        std::max(values.smoothness_deviation, values.appearance_deviation);
    const double radius =
        values.kernel_method == KernelMethod::lattice ? 3.0 : values.radius;
    // One extra step, because messages are normalised by their senders' received
    // messages.
    reach = std::max(reach, (values.iterations + 1) * radius * deviation);
  }
  return reach;
}

int
blocksWithin(double reach, double voxel_size)
{
  return int(std::ceil(std::min(reach / (kBlockEdge * voxel_size) - 1e-9, 1e6)));
}

CrfRegion
crfRegion(const VoxelCloud& voxels, double reach)
{
  CrfRegion region;
  if (voxels.size() == 0)
    return region;
  BlockMarks changed(voxels.indices);
  for (std::size_t i = 0; i < voxels.size(); ++i)
    if (voxels.is_refined.empty() || !voxels.is_refined[i])
      changed.at(blockOf(voxels.indices[i])) = 1;
  const int blocks = blocksWithin(reach, voxels.voxel_size);
  BlockMarks updated = changed.dilated(blocks);
  region.updated = voxelsIn(updated, voxels.indices);
  BlockMarks seen = updated.dilated(blocks);
  region.seen = voxelsIn(seen, voxels.indices);
  return region;
}

void
refineRegion(SemanticCRF<pcl::PointXYZRGBL>& crf, const LabelSet& label_set,
             const CrfRegion& region, VoxelCloud& voxels)
{
  const bool has_colours = hasColour(voxels);
  crf.setUseColour(has_colours);
  if (crf.getParameters().resolved(voxels.voxel_size, has_colours).logit_adjustment >
      0.0) {
    pcl::Indices all(voxels.size());
    std::iota(all.begin(), all.end(), 0);
    crf.setClassFrequencies(classFrequencies(all, voxels.measured));
  }
  crf.setThinLabels(label_set.thinLabels());
  crf.setVoxels(voxels.indices, voxels.voxel_size);
  crf.setInputCloud(voxels.cloud);
  crf.setIndices(pcl::make_shared<pcl::Indices>(region.seen));
  crf.setLabelDistributions(voxels.measured);
  pcl::PointCloud<pcl::PointXYZRGBL> refined;
  crf.filter(refined);
#pragma omp parallel for schedule(static)
  for (std::size_t k = 0; k < region.updated.size(); ++k) {
    const pcl::index_t i = region.updated[k];
    voxels.refined.matrix().col(i) = crf.getLabelDistributions().matrix().col(i);
    (*voxels.cloud)[std::size_t(i)].label = refined[std::size_t(i)].label;
  }
  voxels.is_refined.assign(voxels.size(), 1);
}

} // namespace pcl_semantic
