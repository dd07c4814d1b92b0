// SPDX-License-Identifier: BSD-3-Clause

// Cars that drive on the synthetic street.

#include "support/same_image.h"
#include "synthesize/renderer.h"

#include <pcl_semantic/core/exceptions.h>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include <cmath>
#include <limits>
#include <set>

using namespace pcl_semantic;

namespace {

constexpr int kFrames = 8;
constexpr double kLane = synthetic::Street::lane;

std::vector<DrivingCar>
twoCars()
{
  return {{{12.0, kLane}, 1.0}, {{30.0, -kLane}, -0.9}};
}

std::set<int>
objectsIn(const SyntheticView& view)
{
  std::set<int> objects;
  for (std::size_t i = 0; i < view.objects.total(); ++i)
    objects.insert(view.objects.ptr<int>()[i]);
  return objects;
}

} // namespace

TEST(SyntheticTraffic, CarsDriveAlongTheRoad)
{
  const std::vector<DrivingCar> traffic = twoCars();
  const SyntheticScene scene(1, kFrames, traffic);
  const std::vector<SyntheticCar> first = scene.cars(0);
  const synthetic::Street street = scene.street(0);
  const synthetic::RoadLine& road = street.road();
  for (int frame = 0; frame < kFrames; ++frame) {
    const std::vector<SyntheticCar> cars = scene.cars(frame);
    ASSERT_EQ(cars.size(), first.size());
    ASSERT_GT(cars.size(), traffic.size());
    for (std::size_t i = 0; i < cars.size(); ++i) {
      EXPECT_EQ(cars[i].object, int(i) + 1);
      EXPECT_EQ(cars[i].is_driving, i < traffic.size());
      ASSERT_EQ(cars[i].parts.size(), first[i].parts.size());
      for (const synthetic::Primitive& part : cars[i].parts)
        EXPECT_EQ(cars[i].distance(part.centre), 0.0);
      if (!cars[i].is_driving) {
        EXPECT_EQ(cars[i].parts[0].centre, first[i].parts[0].centre);
        continue;
      }
      const synthetic::RoadPoint at{traffic[i].start.s + traffic[i].speed * frame,
                                    traffic[i].start.t};
      Eigen::Vector3d centre(0.0, 0.0, synthetic::Street::road_height + 0.5);
      centre.head<2>() = road.position(at);
      EXPECT_EQ(cars[i].distance(centre), 0.0) << "frame " << frame;
      EXPECT_NEAR(cars[i].distance(centre + Eigen::Vector3d(0.0, 0.0, 3.0)), 2.06,
                  1e-9);
      const double heading = std::atan2(cars[i].parts[0].sine, cars[i].parts[0].cosine);
      EXPECT_NEAR(std::sin(heading - road.heading(at.s)), 0.0, 1e-9);
    }
  }
}

TEST(SyntheticTraffic, AMovingCarKeepsItsNumberSizeAndTexture)
{
  const SyntheticScene scene(1, kFrames, twoCars());
  const synthetic::Street street = scene.street(0);
  std::set<std::uint32_t> ids;
  for (const synthetic::Primitive& part : street.driving())
    ids.insert(part.id);
  EXPECT_EQ(ids.size(), street.driving().size());
  for (int frame = 1; frame < kFrames; ++frame) {
    const synthetic::Street later = scene.street(frame);
    for (const synthetic::Primitive& part : later.driving()) {
      EXPECT_EQ(ids.count(part.id), 1u);
      for (const synthetic::Primitive& before : street.driving())
        if (before.id == part.id) {
          EXPECT_EQ(before.object, part.object);
          EXPECT_EQ(before.half, part.half);
          EXPECT_EQ(before.colour, part.colour);
        }
    }
  }
}

