// SPDX-License-Identifier: BSD-3-Clause
#include "support/plain_map.h"
#include "support/random_scan.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/map/semantic_voxel_map.h>

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <set>
#include <tuple>

namespace {

using namespace pcl_semantic;
using Key = std::tuple<int, int, int>;

LabelSet
threeClasses()
{
  return LabelSet(
      {{"house", {200, 0, 0}}, {"sky", {0, 0, 200}, true}, {"road", {9, 9, 9}}});
}

SemanticVoxelMap::Parameters
smallWindow()
{
  SemanticVoxelMap::Parameters parameters;
  parameters.voxel_size = 0.25;
  parameters.window = {16.0, 16.0, 8.0};
  parameters.max_range = 6.0;
  return parameters;
}

Eigen::Isometry3d
poseAt(double x, double y, double z, double yaw = 0.0)
{
  Eigen::Isometry3d pose(
      Eigen::AngleAxisd(yaw, Eigen::Vector3d(0.1, 0.2, 1.0).normalized()));
  pose.translation() = Eigen::Vector3d(x, y, z);
  return pose;
}

void
expectEqual(const VoxelCloud& voxels, const std::map<Key, std::vector<float>>& expected)
{
  ASSERT_EQ(voxels.size(), expected.size());
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    const VoxelIndex& index = voxels.indices[i];
    const auto found = expected.find({index.x(), index.y(), index.z()});
    ASSERT_NE(found, expected.end()) << index.transpose();
    for (int k = 0; k < voxels.measured.classes(); ++k)
      EXPECT_NEAR(voxels.measured.matrix()(k, Eigen::Index(i)), found->second[k], 1e-4);
  }
}

TEST(SemanticVoxelMap, LabelsAddedLaterAreThoseOfTheScan)
{
  const LabelSet label_set({{"house", {200, 0, 0}}, {"road", {9, 9, 9}}});
  SemanticVoxelMap at_once(label_set, smallWindow()), later(label_set, smallWindow());
  for (int i = 0; i < 3; ++i) {
    const LabelledScan scan = makeRandomScan(3000, 5.0f, 2, unsigned(i));
    const Eigen::Isometry3d pose = poseAt(0.3 * i, 0.1, 0.0, 0.2 * i);
    at_once.integrate(scan.cloud, pose, scan.distributions);
    later.integrate(scan.cloud, pose);
    EXPECT_GT(later.addLabels(scan.cloud, pose, scan.distributions), 1000u);
  }
  const VoxelCloud expected = at_once.occupied(), voxels = later.occupied();
  ASSERT_EQ(voxels.size(), expected.size());
  EXPECT_TRUE(voxels.measured.matrix().isApprox(expected.measured.matrix(), 1e-5f));
}

TEST(SemanticVoxelMap, LabelsAddedLaterHaveTheSameWeights)
{
  const LabelSet label_set({{"house", {200, 0, 0}}, {"road", {9, 9, 9}}});
  SemanticVoxelMap at_once(label_set, smallWindow()), later(label_set, smallWindow());
  at_once.setDepthError(0.02);
  later.setDepthError(0.02);
  for (int i = 0; i < 3; ++i) {
    const LabelledScan scan = makeRandomScan(3000, 5.0f, 2, unsigned(i));
    const Eigen::Isometry3d pose = poseAt(0.3 * i, 0.1, 0.0, 0.2 * i);
    at_once.integrate(scan.cloud, pose, scan.distributions);
    later.integrate(scan.cloud, pose);
    later.addLabels(scan.cloud, pose, scan.distributions);
  }
  const VoxelCloud expected = at_once.occupied(), voxels = later.occupied();
  ASSERT_EQ(voxels.size(), expected.size());
  EXPECT_TRUE(voxels.measured.matrix().isApprox(expected.measured.matrix(), 1e-5f));
}

