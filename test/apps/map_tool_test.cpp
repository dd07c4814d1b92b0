/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "support/run_tool.h"

#include <gtest/gtest.h>

namespace {

using namespace pcl_semantic;

TEST(MapTool, HelpAndUsage)
{
  const ToolResult help = runTool("map --help");
  EXPECT_EQ(help.code, 0);
  EXPECT_NE(help.text.find("--voxel-size"), std::string::npos);
  EXPECT_EQ(runTool("map").code, 2);
}

} // namespace
