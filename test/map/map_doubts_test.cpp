// SPDX-License-Identifier: BSD-3-Clause
#include "support/thrown_message.h"

#include <pcl_semantic/map/map_doubts.h>

#include <gtest/gtest.h>

namespace pcl_semantic {

TEST(MapDoubts, LengthsInOtherUnits)
{
  MapParameters parameters;
  EXPECT_TRUE(doubtsOf(parameters).empty());
  parameters.voxel_size = 20.0;
  parameters.max_range = 4000.0;
  const auto doubts = doubtsOf(parameters);
  ASSERT_EQ(doubts.size(), 2u);
  EXPECT_TRUE(holds(doubts[0], "voxel_size is 20 m"));
  EXPECT_TRUE(holds(doubts[1], "max_depth is 4000 m"));
}

} // namespace pcl_semantic
