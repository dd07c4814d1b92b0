// SPDX-License-Identifier: BSD-3-Clause
#include "io/archive_objects.h"

#include "io/object_merge.h"
#include "support/archives.h"
#include "support/run_sql.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/io/archive_merge.h>

#include <gtest/gtest.h>

#include <cmath>

namespace pcl_semantic {

namespace {

void
expectSame(const ObjectSighting& a, const ObjectSighting& b)
{
  EXPECT_EQ(a.frame, b.frame);
  EXPECT_EQ(a.timestamp, b.timestamp);
  EXPECT_EQ(a.centre, b.centre);
  EXPECT_EQ(a.box.min(), b.box.min());
  EXPECT_EQ(a.box.max(), b.box.max());
  EXPECT_EQ(a.voxels, b.voxels);
}

void
expectSame(const MapObject& a, const MapObject& b)
{
  EXPECT_EQ(a.number, b.number);
  EXPECT_EQ(a.label, b.label);
  EXPECT_EQ(a.summary.first_frame, b.summary.first_frame);
  EXPECT_EQ(a.summary.last_frame, b.summary.last_frame);
  EXPECT_EQ(a.summary.frames, b.summary.frames);
  EXPECT_EQ(a.summary.moving, b.summary.moving);
  EXPECT_EQ(a.summary.motion, b.summary.motion);
  EXPECT_TRUE(a.summary.speed == b.summary.speed ||
              (std::isnan(a.summary.speed) && std::isnan(b.summary.speed)));
  EXPECT_EQ(a.voxels, b.voxels);
  EXPECT_EQ(a.observations, b.observations);
  EXPECT_EQ(a.last_frame, b.last_frame);
  EXPECT_EQ(a.last_moved, b.last_moved);
  ASSERT_EQ(a.sightings.size(), b.sightings.size());
  for (std::size_t i = 0; i < a.sightings.size(); ++i)
    expectSame(a.sightings[i], b.sightings[i]);
}

MapObject
makeMovingObject(std::uint32_t number, const VoxelIndex& corner)
{
  MapObject object = makeMapObject(number, corner, {3, 2, 2});
  object.summary.moving = true;
  object.summary.motion = {0.5, -0.25, 0.125};
  object.summary.speed = 5.75;
  object.last_frame = 7;
  object.last_moved = 6;
  for (const int frame : {6, 7})
    object.sightings.push_back({frame,
                                0.1 * frame,
                                {1.0, 2.0, 0.1 * frame},
                                {Eigen::Vector3d(0, 1, 2), Eigen::Vector3d(3, 4, 5)},
                                {corner, corner + VoxelIndex(0, 0, 1)}});
  return object;
}

std::shared_ptr<MapArchive>
archiveWith(const std::string& path, const MapObjects& objects)
{
  auto archive = MapArchive::create(path, makeArchiveHeader());
  archive->put({0, 0, 0}, makeRandomBlock(20, 3, 1));
  archive->putObjects(objects);
  archive->commit({});
  return archive;
}

std::vector<std::uint32_t>
numbersIn(const MapObjects& objects)
{
  std::vector<std::uint32_t> numbers;
  for (const MapObject& object : objects.objects)
    numbers.push_back(object.number);
  return numbers;
}

// The voxels of an object of merged maps.
std::size_t
voxelsOf(const MapObjects& objects, std::uint32_t number)
{
  return objects.objects.at(number - 1).voxels.size();
}

MapObjects
merge(const std::vector<MapObjects>& maps)
{
  std::vector<PlacedObjects> placed;
  for (const MapObjects& objects : maps)
    placed.push_back({objects, Eigen::Isometry3d::Identity()});
  return mergeObjects(placed);
}

// An archive in which the voxels of the objects are occupied by cars.
void
writeCars(const std::string& path, const std::vector<MapObject>& objects)
{
  Blocks blocks;
  for (const MapObject& object : objects)
    for (const VoxelIndex& voxel : object.voxels) {
      VoxelBlock& block = blocks[blockOf(voxel)];
      const int record = block.makeRecord(voxelInBlock(voxel), 3);
      block.log_odds[std::size_t(voxelInBlock(voxel))] = 4000;
      block.records[std::size_t(record)].observations = 2;
      block.records[std::size_t(record)].label_observations = 2;
      block.measured[std::size_t(3 * record)] = -5.0f;
      block.measured[std::size_t(3 * record + 2)] = -5.0f;
    }
  const auto archive = MapArchive::create(path, makeArchiveHeader());
  putAll(blocks, *archive);
  archive->putObjects(makeMapObjects(objects));
  archive->commit({});
  archive->close();
}

using Numbers = std::vector<std::uint32_t>;

} // namespace

TEST(ArchiveObjects, ComeBack)
{
  const TemporaryFolder folder;
  const std::string path = folder.path("map");
  const MapObjects put = makeMapObjects(
      {makeMapObject(1, {-5, 0, 2}, {4, 3, 2}), makeMovingObject(2, {100, 7, -3})});
  archiveWith(path, put)->close();
  EXPECT_TRUE(verifyArchive(path).empty());
  const auto read = MapArchive(path, ArchiveAccess::read).objects();
  ASSERT_TRUE(read);
  EXPECT_EQ(read->last_number, 2u);
  EXPECT_EQ(read->frames, 8);
  EXPECT_EQ(read->min_voxels, 2u);
  ASSERT_EQ(read->objects.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i)
    expectSame(read->objects[i], put.objects[i]);
}

TEST(ArchiveObjects, AreThoseOfTheLastCommit)
{
  const TemporaryFolder folder;
  const std::string path = folder.path("map");
  MapObjects objects = makeMapObjects(
      {makeMapObject(1, {0, 0, 0}, {2, 1, 1}), makeMapObject(2, {9, 0, 0}, {2, 1, 1})});
  const auto archive = archiveWith(path, objects);
  const MapObject kept = objects.objects[1];
  objects.objects = {makeMapObject(3, {0, 20, 0}, {2, 1, 1})};
  objects.unchanged = {2};
  objects.last_number = 3;
  archive->putObjects(objects);
  EXPECT_EQ(numbersIn(*MapArchive(path, ArchiveAccess::read).objects()),
            (Numbers{1, 2}));
  archive->commit({});
  const auto read = MapArchive(path, ArchiveAccess::read).objects();
  EXPECT_EQ(numbersIn(*read), (Numbers{2, 3}));
  expectSame(read->objects[0], kept);
  expectSame(read->objects[1], objects.objects[0]);
  archive->close();
  ArchiveDatabase database(path, ArchiveDatabase::Access::read);
  EXPECT_FALSE(database.hasMeta("object 1"));
  EXPECT_TRUE(database.hasMeta("object 2"));
}

TEST(ArchiveObjects, AMapWithoutObjectsHasNone)
{
  const TemporaryFolder folder;
  createWith(folder.path("none"), {}, makeArchiveHeader());
  EXPECT_FALSE(MapArchive(folder.path("none"), ArchiveAccess::read).objects());
  archiveWith(folder.path("zero"), makeMapObjects({}))->close();
  const auto zero = MapArchive(folder.path("zero"), ArchiveAccess::read).objects();
  ASSERT_TRUE(zero);
  EXPECT_TRUE(zero->objects.empty());
}

TEST(ArchiveObjects, DamageIsReported)
{
  const TemporaryFolder folder;
  const std::string path = folder.path("map");
  const auto faultsOf = [&](const MapObjects& objects, const std::string& sql) {
    std::filesystem::remove(path);
    archiveWith(path, objects)->close();
    if (!sql.empty())
      runSql(path, sql);
    const std::vector<std::string> faults = verifyArchive(path);
    return faults.size() == 1 ? faults[0] : std::to_string(faults.size()) + " faults";
  };
  const MapObject car = makeMapObject(1, {0, 0, 0}, {2, 2, 2});
  EXPECT_EQ(faultsOf(makeMapObjects({car}), ""), "0 faults");
  EXPECT_EQ(faultsOf(makeMapObjects({car}), "DELETE FROM meta WHERE name = 'object 1'"),
            path + ": is damaged: has 0 objects, expected 1");
  EXPECT_EQ(faultsOf(makeMapObjects({car, makeMapObject(2, {9, 0, 0}, {1, 1, 1})}),
                     "UPDATE meta SET value = (SELECT value FROM meta WHERE name = "
                     "'object 2') WHERE name = 'object 1'"),
            path + ": 'object 1': has an entry of another name");
  EXPECT_EQ(faultsOf(makeMapObjects({car}), "DELETE FROM meta WHERE name = 'objects'"),
            path + ": is damaged: has 1 objects, expected 0");
  MapObject other = makeMovingObject(1, {0, 0, 0});
  other.sightings[1].frame = 6;
  EXPECT_EQ(faultsOf(makeMapObjects({other}), ""),
            path + ": 'object 1': has frames out of order, or beyond 8");
  other = car;
  other.label = 4;
  EXPECT_EQ(faultsOf(makeMapObjects({other}), ""),
            path + ": 'object 1': has label 4, expected 1 to 3");
  other = car;
  other.voxels[3].y() = kMaxVoxelIndex + 1;
  EXPECT_EQ(faultsOf(makeMapObjects({other}), ""),
            path + ": 'object 1': has a voxel at 1000000001, expected at most "
                   "1000000000");
  other = car;
  other.summary.motion.x() = std::nan("");
  EXPECT_EQ(faultsOf(makeMapObjects({other}), ""),
            path + ": 'object 1': has a number that is not finite");
  other = car;
  other.number = 9;
  EXPECT_EQ(faultsOf(makeMapObjects({other}), ""),
            path + ": 'objects': has object 9, expected ascending numbers up to 1");
}

TEST(MergeObjects, TouchingObjectsOfAClassAreOne)
{
  const MapObjects merged = merge(
      {makeMapObjects({makeMapObject(1, {0, 0, 0}, {4, 2, 2}),
                       makeMapObject(2, {50, 0, 0}, {4, 2, 2})}),
       makeMapObjects({makeMapObject(1, {54, 2, 2}, {4, 2, 2}), // a corner touches 2
                       makeMapObject(2, {2, 0, 0}, {4, 2, 2}),  // shares voxels of 1
                       makeMapObject(3, {0, 90, 0}, {4, 2, 2})})}); // alone
  EXPECT_EQ(numbersIn(merged), (Numbers{1, 2, 3}));
  EXPECT_EQ(voxelsOf(merged, 1), 24u);
  EXPECT_EQ(voxelsOf(merged, 2), 32u);
  EXPECT_EQ(voxelsOf(merged, 3), 16u);
  EXPECT_EQ(merged.objects[0].summary.frames, 8);
  EXPECT_EQ(merged.objects[0].observations[2], 3u + 1u) << "of both maps";
  EXPECT_EQ(merged.last_number, 3u);
  EXPECT_EQ(merged.min_voxels, 2u);
}

TEST(MergeObjects, OnlyTheMostSharedOfAMapJoins)
{
  // Two cars of one map that are one car in the other one.
  const MapObjects merged =
      merge({makeMapObjects({makeMapObject(1, {0, 0, 0}, {10, 2, 2})}),
             makeMapObjects({makeMapObject(1, {0, 0, 0}, {3, 2, 2}),
                             makeMapObject(2, {4, 0, 0}, {8, 2, 2})})});
  EXPECT_EQ(numbersIn(merged), Numbers{1}) << "no voxel is left for the smaller car";
  EXPECT_EQ(voxelsOf(merged, 1), 48u) << "with the larger car";
}

TEST(MergeObjects, OtherClassesAndMovingObjectsStayApart)
{
  MapObject pole = makeMapObject(1, {0, 2, 0}, {4, 2, 2});
  pole.label = 1;
  const MapObjects merged =
      merge({makeMapObjects({makeMapObject(1, {0, 0, 0}, {4, 2, 2})}),
             makeMapObjects({pole, makeMovingObject(2, {1, -2, 0})}),
             makeMapObjects({makeMapObject(1, {4, 0, 0}, {4, 2, 2})})});
  EXPECT_EQ(numbersIn(merged), (Numbers{1, 2, 3}));
  EXPECT_EQ(voxelsOf(merged, 1), 32u) << "with that of the third map";
  EXPECT_TRUE(merged.objects[2].summary.moving);
}

TEST(MergeObjects, VoxelsMoveAsThoseOfTheMap)
{
  const TemporaryFolder folder;
  writeCars(folder.path("a"), {makeMapObject(1, {0, 0, 0}, {8, 4, 2})});
  PlacedArchive placed{folder.path("a"), Eigen::Isometry3d::Identity()};
  placed.motion = Eigen::Translation3d(3.1, -70.2, 0.4) *
                  Eigen::AngleAxisd(0.7, Eigen::Vector3d(0.2, -0.3, 1.0).normalized());
  mergeArchives({placed}, folder.path("moved"));
  const MapArchive moved(folder.path("moved"), ArchiveAccess::read);
  std::vector<VoxelIndex> hit;
  moved.forEach([&](const VoxelIndex& index, const VoxelBlock& each) {
    for (int place = 0; place < kBlockVoxels; ++place)
      if (each.recordAt(place) != VoxelBlock::kNoRecord)
        hit.push_back(voxelAt(index, place));
  });
  std::sort(hit.begin(), hit.end(), VoxelIndexLess());
  ASSERT_TRUE(moved.objects());
  EXPECT_EQ(moved.objects()->objects.at(0).voxels, hit);
  EXPECT_GT(hit.size(), 50u);
}

TEST(MergeObjects, VoxelsThatTheMapDoesNotShowAreLeftOut)
{
  const TemporaryFolder folder;
  MapObject part = makeMapObject(1, {0, 0, 0}, {4, 2, 2});
  writeCars(folder.path("map"), {part});
  part.voxels.push_back({4, 0, 0}); // is not occupied
  part.observations.push_back(1);
  MapObject pole = makeMapObject(2, {0, 0, 0}, {4, 1, 1}); // is a car in the map
  pole.label = 1;
  MapObjects objects =
      makeMapObjects({part, pole, makeMapObject(3, {3, 1, 1}, {1, 1, 1})});
  keepVisible(MapArchive(folder.path("map"), ArchiveAccess::read), objects);
  EXPECT_EQ(numbersIn(objects), Numbers{1}) << "one voxel is too few";
  EXPECT_EQ(voxelsOf(objects, 1), 16u);
}

TEST(MergeObjects, TheOrderOfTheMapsDoesNotMatter)
{
  const TemporaryFolder folder;
  writeCars(folder.path("a"), {makeMapObject(1, {0, 0, 0}, {4, 2, 2})});
  writeCars(folder.path("b"), {makeMapObject(1, {9, 0, 0}, {4, 2, 2}),
                               makeMapObject(2, {2, 1, 0}, {4, 2, 2})});
  const auto mergeOf = [&](const std::vector<std::string>& names,
                           const std::string& output) {
    std::vector<PlacedArchive> archives;
    for (const std::string& name : names)
      archives.push_back({folder.path(name), Eigen::Isometry3d::Identity()});
    mergeArchives(archives, folder.path(output));
    return *MapArchive(folder.path(output), ArchiveAccess::read).objects();
  };
  const MapObjects one = mergeOf({"a", "b"}, "ab"), other = mergeOf({"b", "a"}, "ba");
  ASSERT_EQ(one.objects.size(), 2u);
  ASSERT_EQ(other.objects.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i)
    expectSame(one.objects[i], other.objects[i]);
}

} // namespace pcl_semantic
