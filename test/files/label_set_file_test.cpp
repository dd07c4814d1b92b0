// SPDX-License-Identifier: BSD-3-Clause
#include "support/refused_file.h"

#include <pcl_semantic/files/label_set_file.h>

#include <gtest/gtest.h>

#include <set>

using namespace pcl_semantic;

namespace {

const std::string data_folder = std::string(PCL_SEMANTIC_SOURCE_DIR) + "/data/";

::testing::AssertionResult
refusesSet(const std::string& text, const std::string& part)
{
  return refusesFile("set.yaml", text, part, readLabelSet);
}

::testing::AssertionResult
refusesMapping(const std::string& text, const std::string& part)
{
  const LabelSet set({{"road", {}, false, false}, {"car", {}, false, false}});
  return refusesFile("mapping.yaml", text, part,
                     [&](const std::string& path) { readLabelMapping(path, set); });
}

} // namespace

TEST(LabelSetFile, ThePapersElevenClasses)
{
  const LabelSet set = readLabelSet(data_folder + "label_sets/kitti11.yaml");
  const char* const names[] = {"building", "sky",   "road",       "vegetation",
                               "sidewalk", "car",   "pedestrian", "cyclist",
                               "sign",     "fence", "pole"};
  ASSERT_EQ(set.size(), 11);
  for (int label = 1; label <= 11; ++label)
    EXPECT_EQ(set[Label(label)].name, names[label - 1]);
  EXPECT_EQ(set[8].colour, (std::array<std::uint8_t, 3>{0, 128, 192}));
  for (int label = 1; label <= 11; ++label) {
    EXPECT_EQ(set[Label(label)].sky, label == 2);
    EXPECT_EQ(set[Label(label)].dynamic, label >= 6 && label <= 8);
    EXPECT_EQ(set[Label(label)].thin, label >= 10);
  }
}

TEST(LabelSetFile, AllShippedSetsHaveDistinctColours)
{
  for (const char* const name : {"kitti11", "cityscapes19", "semantic_kitti19"}) {
    const LabelSet set = readLabelSet(data_folder + "label_sets/" + name + ".yaml");
    EXPECT_EQ(set.size(), name == std::string("kitti11") ? 11 : 19);
    std::set<std::array<std::uint8_t, 3>> colours;
    for (int label = 0; label <= set.size(); ++label)
      EXPECT_TRUE(colours.insert(set[Label(label)].colour).second)
          << name << " " << set[Label(label)].name;
  }
}

TEST(LabelSetFile, NamesTheLineOfAMistake)
{
  const std::string good = "classes:\n  - {name: road, colour: [1, 2, 3]}\n";
  for (const auto& [line, part] :
       {std::pair("  - {name: a, colour: [1, 2]}", "line 3"),
        std::pair("  - {name: a, colour: [1, 2, 256]}", "256"),
        std::pair("  - {name: a, colour: [1, 2, -1]}", "line 3"),
        std::pair("  - {colour: [1, 2, 3]}", "name"),
        std::pair("  - {name: road, colour: [1, 2, 4]}", "road"),
        std::pair("  - {name: a, color: [1, 2, 3]}", "set.yaml line 3"),
        std::pair("skies: 3", "skies")})
    EXPECT_TRUE(refusesSet(good + line + "\n", part)) << line;
  EXPECT_TRUE(refusesSet("classes: []\n", "set.yaml line 1"));
  EXPECT_TRUE(refusesSet("classes:\n  - road\n", "line 2"));
}

using IdsOfLabels = std::vector<std::pair<Label, std::vector<std::uint32_t>>>;

void
expectMapping(const std::string& mapping_name, const std::string& set_name,
              const IdsOfLabels& expected)
{
  const LabelSet set = readLabelSet(data_folder + "label_sets/" + set_name);
  const LabelMapping mapping =
      readLabelMapping(data_folder + "label_mappings/" + mapping_name, set);
  std::vector<Label> labels(1000, kUnlabelled);
  for (const auto& [label, ids] : expected)
    for (const std::uint32_t id : ids)
      labels[id] = label;
  for (std::uint32_t id = 0; id < labels.size(); ++id)
    EXPECT_EQ(mapping(id), labels[id]) << id;
}

