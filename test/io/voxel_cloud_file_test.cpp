// SPDX-License-Identifier: BSD-3-Clause
#include "support/random_scan.h"
#include "support/temporary_folder.h"

#include <pcl_semantic/files/cloud_file.h>
#include <pcl_semantic/io/voxel_cloud_file.h>
#include <pcl_semantic/map/semantic_voxel_map.h>
#include <pcl_semantic/pictures/map_images.h>

#include <pcl/conversions.h>
#include <pcl/io/pcd_io.h>

#include <gtest/gtest.h>

#include <array>
#include <cstring>

namespace {

using namespace pcl_semantic;

LabelSet
twoClasses()
{
  return LabelSet({{"house", {200, 10, 20}}, {"road", {30, 40, 50}}});
}

VoxelCloud
makeVoxels()
{
  SemanticVoxelMap map(twoClasses(), SemanticVoxelMap::Parameters());
  const LabelledScan scan = makeRandomScan(500, 3.0f, 2, 1);
  map.integrate(scan.cloud, Eigen::Isometry3d::Identity(), scan.distributions);
  return map.occupied();
}

TEST(VoxelCloudFile, PclReadsWhatWasWritten)
{
  const TemporaryFolder folder;
  const VoxelCloud voxels = makeVoxels();
  const std::string path = folder.path("map.pcd");
  writeVoxelCloud(path, voxels, twoClasses(), VoxelColour::measured);

  pcl::PCLPointCloud2 read;
  ASSERT_EQ(pcl::io::loadPCDFile(path, read), 0);
  std::string names;
  for (const pcl::PCLPointField& field : read.fields)
    names += field.name + ":" + std::to_string(field.count) + " ";
  EXPECT_EQ(names,
            "x:1 y:1 z:1 rgba:1 label:1 probability:2 entropy:1 observations:1 ");

  pcl::PointCloud<pcl::PointXYZRGBL> cloud;
  pcl::fromPCLPointCloud2(read, cloud);
  ASSERT_EQ(cloud.size(), voxels.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    EXPECT_EQ(cloud[i].getVector3fMap(), (*voxels.cloud)[i].getVector3fMap());
    EXPECT_EQ(cloud[i].label, (*voxels.cloud)[i].label);
    EXPECT_EQ(cloud[i].rgba & 0xFFFFFFu, (*voxels.cloud)[i].rgba & 0xFFFFFFu);
    float values[3]; // two probabilities and the entropy
    std::memcpy(values, &read.data[i * read.point_step + read.fields[5].offset], 12);
    EXPECT_EQ(values[0], voxels.refined.matrix()(0, Eigen::Index(i)));
    EXPECT_EQ(values[1], voxels.refined.matrix()(1, Eigen::Index(i)));
    EXPECT_EQ(values[2], voxels.refined.entropy(Eigen::Index(i)));
  }
}

// A scanner's map: programs would show a field of zeros in black.
TEST(VoxelCloudFile, WithoutColoursThereIsNoFieldOfColours)
{
  const TemporaryFolder folder;
  const VoxelCloud voxels = makeVoxels();
  for (pcl::PointXYZRGBL& point : *voxels.cloud)
    point.rgba = 0;
  EXPECT_FALSE(hasColour(voxels));
  writeVoxelCloud(folder.path("map.pcd"), voxels, twoClasses(), VoxelColour::measured);
  const LabelledCloud read = readLabelledCloud(folder.path("map.pcd"));
  EXPECT_FALSE(read.has_colour);
  EXPECT_EQ(read.table.find("rgba"), -1);
  ASSERT_EQ(read.cloud->size(), voxels.size());
  EXPECT_TRUE(read.distributions.matrix() == voxels.refined.matrix());
  for (std::size_t i = 0; i < voxels.size(); ++i)
    EXPECT_EQ((*read.cloud)[i].label, (*voxels.cloud)[i].label);
}

TEST(VoxelCloudFile, ClassesGiveTheirColoursIfThereIsAPoint)
{
  const TemporaryFolder folder;
  const VoxelCloud voxels = makeVoxels();
  writeVoxelCloud(folder.path("map.pcd"), voxels, twoClasses(), VoxelColour::classes);
  pcl::PointCloud<pcl::PointXYZRGBL> cloud;
  ASSERT_EQ(pcl::io::loadPCDFile(folder.path("map.pcd"), cloud), 0);
  for (const pcl::PointXYZRGBL& point : cloud) {
    const std::array<std::uint8_t, 3> colour{point.r, point.g, point.b};
    ASSERT_EQ(colour, twoClasses()[Label(point.label)].colour);
  }
  // An empty map is a file, too.
  VoxelCloud empty;
  empty.refined = LabelDistributions(2, 0);
  writeVoxelCloud(folder.path("map.pcd"), empty, twoClasses(), VoxelColour::measured);
  pcl::PCLPointCloud2 read;
  EXPECT_EQ(pcl::io::loadPCDFile(folder.path("map.pcd"), read), 0);
  EXPECT_EQ(read.width * read.height, 0u);
}

TEST(MapImages, TheOverlayShowsTheImageWhereNothingIsLabelled)
{
  cv::Mat image(20, 300, CV_8UC1, cv::Scalar(77));
  cv::Mat labels = cv::Mat::zeros(20, 300, CV_8UC1);
  labels.colRange(0, 100) = 1;
  const cv::Mat overlay = drawOverlay(image, labels, twoClasses());
  EXPECT_GT(overlay.rows, 20); // the legend is below
  EXPECT_EQ(overlay.cols, 300);
  EXPECT_EQ(overlay.at<cv::Vec3b>(5, 200), cv::Vec3b(77, 77, 77));
  const cv::Vec3b house = overlay.at<cv::Vec3b>(5, 50);
  for (int c = 0; c < 3; ++c) // on grey
    EXPECT_NEAR(house[c], 0.45 * 77 + 0.65 * twoClasses()[1].colour[std::size_t(2 - c)],
                1.0);
}

TEST(MapImages, TheLegendListsTheClassesInThePicture)
{
  std::vector<LabelClass> many;
  for (int i = 0; i < 150; ++i)
    many.push_back({"class " + std::to_string(i), {200, std::uint8_t(i), 0}});
  const LabelSet label_set(many);
  const cv::Mat image(200, 400, CV_8UC1, cv::Scalar(77));
  cv::Mat labels = cv::Mat::zeros(image.size(), CV_8UC1);
  const cv::Mat empty = drawOverlay(image, labels, label_set);
  labels.colRange(0, 100) = 7;
  labels.colRange(100, 200) = 150;
  const cv::Mat overlay = drawOverlay(image, labels, label_set);
  EXPECT_EQ(empty.size(), overlay.size());
  EXPECT_LT(overlay.rows, 300);
  const auto isInLegend = [&](Label label) {
    const auto& colour = label_set[label].colour;
    for (int v = 200; v < overlay.rows; ++v)
      for (int u = 0; u < overlay.cols; ++u)
        if (overlay.at<cv::Vec3b>(v, u) == cv::Vec3b(colour[2], colour[1], colour[0]))
          return true;
    return false;
  };
  EXPECT_TRUE(isInLegend(7));
  EXPECT_TRUE(isInLegend(150));
  EXPECT_FALSE(isInLegend(1));
  EXPECT_FALSE(isInLegend(100));
}

TEST(MapImages, AMapWithoutClassesIsDrawnInItsColours)
{
  VoxelCloud voxels;
  voxels.voxel_size = 0.1;
  voxels.indices = {{0, 0, 0}, {60, 60, 0}};
  voxels.cloud->resize(2);
  for (pcl::PointXYZRGBL& point : *voxels.cloud) {
    point.label = kUnlabelled;
    point.r = 10;
    point.g = 150;
    point.b = 90;
  }
  const cv::Mat view = drawTopView(voxels, {}, twoClasses());
  EXPECT_EQ(view.at<cv::Vec3b>(4, 4), cv::Vec3b(90, 150, 10));
  EXPECT_EQ(view.rows, 61 * 8); // no legend
}

TEST(MapImages, TheTopViewShowsTheHighestClassInItsPlace)
{
  // Two voxels above each other, and one ahead and to the left.
  VoxelCloud voxels;
  voxels.voxel_size = 0.1;
  voxels.indices = {{0, 0, 0}, {0, 0, 5}, {60, 60, 0}};
  voxels.cloud->resize(3);
  for (std::size_t i = 0; i < 3; ++i)
    (*voxels.cloud)[i].label = i == 1 ? 2 : 1;
  const cv::Mat view = drawTopView(voxels, {}, twoClasses());
  const int side = 61 * 8;
  ASSERT_GE(view.rows, side);
  ASSERT_EQ(view.cols, side);
  const cv::Vec3b ahead_left = view.at<cv::Vec3b>(4, 4);
  EXPECT_GT(ahead_left[2], 100); // house is red
  const cv::Vec3b start = view.at<cv::Vec3b>(side - 4, side - 4);
  EXPECT_LT(start[2], 60); // road covers the house below it
  EXPECT_GT(start[0], 40);
}

TEST(MapImages, TheTopViewHoldsThePathBesideTheMap)
{
  VoxelCloud voxels;
  voxels.voxel_size = 0.1;
  voxels.indices = {{100, 0, 0}};
  voxels.cloud->resize(1);
  voxels.cloud->front().label = 1;
  // From 10 m behind the only voxel to 2 m behind it.
  const cv::Mat view = drawTopView(
      voxels, {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(8, 0, 0)}, twoClasses());
  int red = 0, first = view.rows, last = 0;
  for (int v = 0; v < view.rows; ++v)
    for (int u = 0; u < view.cols; ++u)
      if (view.at<cv::Vec3b>(v, u) == cv::Vec3b(60, 60, 255)) {
        ++red;
        first = std::min(first, v);
        last = std::max(last, v);
      }
  EXPECT_GT(red, 100);
  EXPECT_GT(last - first, 350); // 8 m at 5 pixels a voxel or more
}

} // namespace
