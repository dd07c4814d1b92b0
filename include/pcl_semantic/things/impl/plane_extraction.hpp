// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/no_return.h>
#include <pcl_semantic/things/plane_extraction.h>

#include <algorithm>
#include <string>

namespace pcl_semantic {

template <typename PointT>
std::vector<ExtractedPlane>
PlaneExtraction<PointT>::extract()
{
  if (!this->initCompute())
    throw InvalidParameterException("PlaneExtraction: no input cloud");
  pcl::Indices indices(*indices_);
  this->deinitCompute();
  std::sort(indices.begin(), indices.end());
  indices.erase(std::unique(indices.begin(), indices.end()), indices.end());
  const PlaceTest has_place(*input_);
  std::vector<Eigen::Vector3d> points;
  pcl::Indices used;
  for (const pcl::index_t i : indices) {
    if (i < 0 || std::size_t(i) >= input_->size())
      throw InvalidParameterException("PlaneExtraction: index " + std::to_string(i) +
                                      " is out of range");
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