// The table of the SemanticKITTI ids that the evaluation uses.
TEST(LabelMappingFile, SemanticKittiToThePapersClasses)
{
  expectMapping("semantic_kitti_to_kitti11.yaml", "kitti11.yaml",
                {{6, {10, 13, 16, 18, 20, 252, 256, 257, 258, 259}},
                 {8, {11, 15, 31, 32, 253, 255}},
                 {7, {30, 254}},
                 {3, {40, 44, 60}},
                 {5, {48}},
                 {1, {50}},
                 {10, {51}},
                 {4, {70, 71, 72}},
                 {11, {80}},
                 {9, {81}}});
}

// The dataset's own learning map.
TEST(LabelMappingFile, SemanticKittiToItsNineteenClasses)
{
  expectMapping("semantic_kitti_to_semantic_kitti19.yaml", "semantic_kitti19.yaml",
                {{1, {10, 252}},
                 {2, {11}},
                 {3, {15}},
                 {4, {18, 258}},
                 {5, {13, 16, 20, 256, 257, 259}},
                 {6, {30, 254}},
                 {7, {31, 253}},
                 {8, {32, 255}},
                 {9, {40, 60}},
                 {10, {44}},
                 {11, {48}},
                 {12, {49}},
                 {13, {50}},
                 {14, {51}},
                 {15, {70}},
                 {16, {71}},
                 {17, {72}},
                 {18, {80}},
                 {19, {81}}});
}

// Numbers that are known to have no class are not counted as lacking.
TEST(LabelMappingFile, KnowsNumbersWithoutAClass)
{
  const LabelSet set = readLabelSet(data_folder + "label_sets/kitti11.yaml");
  for (const std::string name : {"kitti11", "semantic_kitti19"}) {
    const LabelMapping mapping =
        readLabelMapping("semantic_kitti_to_" + name,
                         readLabelSet(data_folder + "label_sets/" + name + ".yaml"));
    for (const std::uint32_t id :
         {0,  1,  10, 11, 13, 15, 16, 18, 20, 30,  31,  32,  40,  44,  48,  49,  50,
          51, 52, 60, 70, 71, 72, 80, 81, 99, 252, 253, 254, 255, 256, 257, 258, 259})
      mapping(id);
    EXPECT_TRUE(mapping.lacking().empty()) << name;
  }
  const LabelMapping zero_based = readLabelMapping("zero_based", set);
  EXPECT_EQ(zero_based(255), kUnlabelled);
  EXPECT_TRUE(zero_based.lacking().empty());
  EXPECT_EQ(zero_based(11), kUnlabelled);
  EXPECT_EQ(zero_based.lacking().size(), 1u);
}

TEST(LabelMappingFile, NamesTheLineOfAMistake)
{
  for (const auto& [text, part] :
       {std::pair("classes:\n  road: [1]\n  lorry: [2]\n", "line 3"),
        std::pair("classes:\n  road: [65536]\n", "65536"),
        std::pair("classes:\n  road: [-1]\n", "mapping.yaml line 2"),
        std::pair("classes:\n  road: 7\n", "line 2"),
        std::pair("classes:\n  road: [7]\nextra: 1\n", "extra"),
        std::pair("classes:\n  road: [7]\n  car: [8, 7]\n", "mapping.yaml line 3"),
        std::pair("classes:\n  road: [7]\nunlabelled: [7]\n", "mapping.yaml line 3"),
        std::pair("classes:\n  road: [7]\nunlabelled: [-1]\n", "line 3"),
        std::pair("a: 1\n", "classes")})
    EXPECT_TRUE(refusesMapping(text, part)) << text;
}