TEST(SemanticVoxelMap, LabelsWeighByThePrecisionOfTheirDepthsAsInAPlainMap)
{
  const LabelSet label_set({{"house", {200, 0, 0}}, {"road", {9, 9, 9}}});
  SemanticVoxelMap::Parameters parameters = smallWindow();
  parameters.window = {24.0, 24.0, 24.0};
  constexpr double depth_error = 0.02; // [1/m]
  SemanticVoxelMap map(label_set, parameters), even(label_set, parameters);
  PlainMap plain(label_set, parameters);
  map.setDepthError(depth_error);
  for (int i = 0; i < 6; ++i) {
    const LabelledScan scan = makeRandomScan(2000, 3.0f, 2, unsigned(i));
    const Eigen::Isometry3d pose = poseAt(0.5 * i, -0.05 * i, 0.02 * i, 0.3 * i);
    map.integrate(scan.cloud, pose, scan.distributions);
    even.integrate(scan.cloud, pose, scan.distributions);
    plain.integrate(scan, pose, depth_error);
  }
  const VoxelCloud voxels = map.occupied();
  expectEqual(voxels, plain.occupied());
  EXPECT_FALSE(
      voxels.measured.matrix().isApprox(even.occupied().measured.matrix(), 0.01f));
}

// A far look and a near one disagree.
TEST(SemanticVoxelMap, TheNearLookDecidesWhetherItComesFirstOrLast)
{
  const LabelSet label_set({{"house", {200, 0, 0}}, {"road", {9, 9, 9}}});
  pcl::PointCloud<pcl::PointXYZ> far, near;
  far.push_back({4.6f, 0.1f, 0.1f});
  near.push_back({1.6f, 0.1f, 0.1f});
  LabelDistributions house(2, 1), road(2, 1);
  house.setLabel(0, 1, 0.9f);
  road.setLabel(0, 2, 0.7f);
  const Eigen::Isometry3d from_far = poseAt(0, 0, 0), from_near = poseAt(3.0, 0, 0);
  for (const bool is_near_first : {true, false}) {
    SemanticVoxelMap map(label_set, smallWindow());
    map.setDepthError(0.01);
    for (const bool is_near : {is_near_first, !is_near_first})
      map.integrate(is_near ? near : far, is_near ? from_near : from_far,
                    is_near ? road : house);
    EXPECT_EQ(map.labels({{4.6, 0.1, 0.1}})[0], 2) << is_near_first;
    map.setDepthError(0.0); // exact: also the first look of this kind counts most
    map.integrate(far, from_far, house);
    EXPECT_EQ(map.labels({{4.6, 0.1, 0.1}})[0], 1);
  }
}

TEST(SemanticVoxelMap, PointsAtTheSensorAreNoReturns)
{
  const LabelSet label_set({{"house", {200, 0, 0}}, {"road", {9, 9, 9}}});
  SemanticVoxelMap map(label_set, smallWindow());
  pcl::PointCloud<pcl::PointXYZ> scan;
  scan.push_back({2.0f, 0.5f, 0.5f});
  for (int i = 0; i < 20; ++i)
    scan.push_back({0.0f, -0.0f, 0.0f});
  LabelDistributions labels(2, 21);
  for (int i = 0; i < 21; ++i)
    labels.setLabel(i, 1, 0.9f);
  const Eigen::Isometry3d pose = poseAt(0.1, 0.1, 0.1);
  const ScanCounts counts = map.integrate(scan, pose, labels);
  EXPECT_EQ(counts.points, 21u);
  EXPECT_EQ(counts.rays, 1u);
  EXPECT_EQ(counts.invalid, 20u);
  EXPECT_EQ(map.occupied().size(), 1u);
  EXPECT_EQ(map.addLabels(scan, pose, labels), 1u);
}

