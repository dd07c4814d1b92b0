// SPDX-License-Identifier: BSD-3-Clause
#include "support/brute_force_crf.h"

#include <pcl_semantic/filters/changed_region.h>

#include <gtest/gtest.h>

#include <algorithm>

namespace {

using namespace pcl_semantic;

float
nearest(const Eigen::Vector3f& point, const Eigen::Matrix3Xf& others)
{
  return others.cols() > 0 ? (others.colwise() - point).colwise().norm().minCoeff()
                           : INFINITY;
}

TEST(ChangedRegion, HoldsWhatAChangeReachesAndNotMuchMore)
{
  const Eigen::Index count = 3000;
  const Eigen::Matrix3Xf positions = makeRandomMatrix(3, count, -4.0f, 4.0f, 1);
  std::vector<std::uint8_t> changed(std::size_t(count), 0);
  Eigen::Matrix3Xf causes(3, 3);
  causes.col(0) = positions.col(5);
  causes.col(1) = positions.col(77);
  causes.col(2) << 3.9f, -3.9f, 0.0f; // a point that is gone
  changed[5] = changed[77] = 1;
  const float radius = 0.4f;
  const ChangedRegion region =
      findChangedRegion(positions, changed, causes.rightCols(1), radius);
  ASSERT_TRUE(std::is_sorted(region.points.begin(), region.points.end()));
  std::vector<int> level(std::size_t(count), 3); // 0 fresh, 1 result, 2 needed, 3 not
  for (std::size_t k = 0; k < region.points.size(); ++k)
    level[std::size_t(region.points[k])] = region.fresh[k]    ? 0
                                           : region.result[k] ? 1
                                                              : 2;
  for (Eigen::Index i = 0; i < count; ++i) {
    const float distance = nearest(positions.col(i), causes);
    for (int k = 0; k < 3; ++k) {
      EXPECT_TRUE(distance > float(k + 1) * radius || level[std::size_t(i)] <= k)
          << "point " << i << " at " << distance;
      // Blocks are cubes: their corners lie farther away.
      EXPECT_TRUE(distance < float(k + 3) * radius * std::sqrt(3.0f) ||
                  level[std::size_t(i)] > k)
          << "point " << i << " at " << distance;
    }
  }
}

TEST(ChangedRegion, IsEmptyWithoutAChangeAndAllIfBlocksWouldBeTooMany)
{
  Eigen::Matrix3Xf positions = makeRandomMatrix(3, 100, 0.0f, 1.0f, 2);
  std::vector<std::uint8_t> changed(100, 0);
  EXPECT_TRUE(findChangedRegion(positions, changed, {}, 0.4f).points.empty());
  EXPECT_TRUE(findChangedRegion(Eigen::Matrix3Xf(3, 0), {}, {}, 0.4f).points.empty());
  positions.col(3) << 1e5f, 1e5f, 1e5f;
  changed[0] = 1;
  EXPECT_EQ(findChangedRegion(positions, changed, {}, 0.4f).points.size(), 100u);
}

} // namespace
