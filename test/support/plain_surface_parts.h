// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/superpixels/depth_jumps.h>

#include <array>
#include <cmath>
#include <queue>
#include <utility>
#include <vector>

namespace pcl_semantic {

/** \brief Reference for splitAtDepthJumps(): flood fill. */
class PlainSurfaceParts {
public:
  PlainSurfaceParts(const cv::Mat& segments, const CliqueGenerator::Cloud& cloud,
                    const DepthJumps& jumps)
      : segments_(segments), cloud_(cloud), jumps_(jumps),
        numbers_(segments.total(), -1)
  {
    for (int i = 0; i < int(numbers_.size()); ++i)
      if (hasDepth(i) && numbers_[std::size_t(i)] < 0)
        flood(i, count_++);
  }

  const std::vector<int>&
  numbers() const
  {
    return numbers_;
  }

  int
  count() const
  {
    return count_;
  }

private:
  bool
  hasDepth(int i) const
  {
    return std::isfinite(cloud_[std::size_t(i)].z);
  }

  Eigen::Vector3d
  place(int i) const
  {
    return cloud_[std::size_t(i)].getVector3fMap().cast<double>();
  }

  bool
  joined(int i, int j) const
  {
    const Eigen::Vector3d a = place(i), way = place(j) - a;
    if (way.norm() <= jumps_.near)
      return true;
    const Eigen::Vector3d foot = a - way * (a.dot(way) / way.squaredNorm());
    return foot.norm() >= jumps_.passing_distance;
  }

  // The next pixel with depth in a direction, within the segment; -1 = none.
  int
  neighbour(int i, int du, int dv) const
  {
    const int segment = segments_.at<int>(i / segments_.cols, i % segments_.cols);
    for (int u = i % segments_.cols + du, v = i / segments_.cols + dv;
         u >= 0 && v >= 0 && u < segments_.cols && v < segments_.rows &&
         segments_.at<int>(v, u) == segment;
         u += du, v += dv)
      if (hasDepth(v * segments_.cols + u))
        return v * segments_.cols + u;
    return -1;
  }

  void
  flood(int start, int number)
  {
    std::queue<int> open({start});
    numbers_[std::size_t(start)] = number;
    for (; !open.empty(); open.pop())
      for (const auto& [du, dv] : {std::pair(1, 0), {-1, 0}, {0, 1}, {0, -1}}) {
        const int other = neighbour(open.front(), du, dv);
        if (other < 0 || numbers_[std::size_t(other)] >= 0 ||
            !joined(open.front(), other))
          continue;
        numbers_[std::size_t(other)] = number;
        open.push(other);
      }
  }

  const cv::Mat& segments_;
  const CliqueGenerator::Cloud& cloud_;
  DepthJumps jumps_;
  std::vector<int> numbers_;
  int count_ = 0;
};

} // namespace pcl_semantic