TEST(SemanticVoxelMap, EqualsAPlainMapOverSeveralScans)
{
  const LabelSet label_set = threeClasses();
  SemanticVoxelMap::Parameters parameters = smallWindow();
  parameters.window = {24.0, 24.0,
                       24.0}; // holds every ray: the plain map has no window
  SemanticVoxelMap map(label_set, parameters);
  PlainMap plain(label_set, parameters);
  for (int i = 0; i < 6; ++i) {
    const LabelledScan scan = makeRandomScan(400, 7.0f, 3, unsigned(i));
    const Eigen::Isometry3d pose = poseAt(0.1 * i, -0.05 * i, 0.02 * i, 0.3 * i);
    map.integrate(scan.cloud, pose, scan.distributions);
    plain.integrate(scan, pose);
  }
  const VoxelCloud occupied = map.occupied();
  expectEqual(occupied, plain.occupied());
  for (std::size_t i = 0; i < occupied.size(); ++i) {
    const VoxelIndex& voxel = occupied.indices[i];
    const Eigen::Vector3d expected =
        voxel.cast<double>() + plain.position({voxel.x(), voxel.y(), voxel.z()});
    const Eigen::Vector3d position =
        (*occupied.cloud)[i].getVector3fMap().cast<double>() / 0.25;
    // Hits are rounded to 2^-10 of a voxel.
    EXPECT_LT((position - expected).cwiseAbs().maxCoeff(), 1e-3)
        << position.transpose() << " instead of " << expected.transpose();
    const VoxelState state = map.state(voxel.cast<double>() * 0.25);
    EXPECT_LT((state.position / 0.25 - position).cwiseAbs().maxCoeff(), 1e-5);
  }
  int free_voxels = 0;
  for (const auto& [key, log_odds] : plain.logOdds()) {
    const auto& [x, y, z] = key;
    const Eigen::Vector3d centre = (Eigen::Vector3d(x, y, z).array() + 0.5) * 0.25;
    const Occupancy expected =
        plain.isOccupied(log_odds) ? Occupancy::occupied : Occupancy::free;
    free_voxels += expected == Occupancy::free;
    ASSERT_EQ(map.occupancy(centre), expected) << x << " " << y << " " << z;
  }
  EXPECT_GT(free_voxels, 1000);
  EXPECT_EQ(map.occupancy({11.9, 11.9, 11.9}), Occupancy::unknown);
}

// Everything a cloud holds, byte for byte.
void
expectIdentical(const VoxelCloud& a, const VoxelCloud& b)
{
  ASSERT_EQ(a.size(), b.size());
  EXPECT_TRUE(a.measured.matrix() == b.measured.matrix());
  EXPECT_EQ(a.observations, b.observations);
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(a.indices[i], b.indices[i]);
    ASSERT_EQ((*a.cloud)[i].getVector3fMap(), (*b.cloud)[i].getVector3fMap());
    ASSERT_EQ((*a.cloud)[i].rgba, (*b.cloud)[i].rgba);
    ASSERT_EQ((*a.cloud)[i].label, (*b.cloud)[i].label);
  }
}

// All that a map keeps: of every block its occupancy, and of its records what there is
// at each offset (they may lie in another order).
std::vector<double>
contentOf(const SemanticVoxelMap& map)
{
  std::vector<double> content;
  const std::size_t classes = std::size_t(map.labelSet().size());
  map.forEachBlock([&](const VoxelIndex& index, const VoxelBlock& block) {
    content.insert(content.end(), index.begin(), index.end());
    content.insert(content.end(), block.log_odds.begin(), block.log_odds.end());
    for (int offset = 0; offset < kBlockVoxels; ++offset) {
      const int row = block.recordAt(offset);
      if (row == VoxelBlock::kNoRecord)
        continue;
      const VoxelRecord& record = block.records[std::size_t(row)];
      const auto measured = block.measured.begin() + long(row * classes);
      content.push_back(offset);
      content.insert(content.end(), record.colour_sum.begin(), record.colour_sum.end());
      content.insert(content.end(),
                     {double(record.colour_count), double(record.observations),
                      double(record.label_observations)});
      content.insert(content.end(), record.position.begin(), record.position.end());
      content.insert(content.end(), measured, measured + long(classes));
    }
  });
  return content;
}

