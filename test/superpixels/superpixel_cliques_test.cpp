// SPDX-License-Identifier: BSD-3-Clause
#include "support/clique_lists.h"
#include "support/plain_surface_parts.h"
#include "support/street_scans.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/stereo/disparity_to_cloud.h>
#include <pcl_semantic/superpixels/superpixel_cliques.h>

#include <gtest/gtest.h>
#include <pcl/common/io.h>

#include <algorithm>
#include <map>
#include <memory>

using namespace pcl_semantic;

namespace {

using Cloud = CliqueGenerator::Cloud;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

// The street, and its map after each frame.
class SuperpixelsOfAStreet : public testing::Test {
protected:
  static constexpr int frames = 4;

  static void
  SetUpTestSuite()
  {
    scans_ = makeStreetScans(frames, 310, 94);
    map_ = std::make_unique<SemanticVoxelMap>(
        readLabelSet(PCL_SEMANTIC_SOURCE_DIR "/data/label_sets/kitti11.yaml"),
        SemanticVoxelMap::Parameters());
    for (const StreetScan& scan : scans_) {
      map_->integrate(*scan.cloud, scan.T_world_camera, scan.distributions);
      voxels_.push_back(map_->occupied());
    }
  }

  static void
  TearDownTestSuite()
  {
    scans_.clear();
    voxels_.clear();
    map_.reset();
  }

  static Cloud
  pointsOf(const VoxelCloud& voxels)
  {
    Cloud points;
    pcl::copyPointCloud(*voxels.cloud, points);
    return points;
  }

  static Cliques
  cliquesOf(SuperpixelCliques& generator, int frame)
  {
    const StreetScan& scan = scans_[std::size_t(frame)];
    const VoxelCloud& voxels = voxels_[std::size_t(frame)];
    generator.setFrame(scan.cloud, scan.T_world_camera);
    generator.setVoxels(voxels.indices, voxels.voxel_size);
    return listsOf(generator.generate(pointsOf(voxels)));
  }

  static std::vector<StreetScan> scans_;
  static std::vector<VoxelCloud> voxels_;
  static std::unique_ptr<SemanticVoxelMap> map_;
};

std::vector<StreetScan> SuperpixelsOfAStreet::scans_;
std::vector<VoxelCloud> SuperpixelsOfAStreet::voxels_;
std::unique_ptr<SemanticVoxelMap> SuperpixelsOfAStreet::map_;

// The same by maps and counting; remembers everything that was ever seen.
class PlainSuperpixels {
public:
  PlainSuperpixels(const SuperpixelParameters& parameters, const SemanticVoxelMap& map)
      : parameters_(parameters), map_(map)
  {}

  Cliques
  add(const StreetScan& scan, const VoxelCloud& voxels)
  {
    const cv::Mat segments =
        slicSuperpixels(imageOfCloud(*scan.cloud), parameters_.slic);
    const PlainSurfaceParts parts(
        segments, *scan.cloud, {parameters_.passing_distance, 2 * voxels.voxel_size});
    std::map<VoxelIndex, std::map<int, int>, VoxelIndexLess> votes;
    for (std::size_t i = 0; i < scan.cloud->size(); ++i)
      if (const int part = parts.numbers()[i]; part >= 0)
        ++votes[map_.voxelOf(scan.T_world_camera *
                             (*scan.cloud)[i].getVector3fMap().cast<double>())][part];
    ++frame_;
    if (!parameters_.keep)
      seen_.clear();
    for (const auto& [voxel, counts] : votes) {
      const auto most = std::max_element(
          counts.begin(), counts.end(),
          [](const auto& a, const auto& b) { return a.second < b.second; });
      seen_[voxel] = {frame_, most->first};
    }
    std::map<std::pair<int, int>, std::vector<int>> members;
    for (std::size_t i = 0; i < voxels.size(); ++i)
      if (const auto found = seen_.find(voxels.indices[i]); found != seen_.end())
        members[found->second].push_back(int(i));
    Cliques cliques;
    for (const auto& [name, clique] : members)
      if (int(clique.size()) >= parameters_.min_voxels)
        cliques.push_back(clique);
    std::sort(cliques.begin(), cliques.end()); // by their first points
    return cliques;
  }

private:
  SuperpixelParameters parameters_;
  const SemanticVoxelMap& map_;
  int frame_ = 0;
  std::map<VoxelIndex, std::pair<int, int>, VoxelIndexLess> seen_; // frame, part
};

SuperpixelParameters
someParameters(bool keep, int superpixels = 60)
{
  SuperpixelParameters parameters;
  parameters.keep = keep;
  parameters.slic.superpixels = superpixels;
  return parameters;
}

} // namespace

TEST_F(SuperpixelsOfAStreet, VoxelsJoinThePartThatMostOfTheirPixelsSee)
{
  for (const bool keep : {false, true}) {
    SuperpixelParameters parameters = someParameters(keep);
    for (const int min_voxels : {1, 2, 20}) {
      parameters.min_voxels = min_voxels;
      SuperpixelCliques generator(parameters);
      PlainSuperpixels plain(parameters, *map_);
      for (int i = 0; i < frames; ++i) {
        const Cliques expected =
            plain.add(scans_[std::size_t(i)], voxels_[std::size_t(i)]);
        EXPECT_EQ(cliquesOf(generator, i), expected)
            << "frame " << i << ", keep " << keep;
        EXPECT_GT(expected.size(), 40u);
      }
    }
  }
}