TEST(SyntheticTraffic, ObjectsNumberTheCarsOfTheImage)
{
  const SyntheticScene scene(1, kFrames, twoCars());
  const SyntheticRenderer renderer(scene, 310, 94);
  for (const int frame : {0, kFrames - 1}) {
    const SyntheticView view = renderer.render(frame);
    const std::vector<SyntheticCar> cars = scene.cars(frame);
    const std::set<int> seen = objectsIn(view);
    EXPECT_EQ(seen.count(0), 1u);
    EXPECT_EQ(seen.count(1), 1u) << "frame " << frame;
    EXPECT_EQ(seen.count(2), 1u) << "frame " << frame;
    EXPECT_GT(seen.size(), 4u);
    for (int v = 0; v < view.objects.rows; ++v)
      for (int u = 0; u < view.objects.cols; ++u) {
        const int object = view.objects.at<int>(v, u);
        const Label label = view.labels.at<Label>(v, u);
        ASSERT_EQ(object != 0, label == synthetic_car || label == synthetic_pedestrian);
        if (label != synthetic_car)
          continue;
        const double depth = view.camera.depth(view.disparity.at<float>(v, u));
        const Eigen::Vector3d point =
            view.T_world_camera * view.camera.unproject(u, v, depth);
        ASSERT_LT(cars.at(std::size_t(object) - 1).distance(point), 1e-3);
      }
  }
}

TEST(SyntheticTraffic, ChangesNothingElse)
{
  const std::vector<DrivingCar> gone{{{1000.0, kLane}, 1.0}, {{-100.0, -kLane}, -1.0}};
  const SyntheticRenderer without(SyntheticScene(1, 2), 124, 38);
  const SyntheticRenderer with_gone(SyntheticScene(1, 2, gone), 124, 38);
  const SyntheticRenderer with_two(SyntheticScene(1, 2, twoCars()), 124, 38);
  const SyntheticView expected = without.render(1);
  const SyntheticView same = with_gone.render(1);
  EXPECT_TRUE(isSameImage(same.left, expected.left));
  EXPECT_TRUE(isSameImage(same.right, expected.right));
  EXPECT_TRUE(isSameImage(same.disparity, expected.disparity));
  EXPECT_TRUE(isSameImage(same.labels, expected.labels));
  const SyntheticView other = with_two.render(1);
  EXPECT_FALSE(isSameImage(other.left, expected.left));
  for (std::size_t i = 0; i < expected.labels.total(); ++i) {
    const int object = other.objects.ptr<int>()[i];
    if (object != 1 && object != 2) {
      ASSERT_EQ(other.disparity.ptr<float>()[i], expected.disparity.ptr<float>()[i]);
      ASSERT_EQ(other.labels.ptr<Label>()[i], expected.labels.ptr<Label>()[i]);
    }
  }
}

TEST(SyntheticTraffic, RefusesNumbersThatAreNotFinite)
{
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const DrivingCar& car :
       {DrivingCar{{nan, 0.0}, 0.0}, DrivingCar{{0.0, nan}, 0.0},
        DrivingCar{{0.0, 0.0}, std::numeric_limits<double>::infinity()}})
    EXPECT_THROW(SyntheticScene(1, 1, {car}), InvalidParameterException);
  EXPECT_THROW(makeTraffic(-1), InvalidParameterException);
  EXPECT_THROW(makeTraffic(1001), InvalidParameterException);
  EXPECT_TRUE(makeTraffic(0).empty());
  EXPECT_THROW(SyntheticScene(1, 2).street(2), InvalidParameterException);
  EXPECT_THROW(SyntheticScene(1, 2).cars(-1), InvalidParameterException);
}

TEST(SyntheticTraffic, EveryOtherCarIsOncoming)
{
  const std::vector<DrivingCar> traffic = makeTraffic(5);
  ASSERT_EQ(traffic.size(), 5u);
  for (std::size_t i = 0; i < traffic.size(); ++i) {
    EXPECT_DOUBLE_EQ(traffic[i].start.t, i % 2 ? -kLane : kLane);
    if (i % 2)
      EXPECT_LT(traffic[i].speed, 0.0);
    else
      EXPECT_GT(traffic[i].speed, SyntheticScene::metres_per_frame);
  }
}
