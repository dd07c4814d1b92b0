// SPDX-License-Identifier: BSD-3-Clause
#include "support/mapped_street.h"

namespace {

using namespace pcl_semantic;
namespace fs = std::filesystem;

constexpr const char* presets = PCL_SEMANTIC_SOURCE_DIR "/data/presets";

std::vector<std::string>
presetNames()
{
  std::vector<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(presets))
    names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

TEST(Presets, EachRunsAndSaysWhatItStandsFor)
{
  const TemporaryFolder folder;
  std::set<std::string> maps;
  for (const std::string& name : presetNames()) {
    const std::string path = std::string(presets) + "/" + name;
    EXPECT_EQ(bytesOf(path).rfind("# ", 0), 0u) << name;
    mapStreet(tinyStreet(), folder.path("out"), "--config " + path);
    const nlohmann::json summary = readJson(folder.path("out/summary.json"));
    EXPECT_EQ(summary["frames"], 3) << name;
    EXPECT_GT(summary["voxels"], 100) << name;
    maps.insert(bytesOf(folder.path("out/map.pcd")));
  }
  EXPECT_GE(maps.size(), 7u);
  EXPECT_EQ(maps.size(), presetNames().size()) << "two of them are the same";
}

// Stored classes are votes without bound: which class wins does not depend on how sure
// each of them is said to be.
TEST(Presets, Sengupta13CountsVotes)
{
  const TemporaryFolder folder;
  std::vector<std::string> labels;
  for (const char* confidence : {"0.2", "0.5"}) {
    succeed("map " + tinyStreet() + " --labels " + tinyStreet() + "/gt --config " +
            presets + "/sengupta13.yaml --label-confidence " + confidence +
            " --output " + folder.path("out"));
    labels.push_back(bytesOf(folder.path("out/labels_at_depth/000002.png")));
  }
  EXPECT_TRUE(labels[0] == labels[1]);
}

} // namespace
