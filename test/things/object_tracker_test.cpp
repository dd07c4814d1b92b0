// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/things/object_tracker.h>

#include "support/named_classes.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

namespace pcl_semantic {

namespace {

constexpr Label kRoad = 1, kCar = 2, kPole = 3;

LabelSet
streetLabels()
{
  std::vector<LabelClass> classes = namedClasses({"road", "car", "pole"});
  classes[1].dynamic = classes[1].thing = true;
  classes[2].thing = true;
  for (std::size_t c = 0; c < classes.size(); ++c)
    classes[c].colour = {std::uint8_t(c + 1), 0, 0};
  return LabelSet(classes);
}

// A map with voxels of 0.1 m.
class Street {
public:
  // Hits the voxels of a block.
  void
  hit(Label label, const VoxelIndex& corner, const VoxelIndex& size)
  {
    forEach(corner, size, [&](const Key& key) {
      Voxel& voxel = voxels_[key];
      voxel.label = label;
      ++voxel.observations;
    });
  }

  // Frees them, as the rays that see past them.
  void
  free(const VoxelIndex& corner, const VoxelIndex& size)
  {
    forEach(corner, size, [&](const Key& key) { voxels_.erase(key); });
  }

  VoxelCloud
  cloud() const
  {
    VoxelCloud cloud;
    cloud.voxel_size = 0.1;
    for (const auto& [key, voxel] : voxels_) {
      const auto [z, y, x] = key;
      cloud.indices.emplace_back(x, y, z);
      cloud.observations.push_back(voxel.observations);
      pcl::PointXYZRGBL point;
      point.getVector3fMap() =
          centreOf(cloud.indices.back(), cloud.voxel_size).cast<float>();
      point.label = voxel.label;
      cloud.cloud->push_back(point);
    }
    return cloud;
  }

  // Tracks the objects after a frame, and frees the voxels that they have left.
  VoxelCloud
  track(ObjectTracker& tracker)
  {
    tracker.update(cloud(), window, {frame, 0.5 * frame});
    ++frame;
    for (const VoxelIndex& voxel : tracker.leftVoxels())
      voxels_.erase({voxel.z(), voxel.y(), voxel.x()});
    VoxelCloud rest = cloud();
    rest.objects = tracker.numbers(rest);
    return rest;
  }

  ObjectTracker::Window window{VoxelIndex(-1000, -1000, -1000),
                               VoxelIndex(1000, 1000, 1000)};
  int frame = 0;

private:
  using Key = std::tuple<int, int, int>; // z, y, x

  struct Voxel {
    Label label = kUnlabelled;
    std::uint32_t observations = 0;
  };

  template <typename Visit>
  static void
  forEach(const VoxelIndex& corner, const VoxelIndex& size, const Visit& visit)
  {
    for (int z = 0; z < size.z(); ++z)
      for (int y = 0; y < size.y(); ++y)
        for (int x = 0; x < size.x(); ++x)
          visit({corner.z() + z, corner.y() + y, corner.x() + x});
  }

