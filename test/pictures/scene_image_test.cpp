// SPDX-License-Identifier: BSD-3-Clause
#include "support/random_scene.h"
#include "support/temporary_folder.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/pictures/scene_image.h>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include <map>
#include <random>

using namespace pcl_semantic;

namespace {

LabelSet
threeClasses()
{
  return LabelSet({{"house", {200, 10, 20}, false, false},
                   {"road", {30, 40, 50}, false, false},
                   {"tree", {20, 200, 20}, false, false}});
}

/** \brief A flat road with a wall on its left side, along x. */
VoxelScene
street()
{
  VoxelScene scene;
  scene.grid.size = scene.voxels.voxel_size = 0.2;
  scene.has_colour = scene.has_labels = true;
  for (int x = 0; x < 100; ++x)
    for (int y = 0; y < 30; ++y)
      addVoxel(scene, {x, y, 0}, 2);
  for (int x = 0; x < 100; ++x)
    for (int z = 1; z < 15; ++z)
      addVoxel(scene, {x, 29, z}, x < 50 ? 1 : 3);
  return scene;
}

SensorPath
pathThrough()
{
  SensorPath path;
  for (int i = 0; i <= 10; ++i)
    path.emplace_back(0.5 + 1.5 * i, 2.0, 1.6);
  return path;
}

Eigen::Vector2d
pixelOf(const SceneView& view, const Eigen::Vector3d& point)
{
  return view.camera.project(view.T_world_camera.inverse() * point);
}

bool
isInside(const SceneView& view, const Eigen::Vector3d& point)
{
  const Eigen::Vector2d pixel = pixelOf(view, point);
  return pixel.minCoeff() >= 0.0 && pixel.x() < view.camera.width &&
         pixel.y() < view.camera.height;
}

// 1234 as 1 234.
std::string
grouped(int number)
{
  return number < 1000
             ? std::to_string(number)
             : std::to_string(number / 1000) + cv::format(" %03d", number % 1000);
}

/** \brief A `.pcd` of x y z label rgb, ascii. */
std::string
pcd(const std::vector<std::string>& points)
{
  std::string text = "VERSION 0.7\nFIELDS x y z label rgba\nSIZE 8 8 8 4 4\n"
                     "TYPE F F F U U\nCOUNT 1 1 1 1 1\nWIDTH " +
                     std::to_string(points.size()) + "\nHEIGHT 1\nPOINTS " +
                     std::to_string(points.size()) + "\nDATA ascii\n";
  for (const std::string& point : points)
    text += point + "\n";
  return text;
}

} // namespace

TEST(VoxelScene, FindsTheGridOfItsPoints)
{
  const TemporaryFolder folder;
  // Voxels of 0.3 m relative to an origin that is no multiple of them.
  const VoxelScene scene = readVoxelScene(
      folder.write("a.pcd", pcd({"100000.05 -7.15 0 1 255", "100000.35 -7.15 0 2 65280",
                                 "nan 0 0 1 0", "100003.05 -6.25 -0.6 3 0"})));
  EXPECT_NEAR(scene.grid.size, 0.3, 1e-9);
  ASSERT_EQ(scene.voxels.size(), 3u);
  const std::vector<VoxelIndex>& indices = scene.voxels.indices;
  EXPECT_EQ(indices[1] - indices[0], VoxelIndex(1, 0, 0));
  EXPECT_EQ(indices[2] - indices[0], VoxelIndex(10, 3, -2));
  const Eigen::Vector3d centre = scene.origin + centreOf(scene.grid, indices[1]);
  EXPECT_LT((centre - Eigen::Vector3d(100000.35, -7.15, 0.0)).norm(), 1e-6);
  EXPECT_EQ((*scene.voxels.cloud)[1].g, 255);
}

