// SPDX-License-Identifier: BSD-3-Clause

// A cloud at the coordinates of a survey (UTM, in double precision) gives the same
// result as the same cloud near the origin.

#include "support/bad_case.h"
#include "support/column_of.h"

#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/files/cloud_file.h>
#include <pcl_semantic/filters/label_voxel_grid.h>
#include <pcl_semantic/filters/semantic_crf.h>

#include <cstring>
#include <random>

namespace pcl_semantic {

namespace {

// Whole numbers of all cells that are laid below [m], the second of 0.1 m alone: not of
// the cubes of supervoxels.
const Eigen::Vector3d far_away(691200.0, 5334400.0, 384.0);
const Eigen::Vector3d elsewhere(691000.0, 5336000.0, 300.0);

// A floor and a wall of two classes, a quarter of whose labels is wrong.
template <typename T>
PcdTable
surfaces(const Eigen::Vector3d& shift)
{
  std::mt19937 random(5);
  const auto uniform = [&](double largest) {
    return double(random()) / 4294967296.0 * largest;
  };
  std::vector<T> x, y, z;
  std::vector<std::uint32_t> labels, colours;
  for (int i = 0; i < 4000; ++i) {
    const bool is_floor = i < 2000;
    const Eigen::Vector3d point(uniform(9.0), is_floor ? uniform(7.0) : 0.011,
                                is_floor ? 0.011 : uniform(3.0));
    x.push_back(T(point.x() + shift.x()));
    y.push_back(T(point.y() + shift.y()));
    z.push_back(T(point.z() + shift.z()));
    labels.push_back((is_floor ? 1 : 2) * (uniform(1.0) < 0.25 ? 3 : 1) % 5);
    colours.push_back(is_floor ? 0x905030 : 0x305090);
  }
  PcdTable table;
  table.width = pcl::uindex_t(x.size());
  table.height = 1;
  table.setColumn("x", x);
  table.setColumn("y", y);
  table.setColumn("z", z);
  table.setColumn("rgba", colours);
  table.setColumn("label", labels);
  return table;
}

} // namespace

TEST(FarClouds, GiveWhatNearOnesGive)
{
  const TemporaryFolder folder;
  writeCloudTable(folder.path("single.pcd"), surfaces<float>(Eigen::Vector3d::Zero()));
  writeCloudTable(folder.path("near.pcd"), surfaces<double>(Eigen::Vector3d::Zero()));
  writeCloudTable(folder.path("far.pcd"), surfaces<double>(far_away));
  writeCloudTable(folder.path("elsewhere.pcd"), surfaces<double>(elsewhere));
  for (const auto& [command, field] : std::vector<std::pair<std::string, std::string>>{
           {"crf IN OUT", "label"},
           {"crf IN OUT --crf hierarchical --cliques cubes:1 --clique-weight 9",
            "label"},
           {"crf IN OUT --crf pn-potts --cliques supervoxel:0.8 --clique-weight 9",
            "label"},
           {"cloud IN OUT --thin 0.4", "label"},
           {"cliques IN OUT --method cubes:0.5", "clique"},
           {"cliques IN OUT --method supervoxel:0.8", "clique"}}) {
    std::vector<PcdTable> results;
    for (const char* const name : {"single", "near", "far", "elsewhere"}) {
      const std::string output = folder.path("out.pcd");
      std::string words = replaceAll(command, "IN", folder.path(name) + ".pcd");
      succeed(replaceAll(words, "OUT", output));
      results.push_back(readCloudTable(output));
    }
    for (const PcdTable& table : results)
      EXPECT_EQ(table.points(), results.back().points()) << command;
    for (const std::size_t other : {0, 1, 3})
      EXPECT_EQ(columnOf(results[other], field), columnOf(results[2], field))
          << command << " " << other;
    const std::vector<double> x = columnOf(results[1], "x"),
                              far_x = columnOf(results[2], "x");
    for (std::size_t i = 0; i < x.size(); ++i)
      ASSERT_NEAR(x[i] + far_away.x(), far_x[i], 1e-8) << command;
  }
}

TEST(FarClouds, KeepWhatIsNoReturn)
{
  const TemporaryFolder folder;
  for (const std::string command :
       {"cloud IN OUT --thin 0.4", "crf IN OUT", "cliques IN OUT --method cubes:0.5"}) {
    std::vector<std::size_t> points;
    for (const Eigen::Vector3d& shift : {Eigen::Vector3d::Zero().eval(), far_away}) {
      PcdTable table = surfaces<double>(shift);
      for (const char* const name : {"x", "y", "z"}) {
        std::vector<double> values = columnOf(table, name);
        std::fill_n(values.begin(), 40, 0.0);
        table.setColumn(name, values);
      }
      writeCloudTable(folder.path("in.pcd"), table);
      std::string words = replaceAll(command, "IN", folder.path("in.pcd"));
      words = replaceAll(words, "OUT", folder.path("out.pcd"));
      EXPECT_TRUE(holds(succeed(words), "40 ")) << command;
      points.push_back(readCloudTable(folder.path("out.pcd")).points());
    }
    EXPECT_EQ(points[0], points[1]) << command;
  }
}

TEST(FarClouds, AreCroppedWhereTheyAre)
{
  const TemporaryFolder folder;
  std::vector<std::size_t> counts;
  for (const Eigen::Vector3d& shift : {Eigen::Vector3d::Zero().eval(), far_away}) {
    const std::string input = folder.path("in.pcd"), output = folder.path("out.pcd");
    writeCloudTable(input, surfaces<double>(shift));
    std::ostringstream box;
    box.precision(15);
    for (const Eigen::Vector3d& corner :
         {Eigen::Vector3d(2, 1, -1), Eigen::Vector3d(5, 4, 2)})
      box << (box.str().empty() ? "" : ",") << corner.x() + shift.x() << ","
          << corner.y() + shift.y() << "," << corner.z() + shift.z();
    succeed("cloud " + input + " " + output + " --crop " + box.str());
    counts.push_back(readCloudTable(output).points());
  }
  EXPECT_GT(counts[0], 200u);
  EXPECT_EQ(counts[0], counts[1]);
}

TEST(FarClouds, FiltersOfBlobsTakeThem)
{
  std::vector<std::vector<double>> labels, thinned;
  for (const Eigen::Vector3d& shift : {Eigen::Vector3d::Zero().eval(), far_away}) {
    const auto blob = pcl::make_shared<PcdTable>(surfaces<double>(shift));
    PcdTable table;
    SemanticCRF<pcl::PCLPointCloud2> crf;
    crf.setLabelConfidence(0.8, 4);
    crf.setInputCloud(blob);
    crf.filter(table);
    labels.push_back(columnOf(table, "label"));
    LabelVoxelGrid grid;
    grid.setLeafSize(0.4);
    grid.setInputCloud(blob);
    grid.filter(table);
    thinned.push_back(columnOf(table, "label"));
  }
  EXPECT_EQ(labels[0], labels[1]);
  EXPECT_EQ(thinned[0], thinned[1]);
  EXPECT_GT(thinned[0].size(), 400u);
}

TEST(FarClouds, WhatSinglePrecisionLostIsSaid)
{
  const TemporaryFolder folder;
  const std::string input = folder.path("far.pcd");
  writeCloudTable(input, surfaces<float>(far_away));
  for (const char* const command :
       {"crf ", "cloud --thin 0.4 ", "cliques --method cubes "}) {
    const std::string text =
        succeed(std::string(command) + input + " " + folder.path("out.pcd"));
    EXPECT_TRUE(holds(text, "far.pcd: single precision has steps of 0.5 m at"));
  }
}

} // namespace pcl_semantic
