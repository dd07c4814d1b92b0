// SPDX-License-Identifier: BSD-3-Clause
#include "support/random_scene.h"
#include "support/temporary_folder.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/io/class_statistics.h>

#include <gtest/gtest.h>

#include <set>
#include <sstream>

using namespace pcl_semantic;

namespace {

LabelSet
oddNames()
{
  return LabelSet({{"road, \"wet\"", {1, 2, 3}, false, false},
                   {"car", {4, 5, 6}, false, false},
                   {"tree", {7, 8, 9}, false, false},
                   {"never there", {7, 8, 10}, false, false}});
}

// The fields of the lines of a CSV file, quotes resolved.
std::vector<std::vector<std::string>>
readCsv(const std::string& path)
{
  std::vector<std::vector<std::string>> lines(1, {""});
  const std::string text = bytesOf(path);
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char letter = text[i];
    if (letter == '"' && quoted && i + 1 < text.size() && text[i + 1] == '"')
      lines.back().back() += text[++i];
    else if (letter == '"')
      quoted = !quoted;
    else if (letter == ',' && !quoted)
      lines.back().emplace_back();
    else if (letter == '\n' && !quoted)
      lines.push_back({""});
    else
      lines.back().back() += letter;
  }
  EXPECT_EQ(lines.back(), std::vector<std::string>{""}); // ends with a line break
  lines.pop_back();
  return lines;
}

} // namespace

TEST(ClassStatistics, EqualAPlainCount)
{
  const TemporaryFolder folder;
  VoxelScene scene = randomScene(1);
  scene.origin.z() = 50.0; // the corner stays: the world is 50 m higher than the points
  const LabelSet label_set = oddNames();
  writeClassStatistics(folder.path("a.csv"), countClasses(scene, label_set), label_set);
  const auto lines = readCsv(folder.path("a.csv"));
  ASSERT_EQ(lines.size(), 6u);
  EXPECT_EQ(lines[0], (std::vector<std::string>{"label", "class", "voxels", "fraction",
                                                "volume_m3", "area_m2", "mean_z_m",
                                                "lowest_z_m", "highest_z_m"}));
  for (int label = 0; label <= 3; ++label) {
    std::vector<double> z;
    std::set<std::pair<int, int>> columns;
    for (std::size_t i = 0; i < scene.voxels.size(); ++i)
      if (int((*scene.voxels.cloud)[i].label) == label) {
        const VoxelIndex& voxel = scene.voxels.indices[i];
        z.push_back(50.0 + (voxel.z() + 0.5) * 0.25);
        columns.insert({voxel.x(), voxel.y()});
      }
    ASSERT_GT(z.size(), 100u);
    double sum = 0.0;
    for (const double each : z)
      sum += each;
    const std::vector<std::string>& line = lines[std::size_t(label) + 1];
    ASSERT_EQ(line.size(), 9u);
    EXPECT_EQ(line[0], std::to_string(label));
    EXPECT_EQ(line[1], label_set[Label(label)].name);
    EXPECT_EQ(line[2], std::to_string(z.size()));
    const double n = double(z.size());
    const double expected[] = {
        n / double(scene.voxels.size()),       n * 0.25 * 0.25 * 0.25,
        double(columns.size()) * 0.0625,       sum / n,
        *std::min_element(z.begin(), z.end()), *std::max_element(z.begin(), z.end())};
    for (std::size_t i = 0; i < 6; ++i)
      EXPECT_NEAR(std::stod(line[i + 3]), expected[i], 1e-6 * std::abs(expected[i]))
          << i;
  }
  EXPECT_EQ(lines[5], (std::vector<std::string>{"4", "never there", "0", "0", "0", "0",
                                                "", "", ""}));
}

TEST(ClassStatistics, RefuseLabelsBeyondTheSet)
{
  VoxelScene scene = emptyScene();
  addVoxel(scene, {1, 2, 3}, 5);
  EXPECT_THROW(countClasses(scene, oddNames()), InvalidParameterException);
}