TEST(VoxelScene, BinsTheCloudsOfOthers)
{
  const TemporaryFolder folder;
  const std::string path = folder.write(
      "a.pcd", pcd({"0.1 0.137 0.1 2 10", "0.4 0.2 0.3 1 30", "0.3 0.3 0.3 2 20",
                    "-0.171 0.45 0.1 3 7", "0.2 0.1 0.3 1 40"}));
  expectBadInput("--voxel-size", [&] { readVoxelScene(path); });
  const VoxelScene scene = readVoxelScene(path, {0.5, Eigen::Vector3d::Zero()});
  ASSERT_EQ(scene.voxels.size(), 2u);
  std::map<int, const pcl::PointXYZRGBL*> by_x;
  for (std::size_t i = 0; i < 2; ++i)
    by_x[scene.voxels.indices[i].x()] = &(*scene.voxels.cloud)[i];
  EXPECT_EQ(by_x.at(-1)->label, 3u);
  EXPECT_EQ(by_x.at(0)->label, 1u); // of two labels with two points the lower one
  EXPECT_EQ(by_x.at(0)->b, 25);     // blue of the four
}

TEST(VoxelScene, FindsTheSameVoxelsInAnotherMap)
{
  const VoxelScene scene = street();
  VoxelScene other = street();
  other.voxels.cloud->points.back().label = 2;
  other.voxels.indices.front().x() = -7; // the first voxel is not there
  // The same places counted from another corner.
  for (VoxelIndex& index : other.voxels.indices)
    index -= VoxelIndex(10, 20, 30);
  other.grid.corner = Eigen::Vector3d(10, 20, 30) * 0.2;
  const std::vector<Label> labels = labelsAtVoxels(scene, other);
  EXPECT_EQ(labels.front(), kUnlabelled);
  EXPECT_EQ(labels.back(), 2);
  for (std::size_t i = 1; i + 1 < labels.size(); ++i)
    ASSERT_EQ(labels[i], (*scene.voxels.cloud)[i].label);
  other.grid.corner.x() += 0.1;
  EXPECT_THROW(labelsAtVoxels(scene, other), InvalidParameterException);
  other.grid.size = 0.1;
  EXPECT_THROW(labelsAtVoxels(scene, other), InvalidParameterException);
}

TEST(VoxelScene, IsTheSameWorldWhereverItsOriginIs)
{
  const TemporaryFolder folder;
  // The same voxels at the coordinates of a survey, each cloud with an origin of its
  // own, and once relative to one that the grid in its header tells.
  const std::string first = folder.write(
      "a.pcd", pcd({"456000.5 5428000.5 100.5 1 0", "456001.5 5428000.5 100.5 2 0",
                    "456002.5 5428000.5 100.5 3 0"}));
  const std::string second = folder.write(
      "b.pcd", pcd({"456002.5 5428000.5 100.5 3 0", "456003.5 5428000.5 100.5 2 0",
                    "456001.5 5428000.5 100.5 1 0", "459001.5 5428000.5 100.5 1 0"}));
  std::string relative = pcd({"0.5 0.5 0.5 3 0", "1.5 0.5 0.5 2 0"});
  relative.insert(0, "# voxel_grid 1 -456002 -5428000 -100\n");
  const std::string third = folder.write("c.pcd", relative);
  const VoxelScene scene = readVoxelScene(first);
  EXPECT_FALSE(scene.origin.isZero());
  const VoxelGrid grid{scene.grid.size, scene.grid.corner + scene.origin};
  EXPECT_EQ(labelsAtVoxels(scene, readVoxelScene(second, {}, grid)),
            (std::vector<Label>{0, 1, 3}));
  EXPECT_EQ(labelsAtVoxels(scene, readVoxelScene(third, {}, grid)),
            (std::vector<Label>{0, 0, 3}));
}

TEST(VoxelScene, OfNoPointsIsEmpty)
{
  const TemporaryFolder folder;
  const VoxelScene scene = readVoxelScene(folder.write("a.pcd", pcd({})));
  EXPECT_EQ(scene.voxels.size(), 0u);
  EXPECT_EQ(scene.grid.size, 0.0);
}

