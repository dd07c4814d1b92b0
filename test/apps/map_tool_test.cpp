// SPDX-License-Identifier: BSD-3-Clause
#include "support/mapped_street.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/files/label_set_file.h>
#include <pcl_semantic/files/trajectory_file.h>
#include <pcl_semantic/images/image_file.h>

#include <opencv2/core.hpp>

#include <algorithm>
#include <cstring>
#include <numeric>

namespace pcl_semantic {

namespace fs = std::filesystem;

TEST(MapToolOptions, OldNamesAndKeysOfPresetsAreRefused)
{
  for (const auto& [option, says] :
       {std::pair("--hit-share 0.2", "--hit-share: was renamed to min_hit_ratio"),
        {"--crf-tolerance=0.1", "--crf-tolerance: was removed, it had no effect"},
        {"--superpixel-keep true", "--superpixel-keep: is no option, only a key"}})
    expectFails("map " + std::string(option) + " --print-config", 2, says);
  EXPECT_FALSE(holds(runTool("map --help-all").text, "superpixel-keep"));
  EXPECT_FALSE(holds(succeed("map --print-config"), "superpixel_keep"));
  EXPECT_TRUE(holds(succeed("map --config " PCL_SEMANTIC_SOURCE_DIR
                            "/data/presets/zhao16.yaml --print-config"),
                    "superpixel_keep: true"));
}

TEST(MapTool, FramesKeepTheirNumbers)
{
  const TemporaryFolder folder;
  mapStreet(tinyStreet(), folder.path("part"), "--frames 1:3 --crf none");
  EXPECT_EQ(filesIn(folder.path("part")), filesOfMap({"000001", "000002"}));

  copyStreet(folder.path("street"));
  fs::remove(folder.path("street/image_2/000001.png"));
  fs::remove(folder.path("street/image_3/000001.png"));
  mapStreet(folder.path("street"), folder.path("gap"), "--crf none");
  EXPECT_EQ(filesIn(folder.path("gap")), filesOfMap({"000000", "000002"}));
  const Trajectory poses = readKittiTrajectory(folder.path("gap/trajectory.txt"));
  ASSERT_EQ(poses.size(), 3u);
  const Trajectory truth = readKittiTrajectory(tinyStreet() + "/poses.txt");
  EXPECT_TRUE(poses[2].isApprox(truth[2], 1e-9));
  EXPECT_EQ(readJson(folder.path("gap/summary.json"))["frame_numbers"],
            nlohmann::json({0, 2}));
}

namespace {

// A point as it lies in map.pcd, for eleven classes.
struct PackedPoint {
  float x, y, z;
  std::uint32_t rgba, label;
  float probability[11];
  float entropy;
  std::uint32_t observations, object, plane;
};

std::vector<PackedPoint>
readPoints(const std::string& path)
{
  const std::string bytes = bytesOf(path);
  const std::string end = "DATA binary\n";
  const std::size_t start = bytes.find(end) + end.size();
  EXPECT_EQ((bytes.size() - start) % sizeof(PackedPoint), 0u);
  std::vector<PackedPoint> points((bytes.size() - start) / sizeof(PackedPoint));
  std::memcpy(points.data(), bytes.data() + start, points.size() * sizeof(PackedPoint));
  return points;
}

void
expectPictures(const std::string& output)
{
  for (const char* folder :
       {"labels/", "labels_at_depth/", "network_labels/", "final_labels/"}) {
    SCOPED_TRACE(folder);
    const cv::Mat labels =
        readPng(output + "/" + folder + "000001.png", ImageKind::labels);
    EXPECT_EQ(labels.size(), cv::Size(208, 64));
    double largest = 0.0;
    cv::minMaxLoc(labels, nullptr, &largest);
    EXPECT_LE(largest, 11.0);
    EXPECT_GT(cv::countNonZero(labels), 208 * 64 / 4);
  }
  const cv::Mat overlay =
      readPng(output + "/overlay/000001.png", ImageKind::grey_or_colour);
  EXPECT_EQ(overlay.type(), CV_8UC3);
  EXPECT_GE(overlay.cols, 208);
  EXPECT_GE(overlay.rows, 64);
  EXPECT_EQ(readPng(output + "/top_view.png", ImageKind::grey_or_colour).type(),
            CV_8UC3);
}

void
expectClouds(const std::string& output, std::size_t count)
{
  const LabelSet label_set = readLabelSet(kitti11);
  const std::vector<PackedPoint> points = readPoints(output + "/map.pcd");
  const std::vector<PackedPoint> classes = readPoints(output + "/map_classes.pcd");
  ASSERT_EQ(points.size(), count);
  ASSERT_EQ(classes.size(), count);
  std::size_t labelled = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const PackedPoint& point = points[i];
    ASSERT_GE(point.observations, 1u);
    ASSERT_LE(point.label, 11u);
    PackedPoint coloured = classes[i];
    if (point.label != kUnlabelled) {
      ++labelled;
      const float* const p = point.probability;
      ASSERT_EQ(std::max_element(p, p + 11) - p + 1, long(point.label));
      ASSERT_NEAR(std::accumulate(p, p + 11, 0.0), 1.0, 1e-4);
      const auto& rgb = label_set[Label(point.label)].colour;
      ASSERT_EQ(coloured.rgba & 0xFFFFFFu,
                std::uint32_t(rgb[0]) << 16 | std::uint32_t(rgb[1]) << 8 | rgb[2]);
    }
    coloured.rgba = point.rgba; // the only difference
    ASSERT_EQ(std::memcmp(&coloured, &point, sizeof(point)), 0);
  }
  EXPECT_GT(labelled, count / 2);
}

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

} // namespace

