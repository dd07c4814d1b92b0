// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/filters/checked_filter.h>

#include <pcl/PCLPointCloud2.h>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Keeps one point per voxel of a regular grid, with the majority label of the
 * voxel's points. pcl::VoxelGrid would average labels, and the mean of the classes 1
 * and 3 is not 2.
 *
 * The kept point is the one nearest to the mean of the voxel's points, with all of its
 * fields. Its `probability` (COUNT L) becomes the mean of the voxel's points and its
 * `label` the most probable class. Without probabilities the label is the most frequent
 * one, the smaller one at a tie, and 0 only if no point of the voxel has a label.
 * doc/formats.md lists the accepted names of labels and probabilities. Points that are
 * not finite or more than CloudCRF::max_coordinate away are dropped, and so are two or
 * more points at exactly 0 0 0, the no-returns of a scanner. A repeated index counts
 * once. An empty cloud is returned unchanged. The output is not organized; voxels are
 * ordered by z, y, x. */
class LabelVoxelGrid : public CheckedFilter<pcl::PCLPointCloud2> {
public:
  LabelVoxelGrid() { this->filter_name_ = "LabelVoxelGrid"; }

  /** \param[in] edge of a voxel [m] \throws InvalidParameterException unless positive
   */
  void setLeafSize(double edge);

protected:
  /** \throws InvalidParameterException if no edge was set, the cloud has no `label` or
   * spans more than 2^31 voxels, or an index is out of range
   * \throws BadInputException at an invalid value, or labels in an unknown encoding */
  void applyFilter(pcl::PCLPointCloud2& output) override;

private:
  double edge_ = 0.0;
};

} // namespace pcl_semantic
