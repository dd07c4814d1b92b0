// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/no_return.h>
#include <pcl_semantic/things/impl/used_indices.hpp>
#include <pcl_semantic/things/plane_extraction.h>

#include <utility>
#include <vector>

namespace pcl_semantic {

template <typename PointT>
std::vector<ExtractedPlane>
PlaneExtraction<PointT>::extract()
{
  if (!this->initCompute())
    throw InvalidParameterException("PlaneExtraction: no input cloud");
  const pcl::Indices indices =
      usedIndices("PlaneExtraction", *indices_, input_->size());
  this->deinitCompute();
  const PlaceTest has_place(*input_);
  std::vector<Eigen::Vector3d> points;
  pcl::Indices used;
  for (const pcl::index_t i : indices) {
    const PointT& point = (*input_)[std::size_t(i)];
    if (!has_place(point))
      continue;
    points.push_back(point.getVector3fMap().template cast<double>());
    used.push_back(i);
  }
  return PlaneExtractionBase::extract(points, used);
}

template <typename PointT>
void
PlaneExtraction<PointT>::segment(std::vector<pcl::ModelCoefficients>& coefficients,
                                 std::vector<pcl::PointIndices>& inliers)
{
  coefficients.clear();
  inliers.clear();
  for (ExtractedPlane& plane : extract()) {
    coefficients.emplace_back();
    coefficients.back().header = input_->header;
    coefficients.back().values = {float(plane.normal.x()), float(plane.normal.y()),
                                  float(plane.normal.z()), float(plane.offset)};
    inliers.emplace_back();
    inliers.back().header = input_->header;
    inliers.back().indices = std::move(plane.indices);
  }
}

} // namespace pcl_semantic