// Scans of more points than a thread takes at a time, with and without deviations.
TEST(SemanticVoxelMap, OrderOfPointsAndNumberOfThreadsDoNotMatter)
{
  for (const bool with_deviations : {false, true}) {
    std::vector<std::vector<double>> results;
    for (const int threads : {1, 2, 7}) {
      SemanticVoxelMap map(threeClasses(), smallWindow());
      map.setNumberOfThreads(threads);
      for (unsigned scan = 0; scan < 2; ++scan) {
        const LabelledScan points = shuffled(makeRandomScan(50000, 7.0f, 3, scan),
                                             scan + 10 * unsigned(threads));
        std::vector<float> deviations;
        for (std::size_t i = 0; with_deviations && i < points.cloud.size(); ++i)
          deviations.push_back(0.05f * std::abs(points.cloud[i].x));
        map.integrate(points.cloud, poseAt(0.3 * scan, 0, 0), points.distributions,
                      deviations);
      }
      results.push_back(contentOf(map));
    }
    EXPECT_GT(results[0].size(), 100000u);
    EXPECT_TRUE(results[0] == results[1]);
    EXPECT_TRUE(results[0] == results[2]);
  }
}

TEST(SemanticVoxelMap, AVoxelThatLeavesTheWindowComesBack)
{
  const LabelledScan scan = makeRandomScan(2000, 5.0f, 3, 3);
  SemanticVoxelMap map(threeClasses(), smallWindow());
  map.integrate(scan.cloud, poseAt(0, 0, 0), scan.distributions);
  const VoxelCloud before = map.occupied();
  const pcl::PointCloud<pcl::PointXYZRGB> nothing;
  map.integrate(nothing, poseAt(100, -50, 3));
  EXPECT_EQ(map.occupied().size(), 0u);
  expectIdentical(before, map.occupiedEverywhere());
  map.integrate(nothing, poseAt(0, 0, 0));
  expectIdentical(before, map.occupied());
}

// Small steps, and now and then a jump beyond the window; every voxel of the map, free
// ones too, against one that is unbounded.
void
walk(const Eigen::Vector3d& start)
{
  SemanticVoxelMap::Parameters parameters = smallWindow();
  parameters.max_range = 3.0;
  parameters.window = {13.0, 13.0, 13.0};
  SemanticVoxelMap map(threeClasses(), parameters);
  PlainMap plain(threeClasses(), parameters);
  std::mt19937 random(8);
  std::uniform_real_distribution<double> step(-2.5, 2.5);
  Eigen::Vector3d position = start;
  for (unsigned i = 0; i < 120; ++i) {
    const double reach = i % 20 == 19 ? 20.0 : 1.0;
    position += reach * Eigen::Vector3d(step(random), step(random), step(random));
    if (i % 30 == 29)
      position = start; // returns to voxels that left the window
    const LabelledScan scan = makeRandomScan(60, 4.0f, 3, i);
    const Eigen::Isometry3d pose =
        poseAt(position.x(), position.y(), position.z(), 0.1 * i);
    map.integrate(scan.cloud, pose, scan.distributions);
    plain.integrate(scan, pose);
  }
  expectEqual(map.occupiedEverywhere(), plain.occupied());
  expectSameOccupancy(map, plain);
}

TEST(SemanticVoxelMap, ALongWalkEqualsAnUnboundedMapAlsoFarAway)
{
  walk({0.0, 0.0, 0.0});
  walk({1e6, -1e6, 1e5});
}