  std::map<Key, Voxel> voxels_;
};

// Numbers of the objects with a voxel in a block.
std::set<std::uint32_t>
numbersIn(const VoxelCloud& cloud, const VoxelIndex& corner, const VoxelIndex& size)
{
  std::set<std::uint32_t> numbers;
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if ((cloud.indices[i].array() >= corner.array()).all() &&
        (cloud.indices[i].array() < (corner + size).array()).all())
      numbers.insert(cloud.objects[i]);
  return numbers;
}

std::vector<ObjectSummary>
summaries(const ObjectTracker& tracker, VoxelCloud cloud)
{
  cloud.objects = tracker.numbers(cloud);
  return tracker.summarize(cloud);
}

std::size_t
voxelsOf(const VoxelCloud& cloud, std::uint32_t number)
{
  return std::size_t(std::count(cloud.objects.begin(), cloud.objects.end(), number));
}

using Numbers = std::set<std::uint32_t>;

const VoxelIndex car_size(10, 8, 6);
constexpr int kFramesUntilMoving = 6;

} // namespace

// A car stands, another one drives past it.
TEST(ObjectTracker, AnotherTrackerContinuesTheSame)
{
  const LabelSet labels = streetLabels();
  ObjectTracker whole(labels, {}), first(labels, {}), second(labels, {});
  Street street, resumed;
  for (int frame = 0; frame < 20; ++frame) {
    if (frame == 10)
      second.restore(first.objects());
    ObjectTracker& tracker = frame < 10 ? first : second;
    std::vector<VoxelCloud> clouds;
    for (Street* const each : {&street, &resumed}) {
      each->free({8 * frame - 8, 20, 0}, car_size);
      each->hit(kCar, {0, 0, 0}, car_size);
      each->hit(kCar, {8 * frame, 20, 0}, car_size);
      clouds.push_back(each->track(each == &street ? whole : tracker));
    }
    EXPECT_EQ(whole.leftVoxels(), tracker.leftVoxels()) << frame;
    EXPECT_EQ(clouds[0].objects, clouds[1].objects) << frame;
    EXPECT_EQ(numbersIn(clouds[1], {8 * frame, 20, 0}, car_size), Numbers{2}) << frame;
  }
  const std::vector<ObjectSummary> a = summaries(whole, street.cloud()),
                                   b = summaries(second, resumed.cloud());
  ASSERT_EQ(a.size(), 2u);
  ASSERT_EQ(b.size(), 2u);
  EXPECT_TRUE(b[1].track->moving);
  EXPECT_EQ(a[1].track->speed, b[1].track->speed);
  EXPECT_EQ(a[0].track->frames, b[0].track->frames);
  const MapObjects one = whole.objects(), other = second.objects();
  EXPECT_EQ(one.last_number, other.last_number);
  EXPECT_EQ(one.frames, other.frames);
  ASSERT_EQ(one.objects.size(), other.objects.size());
  for (std::size_t i = 0; i < one.objects.size(); ++i) {
    EXPECT_EQ(one.objects[i].voxels, other.objects[i].voxels);
    EXPECT_EQ(one.objects[i].observations, other.objects[i].observations);
    EXPECT_EQ(one.objects[i].last_moved, other.objects[i].last_moved);
  }
}

// One car drives, another one stands; half of its labels come late.
TEST(ObjectTracker, LateLabelsAddVoxelsAndNothingElse)
{
  ObjectTracker tracker(streetLabels(), {});
  Street street;
  for (int frame = 0; frame < 10; ++frame) {
    street.free({8 * frame - 8, 20, 0}, car_size);
    street.hit(kCar, {8 * frame, 20, 0}, car_size);
    street.hit(kCar, {0, 0, 0}, {5, 8, 6});
    street.hit(kRoad, {5, 0, 0}, {5, 8, 6}); // of the car, before its labels
    street.track(tracker);
  }
  VoxelCloud cloud = street.cloud();
  const std::vector<ObjectSummary> before = summaries(tracker, cloud);
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (cloud.indices[i].y() < 20)
      (*cloud.cloud)[i].label = kCar;
  tracker.updateLabels(cloud, street.window);
  EXPECT_TRUE(tracker.leftVoxels().empty());
  const std::vector<ObjectSummary> after = summaries(tracker, cloud);
  ASSERT_EQ(before.size(), 2u);
  ASSERT_EQ(after.size(), 2u);
  const ObjectSummary &was = before[0], &still = after[0];
  EXPECT_EQ(was.points, 5u * 8 * 6);
  EXPECT_EQ(still.points, 10u * 8 * 6);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(after[i].track->frames, 10);
    EXPECT_EQ(after[i].track->moving, before[i].track->moving);
    EXPECT_EQ(after[i].track->motion, before[i].track->motion);
  }
  EXPECT_EQ(after[1].points, before[1].points);
  EXPECT_TRUE(after[1].track->moving);
}

