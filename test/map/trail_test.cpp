// SPDX-License-Identifier: BSD-3-Clause

// Trails of driving cars on the synthetic street, and the voxels of standing cars.

#include "support/street_scans.h"

#include <pcl_semantic/stereo/disparity_engines.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <set>
#include <tuple>
#include <vector>

namespace pcl_semantic {

namespace {

constexpr int kFrames = 16, kLast = kFrames - 1;
constexpr int kWidth = 620, kHeight = 188;
constexpr double kVoxel = 0.2;

/** \brief A car ahead of the camera, and one that passes it in frame 11. */
std::vector<DrivingCar>
drivingCars()
{
  const double lane = synthetic::Street::lane;
  return {{{12.0, lane}, 1.0}, {{20.0, -lane}, -0.9}};
}

/** \brief The same cars at their last positions. */
std::vector<DrivingCar>
standingCars()
{
  std::vector<DrivingCar> cars = drivingCars();
  for (DrivingCar& car : cars) {
    car.start.s += car.speed * kLast;
    car.speed = 0.0;
  }
  return cars;
}

struct RenderedStreet {
  explicit RenderedStreet(const std::vector<DrivingCar>& traffic)
      : scene(1, kFrames, traffic)
  {
    const SyntheticRenderer renderer(scene, kWidth, kHeight);
    for (int frame = 0; frame < kFrames; ++frame)
      views.push_back(renderer.render(frame));
  }