TEST(SemanticVoxelMap, AThousandKilometresAwayTheMapIsTheSame)
{
  const LabelledScan scan = makeRandomScan(2000, 5.0f, 3, 4);
  SemanticVoxelMap near(threeClasses(), smallWindow());
  SemanticVoxelMap far(threeClasses(), smallWindow());
  near.integrate(scan.cloud, poseAt(0, 0, 0), scan.distributions);
  far.integrate(scan.cloud, poseAt(1e6, -1e6, 0), scan.distributions);
  const VoxelCloud a = near.occupied(), b = far.occupied();
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(a.indices[i] + VoxelIndex(4000000, -4000000, 0), b.indices[i]);
    ASSERT_EQ((*a.cloud)[i].getVector3fMap(), (*b.cloud)[i].getVector3fMap());
  }
  EXPECT_EQ(b.origin, Eigen::Vector3d(1e6, -1e6, 0));
}

TEST(SemanticVoxelMap, AHitWinsOverAMissOfTheSameScan)
{
  // Two points on one ray: the far one's ray goes through the near one's voxel.
  pcl::PointCloud<pcl::PointXYZ> cloud;
  cloud.push_back({2.0f, 0.1f, 0.1f});
  cloud.push_back({4.0f, 0.2f, 0.2f});
  SemanticVoxelMap::Parameters parameters = smallWindow();
  parameters.fusion.clearing = Clearing::full;
  SemanticVoxelMap map(threeClasses(), parameters);
  const ScanCounts counts = map.integrate(cloud, poseAt(0, 0, 0));
  EXPECT_EQ(counts.hit_voxels, 2u);
  EXPECT_EQ(map.occupancy({2.0, 0.1, 0.1}), Occupancy::occupied);
  EXPECT_EQ(map.occupancy({3.0, 0.15, 0.15}), Occupancy::free);
  EXPECT_EQ(map.occupancy({5.0, 0.2, 0.2}), Occupancy::unknown);
  EXPECT_EQ(map.labels({{2.0, 0.1, 0.1}})[0], kUnlabelled);
}

TEST(SemanticVoxelMap, PointsBeyondTheRangeOnlyClear)
{
  pcl::PointCloud<pcl::PointXYZ> cloud;
  cloud.push_back({50.0f, 0.1f, 0.1f});
  SemanticVoxelMap map(threeClasses(), smallWindow());
  EXPECT_EQ(map.integrate(cloud, poseAt(0, 0, 0)).hit_voxels, 0u);
  EXPECT_EQ(map.occupied().size(), 0u);
  EXPECT_EQ(map.occupancy({5.9, 0.01, 0.01}), Occupancy::free);
  EXPECT_EQ(map.occupancy({6.3, 0.01, 0.01}), Occupancy::unknown);
}

TEST(SemanticVoxelMap, BadPointsAndSkyAreCountedAndSkipped)
{
  LabelledScan scan = makeRandomScan(5, 5.0f, 3, 5);
  scan.cloud[0].x = std::nanf("");
  scan.cloud[1].y = INFINITY;
  scan.cloud[2].z = 1e30f;
  for (int i = 0; i < 5; ++i)
    scan.distributions.setLabel(i, i == 3 ? 2 : 1, 0.9f);
  SemanticVoxelMap map(threeClasses(), smallWindow());
  const ScanCounts counts =
      map.integrate(scan.cloud, poseAt(0, 0, 0), scan.distributions);
  EXPECT_EQ(counts.points, 5u);
  EXPECT_EQ(counts.invalid, 3u);
  EXPECT_EQ(counts.sky, 1u);
  EXPECT_EQ(counts.rays, 1u);
  EXPECT_EQ(map.occupied().size(), 1u);
}

// No sky: the same rays with labels and without.
LabelledScan
makeScanOfOneClass()
{
  LabelledScan scan = makeRandomScan(500, 5.0f, 3, 6);
  for (Eigen::Index i = 0; i < scan.distributions.size(); ++i)
    scan.distributions.setLabel(i, 1, 0.6f);
  return scan;
}