TEST(ObjectTracker, TakesOnlyChanges)
{
  ObjectTracker tracker(streetLabels(), {});
  Street street;
  street.hit(kCar, {0, 0, 0}, car_size);
  street.hit(kCar, {500, 0, 0}, car_size);
  street.track(tracker);
  EXPECT_EQ(tracker.takeChanges().objects.size(), 2u);
  EXPECT_EQ(tracker.takeChanges().unchanged, (std::vector<std::uint32_t>{1, 2}));
  Street end; // another window
  end.window = {VoxelIndex(400, -50, -50), VoxelIndex(600, 50, 50)};
  end.hit(kCar, {500, 0, 0}, car_size);
  end.track(tracker);
  const MapObjects changes = tracker.takeChanges();
  ASSERT_EQ(changes.objects.size(), 1u);
  EXPECT_EQ(changes.objects[0].number, 2u);
  EXPECT_EQ(changes.unchanged, std::vector<std::uint32_t>{1});
  EXPECT_EQ(tracker.objects().objects.size(), 2u);
}

TEST(ObjectTracker, StillObjectsKeepTheirNumbers)
{
  ObjectTracker tracker(streetLabels(), {});
  Street street;
  const VoxelIndex first(0, 0, 0), second(100, 0, 0), third(-100, 0, 0);
  for (int frame = 0; frame < 12; ++frame) {
    street.hit(kRoad, {-200, -50, -3}, {400, 3, 1});
    if (frame < 8)
      street.hit(kCar, first, car_size);
    street.hit(kPole, second, {2, 2, 20});
    if (frame >= 3)
      street.hit(kCar, third, car_size);
    const VoxelCloud cloud = street.track(tracker);
    EXPECT_TRUE(tracker.leftVoxels().empty());
    EXPECT_EQ(numbersIn(cloud, first, car_size), Numbers{1}) << frame;
    EXPECT_EQ(numbersIn(cloud, second, {2, 2, 20}), Numbers{2}) << frame;
    EXPECT_EQ(numbersIn(cloud, {-200, -50, -3}, {400, 3, 1}), Numbers{0}) << frame;
    if (frame >= 3) {
      EXPECT_EQ(numbersIn(cloud, third, car_size), Numbers{3}) << frame;
    }
  }
  const std::vector<ObjectSummary> objects = summaries(tracker, street.cloud());
  ASSERT_EQ(objects.size(), 3u);
  EXPECT_EQ(objects[0].label, kCar);
  EXPECT_EQ(objects[1].label, kPole);
  ASSERT_TRUE(objects[2].track);
  EXPECT_EQ(objects[0].track->first_frame, 0);
  EXPECT_EQ(objects[0].track->last_frame, 7);
  EXPECT_EQ(objects[0].track->frames, 8);
  EXPECT_EQ(objects[2].track->first_frame, 3);
  EXPECT_EQ(objects[2].track->frames, 9);
  EXPECT_FALSE(objects[2].track->moving);
  EXPECT_EQ(objects[2].points, std::size_t(car_size.prod()));
}

// Rays free the car's voxels two frames later.
TEST(ObjectTracker, AMovingObjectIsWhereItIsNow)
{
  ObjectTracker tracker(streetLabels(), {});
  Street street;
  const auto place = [](int frame) { return VoxelIndex(4 * frame, 0, 0); };
  const VoxelIndex parked(0, 30, 0);
  for (int frame = 0; frame < 20; ++frame) {
    street.free(place(frame - 2), {4, 8, 6});
    street.hit(kCar, place(frame), car_size);
    street.hit(kCar, parked, car_size);
    const VoxelCloud cloud = street.track(tracker);
    EXPECT_EQ(numbersIn(cloud, place(frame), car_size), Numbers{1}) << frame;
    EXPECT_EQ(numbersIn(cloud, parked, car_size), Numbers{2}) << frame;
    EXPECT_EQ(voxelsOf(cloud, 2), std::size_t(car_size.prod())) << frame;
    if (frame > kFramesUntilMoving) {
      EXPECT_EQ(voxelsOf(cloud, 1), std::size_t(car_size.prod())) << frame;
    }
  }
  const std::vector<ObjectSummary> objects = summaries(tracker, street.cloud());
  ASSERT_EQ(objects.size(), 2u);
  EXPECT_TRUE(objects[0].track->moving);
  EXPECT_NEAR(objects[0].track->motion.x(), 0.4, 0.05);
  EXPECT_NEAR(objects[0].track->speed, 0.8, 0.1); // two frames a second
  EXPECT_FALSE(objects[1].track->moving);
}

