// SPDX-License-Identifier: BSD-3-Clause
#include "support/run_tool.h"
#include "support/temporary_folder.h"

#include <pcl_semantic/files/cloud_file.h>

#include <gtest/gtest.h>

#include <random>
#include <sstream>

namespace {

using namespace pcl_semantic;

// A rough floor of 2,000 points with two labels, most of them right.
std::string
makeFloor()
{
  std::mt19937 random(1);
  std::ostringstream rows;
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 50; ++x)
      rows << 0.1 * x << " " << 0.1 * y << " " << 0.1 * double(random() % 2) << " "
           << (random() % 4 == 0 ? 1 + random() % 2 : 1 + x / 25) << "\n";
  return "VERSION 0.7\nFIELDS x y z label\nSIZE 4 4 4 4\nTYPE F F F U\n"
         "COUNT 1 1 1 1\nWIDTH 2000\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\n"
         "POINTS 2000\nDATA ascii\n" +
         rows.str();
}

TEST(SimdTiers, AllGiveTheSameBits)
{
  const TemporaryFolder folder;
  const std::string input = folder.write("floor.pcd", makeFloor());
  std::vector<LabelledCloud> results;
  for (const std::string tier : {"plain", "avx2", "avx512", ""}) {
    const std::string output = folder.path("tier_" + tier + ".pcd");
    succeed("crf " + input + " " + output + " --crf-iterations 5",
            "PCL_SEMANTIC_SIMD=" + tier);
    results.push_back(readLabelledCloud(output));
  }
  std::size_t right = 0;
  for (std::size_t i = 0; i < 2000; ++i) {
    for (const LabelledCloud& result : results) {
      const auto difference = result.distributions.matrix().col(Eigen::Index(i)) -
                              results[0].distributions.matrix().col(Eigen::Index(i));
      EXPECT_EQ(difference.cwiseAbs().maxCoeff(), 0.0f) << "point " << i;
    }
    right += (*results[0].cloud)[i].label == 1 + i % 50 / 25;
  }
  EXPECT_GT(right, 1900u);
}

TEST(SimdTiers, AnUnknownOneIsRefused)
{
  const TemporaryFolder folder;
  const std::string input = folder.write("floor.pcd", makeFloor());
  const ToolResult run =
      runTool("crf " + input + " " + folder.path("out.pcd"), "PCL_SEMANTIC_SIMD=sse9");
  EXPECT_EQ(run.code, 2);
  EXPECT_EQ(run.text, "pcl_semantic_crf: PCL_SEMANTIC_SIMD is 'sse9', expected plain, "
                      "neon, avx2 or avx512\n");
}

} // namespace