  SyntheticScene scene;
  std::vector<SyntheticView> views;
};

const RenderedStreet&
drivingStreet()
{
  static const RenderedStreet street(drivingCars());
  return street;
}

LabelDistributions
trueLabels(const SyntheticView& view)
{
  LabelDistributions labels(synthetic_classes, Eigen::Index(view.labels.total()));
  for (std::size_t pixel = 0; pixel < view.labels.total(); ++pixel)
    labels.setLabel(Eigen::Index(pixel), view.labels.ptr<Label>()[pixel], 0.9f);
  return labels;
}

enum class Depth { exact, stereo };

/** \brief The map of a street with true labels. */
std::shared_ptr<SemanticVoxelMap>
mapOf(const RenderedStreet& street, Depth depth, bool free_dynamic = true)
{
  SemanticVoxelMap::Parameters parameters;
  parameters.voxel_size = kVoxel;
  if (depth == Depth::stereo)
    parameters.max_range = 20.0; // voxels beyond 22.7 m are too uncertain to be freed
  parameters.fusion.free_dynamic = free_dynamic;
  auto map = std::make_shared<SemanticVoxelMap>(
      readLabelSet(std::string(PCL_SEMANTIC_SOURCE_DIR) +
                   "/data/label_sets/kitti11.yaml"),
      parameters);
  const auto stereo = makeDisparityEstimator("sgm", 128);
  for (const SyntheticView& view : street.views) {
    cv::Mat disparity = view.disparity;
    if (depth == Depth::stereo) {
      map->setDepthError(view.camera.depthError());
      disparity = stereo->estimate(view.left, view.right).disparity;
    }
    map->integrate(*disparityToCloud(disparity, view.left, view.camera),
                   view.T_world_camera, trueLabels(view));
  }
  return map;
}

/** \brief Centres of the occupied voxels of class car, world frame [m]. */
std::vector<Eigen::Vector3d>
carVoxels(const SemanticVoxelMap& map)
{
  const VoxelCloud voxels = map.occupiedEverywhere();
  std::vector<Eigen::Vector3d> centres;
  for (std::size_t i = 0; i < voxels.size(); ++i)
    if ((*voxels.cloud)[i].label == synthetic_car)
      centres.push_back(centreOf(voxels.indices[i], kVoxel));
  return centres;
}

/** \brief Distance to the nearest car [m]. */
double
distanceToCars(const std::vector<SyntheticCar>& cars, const Eigen::Vector3d& point)
{
  double distance = std::numeric_limits<double>::infinity();
  for (const SyntheticCar& car : cars)
    distance = std::min(distance, car.distance(point));
  return distance;
}

/** \brief Whether a point is in the image and before its surface. */
bool
isInView(const SyntheticView& view, const Eigen::Vector3d& point)
{
  const Eigen::Vector3d seen = view.T_world_camera.inverse() * point;
  if (seen.z() < 0.1)
    return false;
  const Eigen::Vector2d pixel = view.camera.project(seen);
  const cv::Point place(cvRound(pixel.x()), cvRound(pixel.y()));
  if (!cv::Rect(0, 0, kWidth, kHeight).contains(place))
    return false;
  const float disparity = view.disparity.at<float>(place);
  return disparity == 0.0f || seen.z() < view.camera.depth(disparity);
}

struct Trail {
  double all = 0.0;     ///< fraction of the car voxels, far from every car
  double in_view = 0.0; ///< likewise, only of those that the last frame sees
};

/** \brief The car voxels that are farther than \a limit [m] from every car of the last
 * frame. */
Trail
trailOf(const RenderedStreet& street, const SemanticVoxelMap& map, double limit)
{
  const std::vector<SyntheticCar> cars = street.scene.cars(kLast);
  const std::vector<Eigen::Vector3d> voxels = carVoxels(map);
  Trail trail;
  for (const Eigen::Vector3d& voxel : voxels)
    if (distanceToCars(cars, voxel) > limit) {
      trail.all += 1.0 / double(voxels.size());
      trail.in_view += isInView(street.views.back(), voxel) / double(voxels.size());
    }
  return trail;
}

/** \brief The car voxels near one of the standing cars, as sortable indices. */
std::set<std::tuple<int, int, int>>
standingVoxels(const RenderedStreet& street, const SemanticVoxelMap& map)
{
  std::vector<SyntheticCar> cars = street.scene.cars(kLast);
  cars.erase(std::remove_if(cars.begin(), cars.end(),
                            [](const SyntheticCar& car) { return car.is_driving; }),
             cars.end());
  std::set<std::tuple<int, int, int>> voxels;
  for (const Eigen::Vector3d& centre : carVoxels(map))
    if (distanceToCars(cars, centre) < kVoxel) {
      const VoxelIndex index = map.voxelOf(centre);
      voxels.emplace(index.x(), index.y(), index.z());
    }
  return voxels;
}

} // namespace

TEST(Trails, ExactDepthFreesTheTrailsInView)
{
  const RenderedStreet& street = drivingStreet();
  const auto with_rule = mapOf(street, Depth::exact);
  const auto without_rule = mapOf(street, Depth::exact, false);
  const Trail with = trailOf(street, *with_rule, 1.5 * kVoxel);
  const Trail without = trailOf(street, *without_rule, 1.5 * kVoxel);
  // Measured: 3.0 % with the rule, of which 0.1 % in view, and 16.7 % and 4.4 %
  // without. The rest lies beside and behind the camera, where the oncoming car left
  // the image.
  EXPECT_LT(with.in_view, 0.02);
  EXPECT_LT(with.all, 0.04);
  EXPECT_GT(without.all, 0.12);
  EXPECT_GT(without.in_view, 0.04);

  const auto kept = standingVoxels(street, *with_rule);
  const auto all = standingVoxels(street, *without_rule);
  std::size_t lost = 0;
  for (const auto& voxel : all)
    lost += kept.count(voxel) == 0;
  // Measured: 68 of 2169. Their surface fills only a part of the voxel. When the camera
  // looks along this surface, rays pass beside it through the rest of the voxel.
  EXPECT_GT(all.size(), 1500u);
  EXPECT_LT(double(lost), 0.045 * double(all.size()));
}

TEST(Trails, StereoLeavesLittleMoreThanOfStandingCars)
{
  const RenderedStreet standing(standingCars());
  const RenderedStreet& driving = drivingStreet();
  const Trail moved = trailOf(driving, *mapOf(driving, Depth::stereo), 0.5);
  const Trail stood = trailOf(standing, *mapOf(standing, Depth::stereo), 0.5);
  // Measured: 19.0 % and 15.9 %, of which 0.4 % and 0.1 % are in view.
  EXPECT_LT(moved.in_view, stood.in_view + 0.02);
  EXPECT_LT(moved.all, stood.all + 0.04);
}

} // namespace pcl_semantic