TEST_F(SuperpixelsOfAStreet, WhatIsKeptGroupsMoreVoxels)
{
  SuperpixelCliques forgetful(someParameters(false)), keeping(someParameters(true));
  cliquesOf(keeping, 0);
  const std::size_t kept = membersOf(cliquesOf(keeping, 3));
  const std::size_t seen = membersOf(cliquesOf(forgetful, 3));
  EXPECT_GT(double(kept), 1.05 * double(seen));
}

TEST_F(SuperpixelsOfAStreet, VoxelsThatLeaveTheCloudAreForgotten)
{
  SuperpixelCliques generator(someParameters(true));
  const Cliques before = cliquesOf(generator, 1);
  generator.setFrame(nullptr, Eigen::Isometry3d::Identity());
  const VoxelCloud& voxels = voxels_[1];
  EXPECT_TRUE(listsOf(generator.generate(pointsOf(voxels))) ==
              before); // nothing but kept
  generator.setVoxels({}, voxels.voxel_size);
  EXPECT_TRUE(generator.generate(Cloud()).empty());
  generator.setVoxels(voxels.indices, voxels.voxel_size);
  EXPECT_TRUE(generator.generate(pointsOf(voxels)).empty());
}

TEST_F(SuperpixelsOfAStreet, PointsOfOneVoxelShareASuperpixel)
{
  const VoxelCloud& voxels = voxels_[0];
  std::vector<VoxelIndex> twice = voxels.indices;
  twice.insert(twice.end(), voxels.indices.begin(), voxels.indices.end());
  Cloud points = pointsOf(voxels);
  points += Cloud(points);
  SuperpixelCliques generator(someParameters(false));
  const Cliques once = cliquesOf(generator, 0);
  generator.setVoxels(twice, voxels.voxel_size);
  for (const auto& clique : generator.generate(points)) {
    ASSERT_EQ(clique.indices.size() % 2, 0u);
    const std::size_t half = clique.indices.size() / 2;
    for (std::size_t i = 0; i < half; ++i)
      EXPECT_EQ(clique.indices[i] + int(voxels.size()), clique.indices[half + i]);
    const std::vector<int> first(clique.indices.begin(),
                                 clique.indices.begin() + std::ptrdiff_t(half));
    EXPECT_TRUE(half == 1 || std::count(once.begin(), once.end(), first) == 1);
  }
}

TEST_F(SuperpixelsOfAStreet, PointsThatAreNotFiniteAreInNone)
{
  SuperpixelCliques generator(someParameters(false));
  const Cliques all = cliquesOf(generator, 2);
  Cloud points = pointsOf(voxels_[2]);
  const int lost = all.front().front();
  points[std::size_t(lost)].y = kNaN;
  Cliques fewer = all;
  fewer.front().erase(fewer.front().begin());
  EXPECT_TRUE(listsOf(generator.generate(points)) == fewer);
}

TEST_F(SuperpixelsOfAStreet, TheNumberOfThreadsChangesNothing)
{
  SuperpixelCliques generator(someParameters(false, 150));
  setNumberOfThreads(1);
  const Cliques expected = cliquesOf(generator, 3);
  for (const int threads : {2, 7}) {
    setNumberOfThreads(threads);
    EXPECT_TRUE(cliquesOf(generator, 3) == expected) << threads;
  }
  setNumberOfThreads(0);
}

TEST_F(SuperpixelsOfAStreet, AFrameThatSeesNothingGivesNoClique)
{
  SuperpixelCliques generator(someParameters(false));
  cliquesOf(generator, 0);
  Eigen::Isometry3d elsewhere = scans_[0].T_world_camera;
  elsewhere.pretranslate(Eigen::Vector3d(0.0, 0.0, 1e5));
  generator.setFrame(scans_[0].cloud, elsewhere);
  EXPECT_TRUE(generator.generate(pointsOf(voxels_[0])).empty());
  elsewhere.pretranslate(Eigen::Vector3d(0.0, 0.0, 1e30)); // beyond all indices
  generator.setFrame(scans_[0].cloud, elsewhere);
  EXPECT_TRUE(generator.generate(pointsOf(voxels_[0])).empty());
  const auto blind = std::make_shared<Cloud>(*scans_[0].cloud);
  for (pcl::PointXYZRGB& point : *blind)
    point.z = kNaN;
  generator.setFrame(blind, scans_[0].T_world_camera);
  EXPECT_TRUE(generator.generate(pointsOf(voxels_[0])).empty());
  generator.setFrame(std::make_shared<Cloud>(), scans_[0].T_world_camera);
  EXPECT_TRUE(generator.generate(pointsOf(voxels_[0])).empty());
}

TEST_F(SuperpixelsOfAStreet, RefusesWhatDoesNotFit)
{
  SuperpixelCliques generator;
  EXPECT_FALSE(generator.usesColour()); // of the voxels
  expectBadParameter("0 voxels", [&] { generator.generate(pointsOf(voxels_[0])); });
  const auto list = std::make_shared<Cloud>(*scans_[0].cloud);
  list->width = unsigned(list->size());
  list->height = 1;
  expectBadInput("organized",
                 [&] { generator.setFrame(list, Eigen::Isometry3d::Identity()); });
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation().y() = double(kNaN);
  thrownMessage<BadInputException>([&] { generator.setFrame(scans_[0].cloud, pose); });
  for (const double size : {0.0, -1.0, double(kNaN)})
    thrownMessage<InvalidParameterException>([&] { generator.setVoxels({}, size); });
  SuperpixelParameters parameters;
  parameters.min_voxels = 0;
  expectBadParameter("min_voxels", [&] { SuperpixelCliques other(parameters); });
}
