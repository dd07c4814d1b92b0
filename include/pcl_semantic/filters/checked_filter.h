// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/abi_check.h>
#include <pcl_semantic/core/export.h>

#include <pcl/PCLPointCloud2.h>
#include <pcl/filters/filter.h>
#include <pcl/point_cloud.h>
#include <pcl/types.h>

#include <cstddef>
#include <memory>
#include <numeric>
#include <type_traits>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief A pcl::Filter that throws std::bad_alloc if memory for the indices of all
 * points is insufficient. PCL prints a line and returns an empty cloud (1.15) or an
 * unfiltered one (1.13). */
template <typename PointT> class CheckedFilter : public pcl::Filter<PointT> {
public:
  using PointCloud = std::conditional_t<std::is_same_v<PointT, pcl::PCLPointCloud2>,
                                        PointT, pcl::PointCloud<PointT>>;

  /** \brief As pcl::Filter::filter().
   * \throws std::bad_alloc if memory for the points is insufficient */
  void
  filter(PointCloud& output)
  {
    if (this->input_ && (!this->indices_ || this->fake_indices_))
      indexAll(pointsOf(*this->input_));
    pcl::Filter<PointT>::filter(output);
  }

private:
  // As in PCL: the last cloud's indices are reused if the number of points is equal.
  void
  indexAll(std::size_t points)
  {
    if (this->indices_ && this->indices_->size() == points)
      return;
    const auto all = std::make_shared<pcl::Indices>(points);
    std::iota(all->begin(), all->end(), 0);
    this->indices_ = all;
    this->fake_indices_ = true;
  }

  static std::size_t
  pointsOf(const PointCloud& cloud)
  {
    if constexpr (std::is_same_v<PointT, pcl::PCLPointCloud2>) {
      // The header may state any size; applyFilter() refuses a cloud with less data.
      const std::size_t points = std::size_t(cloud.width) * cloud.height;
      return points <= cloud.data.size() ? points : 0;
    }
    else
      return cloud.size();
  }
};

} // namespace pcl_semantic
