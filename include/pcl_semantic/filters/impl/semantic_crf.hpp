/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#pragma once

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/filters/semantic_crf.h>

#include <pcl/common/point_tests.h>
#include <pcl/type_traits.h>

// PCL instantiates its base classes for its own point types only.
#include <pcl/filters/impl/filter.hpp>
#include <pcl/impl/pcl_base.hpp>

namespace pcl_semantic {

template <typename PointT>
void
SemanticCRF<PointT>::applyFilter(PointCloud& output)
{
  static_assert(pcl::traits::has_xyz<PointT>::value &&
                    pcl::traits::has_label<PointT>::value,
                "SemanticCRF needs a point type with x, y, z and label");
  const PointCloud& input = *this->input_;
  if (std::size_t(input_distributions_.size()) != input.size())
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "SemanticCRF has label distributions of "
                            << input_distributions_.size() << " points for a cloud of "
                            << input.size());
  output = input;
  output_distributions_ = input_distributions_;
  pcl::Indices points;
  for (const pcl::index_t index : *this->indices_)
    if (pcl::isXYZFinite(input[index]))
      points.push_back(index);
    else
      output[index].label = kUnlabelled;
  skipped_points_ = this->indices_->size() - points.size();
  if (points.empty())
    return;

  const auto count = static_cast<Eigen::Index>(points.size());
  Eigen::Matrix3Xf positions(3, count);
  Eigen::MatrixXf colours;
  LabelDistributions measured(input_distributions_.classes(), count);
  // Differences from a nearby point keep single precision wherever the cloud lies.
  const Eigen::Vector3f centre = input[points.front()].getVector3fMap();
  if constexpr (pcl::traits::has_color<PointT>::value)
    colours.resize(3, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const PointT& point = input[points[i]];
    positions.col(i) = point.getVector3fMap() - centre;
    measured.matrix().col(i) = input_distributions_.matrix().col(points[i]);
    if constexpr (pcl::traits::has_color<PointT>::value)
      colours.col(i) << float(point.r), float(point.g), float(point.b);
  }
  const LabelDistributions refined =
      refineLabels(positions, colours, measured, parameters_);
  for (Eigen::Index i = 0; i < count; ++i) {
    output_distributions_.matrix().col(points[i]) = refined.matrix().col(i);
    output[points[i]].label = refined.mapLabel(i);
  }
}

} // namespace pcl_semantic