TEST(SceneView, ShowsThePathAndMostOfTheMap)
{
  const VoxelScene scene = street();
  const SensorPath path = pathThrough();
  for (const bool above : {false, true}) {
    const cv::Size size(640, 360);
    const SceneView view =
        above ? aboveView(scene, path, size) : angleView(scene, path, size);
    for (const Eigen::Vector3d& place : path)
      EXPECT_TRUE(isInside(view, place));
    std::size_t inside = 0;
    for (const VoxelIndex& index : scene.voxels.indices)
      inside += isInside(view, index.cast<double>() * scene.grid.size);
    EXPECT_GT(inside, scene.voxels.size() * 95 / 100);
    // The way goes from left to right, or into the picture.
    const Eigen::Vector2d way =
        pixelOf(view, path.back()) - pixelOf(view, path.front());
    EXPECT_GT(above ? way.x() : -way.y(), 40.0);
    if (above) {
      EXPECT_NEAR(way.norm(), 15.0 * view.pixels_per_metre, 0.5);
    }
  }
}

TEST(SceneView, FarFromTheOriginNothingChanges)
{
  const VoxelScene near = street();
  VoxelScene far = street();
  const VoxelIndex step(500000000, -400000000, 1000);
  for (VoxelIndex& index : far.voxels.indices)
    index += step;
  const cv::Size size(320, 180);
  const SceneView here = angleView(near, {}, size), there = angleView(far, {}, size);
  EXPECT_NEAR(here.camera.cx, there.camera.cx, 1e-3);
  const Eigen::Vector3d moved =
      there.T_world_camera.translation() - step.cast<double>() * near.grid.size;
  EXPECT_LT((moved - here.T_world_camera.translation()).norm(), 1e-3);
  const LabelSet label_set = threeClasses();
  const cv::Mat a = drawVoxels(near, classColours(near, label_set), here, {});
  const cv::Mat b = drawVoxels(far, classColours(far, label_set), there, {});
  cv::Mat difference;
  cv::absdiff(a.rowRange(0, 150), b.rowRange(0, 150), difference);
  EXPECT_LT(cv::mean(difference)[0], 1.0);
}

TEST(SceneView, RefusesWhatCannotBe)
{
  const Eigen::Vector3d from(1, 2, 3);
  EXPECT_THROW(lookAt(from, from, 1.0, {100, 100}), InvalidParameterException);
  for (const double angle : {0.0, 4.0})
    EXPECT_THROW(lookAt(from, -from, angle, {100, 100}), InvalidParameterException);
  EXPECT_THROW(lookAt(from, -from, 1.0, {0, 100}), InvalidParameterException);
  const SceneView down = lookAt(from, {1, 2, 0}, 1.0, {100, 100});
  EXPECT_TRUE(down.T_world_camera.linear().isUnitary(1e-12));
}

TEST(SceneImage, ShowsClassesInTheirPlaces)
{
  const VoxelScene scene = street();
  const VoxelColours colours = classColours(scene, threeClasses());
  ASSERT_EQ(colours.legend.size(), 3u);
  EXPECT_EQ(colours.legend[0].text, "house");
  const SceneView view = aboveView(scene, {}, {640, 360});
  const cv::Mat picture = drawVoxels(scene, colours, view, {});
  EXPECT_EQ(picture.cols, 640);
  EXPECT_GT(picture.rows, 360);
  // The tops of the walls: house in the first half, tree in the second; left is up.
  const auto at = [&](double x, double y, double z) {
    const Eigen::Vector2d pixel = pixelOf(view, {x, y, z});
    return picture.at<cv::Vec3b>(cvRound(pixel.y()), cvRound(pixel.x()));
  };
  const cv::Vec3b house = at(5.0, 5.9, 3.0), tree = at(15.0, 5.9, 3.0);
  EXPECT_GT(house[2], house[1] + 60);
  EXPECT_GT(tree[1], tree[2] + 60);
  // Beside the wall the road is darker than in the open.
  EXPECT_LT(at(5.0, 5.75, 0.2)[1], at(5.0, 3.1, 0.2)[1]);
  EXPECT_LT(pixelOf(view, {5.0, 5.9, 3.0}).y(), pixelOf(view, {5.0, 1.0, 0.2}).y());
}