TEST(MapTool, WritesACompleteMap)
{
  const TemporaryFolder folder;
  const std::string output = folder.path("out");
  mapStreet(tinyStreet(), output, "");
  EXPECT_EQ(filesIn(output), filesOfMap({"000000", "000001", "000002"}));
  expectPictures(output);

  const nlohmann::json summary = readJson(output + "/summary.json");
  for (const char* key : {"frames", "voxels", "map_origin", "seconds", "options",
                          "versions", "voxel_size", "points"})
    EXPECT_TRUE(summary.contains(key)) << key;
  EXPECT_EQ(summary["frames"], 3);
  EXPECT_EQ(summary["options"]["crf"], "dense");
  for (const char* stage : {"stereo", "labelling", "map", "crf"}) {
    EXPECT_GE(summary["seconds"][stage]["median"], 0.0) << stage;
    EXPECT_GE(summary["seconds"][stage]["95 %"], summary["seconds"][stage]["median"]);
  }
  for (const char* const line :
       {"\nFIELDS x y z rgba label probability entropy observations object plane\n",
        "\nCOUNT 1 1 1 1 1 11 1 1 1 1\n"})
    EXPECT_TRUE(holds(bytesOf(output + "/map.pcd"), line));
  expectClouds(output, summary["voxels"]);
  const Trajectory poses = readKittiTrajectory(output + "/trajectory.txt");
  const Trajectory truth = readKittiTrajectory(tinyStreet() + "/poses.txt");
  ASSERT_EQ(poses.size(), truth.size());
  for (std::size_t i = 0; i < poses.size(); ++i)
    EXPECT_TRUE(poses[i].isApprox(truth[i], 1e-9)) << i;
}

TEST(MapTool, LabelsEveryNthFrame)
{
  const TemporaryFolder folder;
  copyStreet(folder.path("street"));
  const std::string labels = folder.path("street/labels/");
  fs::remove(labels + "000001.bin"); // needs none
  mapStreet(folder.path("street"), folder.path("out"), "--network-every 2");
  const auto labelled = [&](const std::string& frame) {
    return cv::countNonZero(readPng(folder.path("out/network_labels/") + frame + ".png",
                                    ImageKind::labels));
  };
  EXPECT_GT(labelled("000000"), 0);
  EXPECT_EQ(labelled("000001"), 0);
  EXPECT_GT(labelled("000002"), 0);
  EXPECT_GT(cv::countNonZero(
                readPng(folder.path("out/labels/000001.png"), ImageKind::labels)),
            1000);
}

TEST(MapTool, ConfigurationFileAndOptions)
{
  const TemporaryFolder folder;
  const std::string config =
      folder.write("config.yaml", "voxel_size: 0.2\nwindow: [20, 20, 8]\ncrf: none\n");
  const std::string printed =
      succeed("map --config " + config + " --voxel-size 0.25 --print-config");
  for (const char* line :
       {"voxel_size: 0.25 ", "window: [20,20,8] ", "crf: none ", "max_depth: 40 "})
    EXPECT_TRUE(holds("\n" + printed, std::string("\n") + line));
  const std::string whole = folder.write("whole.yaml", printed);
  EXPECT_EQ(runTool("map --print-config --config " + whole).text, printed);

  mapStreet(tinyStreet(), folder.path("out"),
            "--frames 0:1 --config " + config + " --voxel-size 0.25");
  const nlohmann::json summary = readJson(folder.path("out/summary.json"));
  EXPECT_EQ(summary["voxel_size"], 0.25);
  EXPECT_EQ(summary["options"]["window"], "20,20,8");
}

TEST(MapTool, AnEarlierRunIsReplacedAndForeignImagesAreNot)
{
  const TemporaryFolder folder;
  const std::string output = folder.path("out");
  mapStreet(tinyStreet(), output, "--crf none");
  mapStreet(tinyStreet(), output, "--crf none --frames 1:2");
  EXPECT_EQ(filesIn(output), filesOfMap({"000001"}));

  // Without a summary the images count as foreign.
  fs::remove(output + "/summary.json");
  expectFails(mapOf(tinyStreet()) + " --output " + output, 5,
              "/labels: holds images without a summary.json");
  EXPECT_TRUE(fs::exists(output + "/labels/000001.png"));
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

} // namespace pcl_semantic
