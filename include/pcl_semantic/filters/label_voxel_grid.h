// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/filters/checked_filter.h>

#include <pcl/PCLPointCloud2.h>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Keeps one point of each voxel of a regular grid, with the label that the
 * voxel's points agree on: pcl::VoxelGrid would average labels, and the mean of the
 * classes 1 and 3 is not 2.
 *
 * What is kept is the point nearest to the mean of the voxel's points, with all of its
 * fields. Its `probability` (COUNT L) becomes the mean of theirs and its `label` the
 * most probable class; without probabilities the label is the most frequent one, the
 * smaller one if two are, and 0 only if no point of the voxel has a label. Labels and
 * probabilities may be spelled as doc/formats.md says. Dropped are points that are not
 * finite or more than CloudCRF::max_coordinate away, and two or more at exactly
 * 0 0 0, which a scanner gives for no return. An index that comes twice counts once. A
 * cloud of no points is given back as it is. The output is not organized; voxels come
 * by z, y, x. */
class LabelVoxelGrid : public CheckedFilter<pcl::PCLPointCloud2> {
public:
  LabelVoxelGrid() { this->filter_name_ = "LabelVoxelGrid"; }

  /** \param[in] edge of a voxel [m] \throws InvalidParameterException unless positive
   */
  void setLeafSize(double edge);

protected:
  /** \throws InvalidParameterException if no edge was set, the cloud has no `label`, is
   * larger than 2^31 voxels, or an index is beyond it \throws BadInputException at a
   * value that cannot be, or labels that are not understood */
  void applyFilter(pcl::PCLPointCloud2& output) override;

private:
  double edge_ = 0.0;
};

} // namespace pcl_semantic