// Takes every occupied voxel for class 3; gives the distributions.
LabelDistributions
refineAll(SemanticVoxelMap& map)
{
  const VoxelCloud voxels = map.occupied();
  LabelDistributions refined(3, Eigen::Index(voxels.size()));
  for (Eigen::Index i = 0; i < refined.size(); ++i)
    refined.setLabel(i, 3, 0.8f);
  map.setRefined(voxels, refined);
  return refined;
}

TEST(SemanticVoxelMap, RefinedDistributionsAreReadAndMeasurementsKept)
{
  const LabelledScan scan = makeRandomScan(500, 5.0f, 3, 6);
  SemanticVoxelMap map(threeClasses(), smallWindow());
  map.integrate(scan.cloud, poseAt(0, 0, 0), scan.distributions);
  const VoxelCloud before = map.occupied();
  const LabelDistributions refined = refineAll(map);
  const VoxelCloud after = map.occupied();
  EXPECT_TRUE(after.measured.matrix() == before.measured.matrix());
  EXPECT_TRUE(after.refined.matrix() == refined.matrix());
  const Eigen::Vector3d first = (before.indices[0].cast<double>().array() + 0.5) * 0.25;
  EXPECT_EQ(map.labels({first})[0], 3);
  EXPECT_THROW(map.setRefined(before, LabelDistributions(3, 1)),
               InvalidParameterException);
  for (const float bad : {std::nanf(""), INFINITY, -0.1f, 1.1f}) {
    LabelDistributions spoilt = refined;
    spoilt.matrix()(1, 7) = bad;
    EXPECT_THROW(map.setRefined(before, spoilt), InvalidParameterException) << bad;
  }
  EXPECT_TRUE(map.occupied().refined.matrix() == refined.matrix());
}

TEST(SemanticVoxelMap, RefinedDistributionsTakeThePlaceOfMeasurementsOnRequest)
{
  const LabelledScan scan = makeScanOfOneClass();
  MapParameters parameters = smallWindow();
  parameters.fusion.label_max_ratio = 100.0;
  SemanticVoxelMap map(threeClasses(), parameters);
  map.integrate(scan.cloud, poseAt(0, 0, 0), scan.distributions);
  const VoxelCloud before = map.occupied();
  ASSERT_GT(before.size(), 2u);
  LabelDistributions refined(3, Eigen::Index(before.size()));
  refined.matrix().colwise() = Eigen::Vector3f(0.25f, 0.75f, 0.0f);
  refined.matrix().col(1).setZero(); // the CRF has no label for it
  map.setRefined(before, refined, true);
  const VoxelCloud after = map.occupied();
  EXPECT_EQ(after.refined.matrix().col(0), refined.matrix().col(0));
  EXPECT_EQ(after.measured.matrix().col(1), before.measured.matrix().col(1));
  // 0 is raised to a hundredth of the largest.
  const Eigen::Vector3f expected =
      Eigen::Vector3f(0.25f, 0.75f, 0.0075f) / (0.25f + 0.75f + 0.0075f);
  EXPECT_LT((after.measured.matrix().col(0) - expected).cwiseAbs().maxCoeff(), 1e-5f);

  // It is the prior of the next scan: eq. (1) by hand.
  map.integrate(scan.cloud, poseAt(0, 0, 0), scan.distributions);
  const Eigen::Vector3f likelihood = before.measured.matrix().col(0);
  Eigen::Vector3f product = expected.cwiseProduct(likelihood);
  product /= product.sum();
  EXPECT_LT((map.occupied().measured.matrix().col(0) - product).cwiseAbs().maxCoeff(),
            1e-4f);
}

