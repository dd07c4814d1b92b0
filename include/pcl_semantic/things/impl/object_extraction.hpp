// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/no_return.h>
#include <pcl_semantic/things/impl/used_indices.hpp>
#include <pcl_semantic/things/object_extraction.h>

#include <string>
#include <utility>

namespace pcl_semantic {

template <typename PointT>
void
ObjectExtraction<PointT>::extract(std::vector<pcl::PointIndices>& objects)
{
  objects.clear();
  if (!this->initCompute())
    throw InvalidParameterException("ObjectExtraction: no input cloud");
  const pcl::Indices indices =
      usedIndices("ObjectExtraction", *indices_, input_->size());
  this->deinitCompute();
  const PlaceTest has_place(*input_);
  std::vector<Point> points;
  for (const pcl::index_t i : indices) {
    const PointT& point = (*input_)[std::size_t(i)];
    if (point.label > 255)
      throw InvalidParameterException("ObjectExtraction: point " + std::to_string(i) +
                                      " has label " + std::to_string(point.label) +
                                      ", expected 0 to 255");
    if (isThing(Label(point.label)) && has_place(point))
      points.push_back(
          {point.getVector3fMap().template cast<double>(), Label(point.label), i});
  }
  objects = group(std::move(points));
  for (pcl::PointIndices& object : objects)
    object.header = input_->header;
}

} // namespace pcl_semantic
