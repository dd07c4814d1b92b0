// SPDX-License-Identifier: BSD-3-Clause
#include "support/mapped_street.h"

#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/files/image_file.h>
#include <pcl_semantic/files/label_set_file.h>
#include <pcl_semantic/files/trajectory_file.h>

#include <opencv2/core.hpp>

#include <algorithm>
#include <cstring>
#include <numeric>

namespace pcl_semantic {

namespace {

// A point as it lies in map.pcd, for eleven classes.
struct PackedPoint {
  float x, y, z;
  std::uint32_t rgba, label;
  float probability[11];
  float entropy;
  std::uint32_t observations;
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

double
largestDifference(const Trajectory& a, const Trajectory& b)
{
  EXPECT_EQ(a.size(), b.size());
  double difference = 0.0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    difference =
        std::max(difference, (a[i].matrix() - b[i].matrix()).cwiseAbs().maxCoeff());
  return difference;
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
  const LabelSet label_set =
      readLabelSet(PCL_SEMANTIC_SOURCE_DIR "/data/label_sets/kitti11.yaml");
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

} // namespace

TEST(MapOutput, IsComplete)
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
  EXPECT_NE(bytesOf(output + "/map.pcd")
                .find("FIELDS x y z rgba label probability entropy observations\n"),
            std::string::npos);
  EXPECT_NE(bytesOf(output + "/map.pcd").find("COUNT 1 1 1 1 1 11 1 1\n"),
            std::string::npos);
  expectClouds(output, summary["voxels"]);
  EXPECT_LT(largestDifference(readKittiTrajectory(output + "/trajectory.txt"),
                              readKittiTrajectory(tinyStreet() + "/poses.txt")),
            1e-9);
}

} // namespace pcl_semantic