TEST(SemanticVoxelMap, ANewMeasurementOfLabelsVoidsTheRefinement)
{
  const LabelledScan scan = makeScanOfOneClass();
  LabelledScan unlabelled = scan;
  unlabelled.distributions.matrix().setZero();
  SemanticVoxelMap map(threeClasses(), smallWindow());
  map.integrate(scan.cloud, poseAt(0, 0, 0), scan.distributions);
  const LabelDistributions refined = refineAll(map);
  map.integrate(scan.cloud, poseAt(0, 0, 0)); // no labels: nothing new is known of them
  EXPECT_TRUE(map.occupied().refined.matrix() == refined.matrix());
  map.integrate(scan.cloud, poseAt(0, 0, 0), unlabelled.distributions);
  EXPECT_TRUE(map.occupied().refined.matrix() == refined.matrix());
  map.integrate(scan.cloud, poseAt(0, 0, 0), scan.distributions);
  const VoxelCloud after = map.occupied();
  EXPECT_TRUE(after.refined.matrix() == after.measured.matrix());
}

// Log-probabilities would give another class than the most probable one.
TEST(SemanticVoxelMap, TakesProbabilitiesAlone)
{
  const LabelSet label_set({{"road", {}}, {"wall", {}}, {"car", {}}});
  const Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pcl::PointCloud<pcl::PointXYZ> cloud;
  LabelDistributions good(3, 50);
  for (int i = 0; i < 50; ++i) {
    cloud.push_back({5.05f, 0.1f * float(i) + 0.05f, 0.55f});
    good.setLabel(i, 2, 0.8f);
  }
  const Eigen::Vector3d place(5.05, 0.05, 0.55);
  SemanticVoxelMap map(label_set, {});
  map.integrate(cloud, pose, good);
  for (const float bad : {-0.1f, std::nanf(""), std::numeric_limits<float>::infinity(),
                          -std::numeric_limits<float>::infinity()}) {
    LabelDistributions distributions = good;
    distributions.matrix()(2, 17) = bad;
    for (const auto& take : std::vector<std::function<void()>>{
             [&] { map.integrate(cloud, pose, distributions); },
             [&] { map.addLabels(cloud, pose, distributions); }})
      expectBadInput("of point 17 has a negative or non-finite probability", take);
  }
  LabelDistributions zeros = good;
  zeros.matrix().col(3).setConstant(-0.0f); // unlabelled
  map.integrate(cloud, pose, zeros);
  EXPECT_EQ(map.labels({place})[0], 2);
  EXPECT_THROW(map.integrate(cloud, pose, LabelDistributions(3, 0)),
               InvalidParameterException);
}

TEST(SemanticVoxelMap, RefusesWhatDoesNotFit)
{
  const LabelledScan scan = makeRandomScan(10, 5.0f, 3, 7);
  SemanticVoxelMap map(threeClasses(), smallWindow());
  EXPECT_THROW(map.integrate(scan.cloud, poseAt(0, 0, 0), LabelDistributions(3, 9)),
               InvalidParameterException);
  EXPECT_THROW(map.integrate(scan.cloud, poseAt(0, 0, 0), LabelDistributions(4, 10)),
               InvalidParameterException);
  EXPECT_THROW(map.integrate(scan.cloud, poseAt(std::nan(""), 0, 0)),
               BadInputException);
  EXPECT_THROW(map.integrate(scan.cloud, poseAt(1e30, 0, 0)), BadInputException);
  Eigen::Isometry3d scaled = poseAt(0, 0, 0), mirrored = scaled;
  scaled.linear() *= 1.01;
  mirrored.linear().col(1) *= -1.0;
  EXPECT_THROW(map.integrate(scan.cloud, scaled), BadInputException);
  EXPECT_THROW(map.integrate(scan.cloud, mirrored), BadInputException);
  for (const double voxel_size : {0.0, -1.0, 1e-9, std::nan("")}) {
    SemanticVoxelMap::Parameters parameters = smallWindow();
    parameters.voxel_size = voxel_size;
    EXPECT_THROW(SemanticVoxelMap(threeClasses(), parameters),
                 InvalidParameterException);
  }
}

} // namespace