TEST(ObjectTracker, AFastObjectSharesNoVoxelsWithItsLastPlace)
{
  ObjectTracker tracker(streetLabels(), {});
  Street street;
  const auto place = [](int frame) { return VoxelIndex(25 * frame, 0, 0); };
  for (int frame = 0; frame < 20; ++frame) {
    street.free(place(frame - 1), car_size);
    if (frame != 12 && frame != 13) // hidden
      street.hit(kCar, place(frame), car_size);
    const VoxelCloud cloud = street.track(tracker);
    if (frame != 12 && frame != 13) {
      EXPECT_EQ(numbersIn(cloud, place(frame), car_size), Numbers{1}) << frame;
    }
  }
}

TEST(ObjectTracker, AnObjectThatPassesAnotherOneKeepsItsNumber)
{
  ObjectTracker tracker(streetLabels(), {});
  Street street;
  const auto place = [](int frame) { return VoxelIndex(8 * frame, 0, 0); };
  const VoxelIndex parked(120, 12, 0); // 0.4 m beside the way
  for (int frame = 0; frame < 32; ++frame) {
    street.free(place(frame - 1), {8, 8, 6});
    street.hit(kCar, place(frame), car_size);
    street.hit(kCar, parked, car_size);
    const VoxelCloud cloud = street.track(tracker);
    EXPECT_EQ(numbersIn(cloud, place(frame), car_size), Numbers{1}) << frame;
    EXPECT_EQ(numbersIn(cloud, parked, car_size), Numbers{2}) << frame;
  }
}

TEST(ObjectTracker, APartThatIsNotSeenStaysWithItsObject)
{
  ObjectTracker tracker(streetLabels(), {});
  Street street;
  const VoxelIndex part(10, 8, 6);
  street.hit(kCar, {0, 0, 0}, {30, 8, 6});
  street.track(tracker);
  street.free({10, 0, 0}, part);
  street.hit(kCar, {0, 0, 0}, part);
  const VoxelCloud cloud = street.track(tracker);
  EXPECT_EQ(numbersIn(cloud, {0, 0, 0}, part), Numbers{1});
  EXPECT_EQ(numbersIn(cloud, {20, 0, 0}, part), Numbers{1});
  const std::vector<ObjectSummary> objects = summaries(tracker, cloud);
  ASSERT_EQ(objects.size(), 1u);
  EXPECT_EQ(objects[0].track->frames, 2);
}

TEST(ObjectTracker, AnObjectKeepsItsNumberOutsideTheWindow)
{
  ObjectTracker tracker(streetLabels(), {});
  Street near, far;
  near.window = {VoxelIndex(-50, -50, -50), VoxelIndex(49, 49, 49)};
  near.hit(kCar, {0, 0, 0}, car_size);
  near.track(tracker);
  far.window = {VoxelIndex(450, -50, -50), VoxelIndex(549, 49, 49)};
  for (far.frame = 1; far.frame < 12;) {
    far.hit(kCar, {500, 0, 0}, car_size);
    EXPECT_EQ(numbersIn(far.track(tracker), {500, 0, 0}, car_size), Numbers{2});
  }
  near.frame = far.frame;
  EXPECT_EQ(numbersIn(near.track(tracker), {0, 0, 0}, car_size), Numbers{1});
}

TEST(ObjectTracker, OnlyDynamicClassesMove)
{
  ObjectTracker tracker(streetLabels(), {});
  Street street;
  for (int frame = 0; frame < 12; ++frame) {
    street.free({4 * (frame - 1), 0, 0}, {4, 8, 6});
    street.hit(kPole, {4 * frame, 0, 0}, car_size);
    street.track(tracker);
    EXPECT_TRUE(tracker.leftVoxels().empty());
    for (const ObjectSummary& object : summaries(tracker, street.cloud()))
      EXPECT_FALSE(object.track->moving);
  }
}

TEST(ObjectTracker, RefusesWrongParameters)
{
  expectBadParameter("object_gap is 0, expected a positive number", [] {
    ObjectTracker(streetLabels(), {0.0, 20});
  });
  expectBadParameter("object_min_voxels is 0, expected 1 or more", [] {
    ObjectTracker(streetLabels(), {0.7, 0});
  });
}

} // namespace pcl_semantic