TEST(SceneImage, ThreadsChangeNoPixel)
{
  const VoxelScene scene = street();
  const VoxelColours colours = classColours(scene, threeClasses());
  const SceneView view = angleView(scene, pathThrough(), {320, 200});
  setNumberOfThreads(1);
  const cv::Mat one = drawVoxels(scene, colours, view, pathThrough());
  setNumberOfThreads(4);
  const cv::Mat four = drawVoxels(scene, colours, view, pathThrough());
  setNumberOfThreads(0);
  EXPECT_EQ(cv::norm(one, four, cv::NORM_INF), 0.0);
}

TEST(SceneImage, RefusesWhatCannotBeDrawn)
{
  VoxelScene scene = street();
  const VoxelColours colours = classColours(scene, threeClasses());
  const SceneView inside = lookAt({5.05, 3.05, 0.1}, {9, 3, 0}, 1.0, {64, 64});
  EXPECT_THROW(drawVoxels(scene, colours, inside, {}), InvalidParameterException);
  const SceneView view = angleView(scene, {}, {64, 64});
  EXPECT_THROW(drawVoxels(scene, {}, view, {}), InvalidParameterException);
  EXPECT_THROW(drawVoxels(VoxelScene(), {}, view, {}), InvalidParameterException);
  scene.voxels.cloud->points[3].label = 4;
  EXPECT_THROW(classColours(scene, threeClasses()), InvalidParameterException);
  scene.has_colour = false;
  EXPECT_THROW(measuredColours(scene), InvalidParameterException);
  EXPECT_THROW(entropyColours(scene), InvalidParameterException);
  EXPECT_THROW(changeColours(scene, {1, 2}, threeClasses()), InvalidParameterException);
}

TEST(VoxelColours, ChangesEqualAPlainLoop)
{
  const VoxelScene scene = street();
  const LabelSet label_set = threeClasses();
  const VoxelColours classes = classColours(scene, label_set);
  std::mt19937 random(1);
  std::vector<Label> before;
  std::map<std::string, int> kinds;
  int compared = 0, changed = 0;
  for (const auto& point : *scene.voxels.cloud) {
    before.push_back(Label(random() % 3 ? point.label : random() % 4));
    compared += before.back() != kUnlabelled;
    if (before.back() == kUnlabelled || before.back() == point.label)
      continue;
    ++changed;
    ++kinds[label_set[before.back()].name + " > " + label_set[Label(point.label)].name];
  }
  const VoxelColours colours = changeColours(scene, before, label_set);
  const cv::Vec3b grey = colours.legend.back().colour;
  for (std::size_t i = 0; i < before.size(); ++i)
    ASSERT_EQ(colours.colours[i],
              before[i] == kUnlabelled || before[i] == (*scene.voxels.cloud)[i].label
                  ? grey
                  : classes.colours[i]);
  ASSERT_EQ(colours.legend.size(), kinds.size() + 1);
  int last = changed;
  for (std::size_t i = 0; i < kinds.size(); ++i) { // the most frequent first
    const std::string& text = colours.legend[i].text;
    const std::size_t space = text.rfind(' ');
    const int count = kinds.at(text.substr(0, space));
    EXPECT_EQ(text.substr(space + 1), std::to_string(count));
    EXPECT_LE(count, last);
    last = count;
  }
  EXPECT_EQ(colours.note.rfind(grouped(changed) + " of " + grouped(compared) +
                                   " voxels changed their class",
                               0),
            0u)
      << colours.note;
}
