// SPDX-License-Identifier: BSD-3-Clause
#include "map/voxel_fusion.h"
#include "support/archives.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/label_distributions.h>
#include <pcl_semantic/io/archive_merge.h>
#include <pcl_semantic/io/map_file.h>

#include <algorithm>
#include <cmath>

namespace pcl_semantic {

namespace fs = std::filesystem;

namespace {

constexpr int classes = 3;

std::vector<PlacedArchive>
placed(const std::vector<std::string>& paths)
{
  std::vector<PlacedArchive> archives;
  for (const std::string& path : paths)
    archives.push_back({path, Eigen::Isometry3d::Identity()});
  return archives;
}

void
writeMap(const std::string& path, const Blocks& blocks,
         const ArchiveHeader& header = makeArchiveHeader(),
         const Eigen::Vector3d& origin = {1000, 0, 0})
{
  ArchiveState state;
  state.cloud_origin = origin;
  state.finished = true;
  createWith(path, blocks, header, state);
}

// A block as fusion leaves it: clamped, the largest label log is 0.
VoxelBlock
makeMapBlock(std::size_t records, unsigned seed)
{
  VoxelBlock block = makeRandomBlock(records, classes, seed);
  for (StoredLogOdds& value : block.log_odds)
    if (value != kUnknown)
      value = StoredLogOdds(value % 9000);
  for (std::size_t i = 0; i < block.records.size(); ++i) {
    block.records[i].colour_count %= 1000;
    for (std::uint32_t& sum : block.records[i].colour_sum)
      sum %= 200000;
    block.records[i].observations = unsigned(i) % 5 + 1;
    block.records[i].label_observations = unsigned(i) % 3;
    if (i % 3 == 0)
      std::fill_n(block.measured.begin() + long(i) * classes, classes, 0.0f);
  }
  return block;
}

// A merged voxel against the sum of two, written down plainly.
void
expectSum(const VoxelBlock& a, const VoxelBlock& b, const VoxelBlock& merged, int place)
{
  const auto at = std::size_t(place);
  const int unknown = (a.log_odds[at] == kUnknown) + (b.log_odds[at] == kUnknown);
  const int sum = (a.log_odds[at] == kUnknown ? 0 : a.log_odds[at]) +
                  (b.log_odds[at] == kUnknown ? 0 : b.log_odds[at]);
  const int limit = storedLogOdds(0.97); // of the default parameters
  ASSERT_EQ(merged.log_odds[at],
            unknown == 2 ? kUnknown : std::clamp(sum, -limit, limit));
  const int i = a.recordAt(place), j = b.recordAt(place), m = merged.recordAt(place);
  ASSERT_EQ(m == VoxelBlock::kNoRecord, i < 0 && j < 0);
  if (i < 0 || j < 0)
    return;
  const VoxelRecord &p = a.records[std::size_t(i)], &q = b.records[std::size_t(j)];
  const VoxelRecord& r = merged.records[std::size_t(m)];
  for (std::size_t channel = 0; channel < 3; ++channel)
    EXPECT_EQ(r.colour_sum[channel], p.colour_sum[channel] + q.colour_sum[channel]);
  EXPECT_EQ(r.colour_count, p.colour_count + q.colour_count);
  EXPECT_EQ(r.observations, p.observations + q.observations);
  EXPECT_EQ(r.label_observations, p.label_observations + q.label_observations);
  const double weight = std::max(p.observations, 1u),
               other = std::max(q.observations, 1u);
  for (std::size_t axis = 0; axis < 3; ++axis)
    EXPECT_NEAR(
        r.position[axis],
        (weight * p.position[axis] + other * q.position[axis]) / (weight + other), 1.0);
  if (p.label_observations == 0 || q.label_observations == 0) { // nothing to weigh
    EXPECT_EQ(r.label_deviation, p.label_observations > 0   ? p.label_deviation
                                 : q.label_observations > 0 ? q.label_deviation
                                                            : 0);
    return;
  }
  const std::uint16_t best = std::min(p.label_deviation, q.label_deviation);
  EXPECT_EQ(r.label_deviation, best);
  const auto weighted = [&](const VoxelBlock& block, int record,
                            const VoxelRecord& of) {
    std::vector<float> logs(block.measured.begin() + record * classes,
                            block.measured.begin() + (record + 1) * classes);
    const double ratio =
        of.label_deviation > 0 ? double(best) / of.label_deviation : 1.0;
    for (float& log : logs)
      log *= float(std::max(0.02, ratio * ratio));
    return logs;
  };
  std::vector<float> logs = weighted(a, i, p);
  fuseLogLikelihood(weighted(b, j, q).data(), classes, std::log(1e4f), logs.data());
  for (int k = 0; k < classes; ++k) {
    EXPECT_NEAR(merged.measured[std::size_t(m * classes + k)], logs[std::size_t(k)],
                2e-6);
    EXPECT_EQ(merged.refined[std::size_t(m * classes + k)], 0.0f) << "forgotten";
  }
}

} // namespace

// Maps of one voxel: a near look at a car, and a far look at a road.
TEST(ArchiveMerge, LabelsAreWeightedUnlessAMapHasNoWeights)
{
  const TemporaryFolder folder;
  const auto blockOf = [](std::uint16_t deviation, float road, float car) {
    VoxelBlock block;
    const auto record = std::size_t(block.makeRecord(0, 3));
    block.log_odds[0] = 4000;
    block.records[record].observations = block.records[record].label_observations = 1;
    block.records[record].label_deviation = deviation;
    block.measured = {road, car, -3.0f};
    return block;
  };
  const Blocks near = {{{0, 0, 0}, blockOf(1000, -1.0f, 0.0f)}},
               far = {{{0, 0, 0}, blockOf(2000, 0.0f, -2.0f)}};
  for (const bool is_weighted : {true, false}) {
    const std::string name = is_weighted ? "w" : "e";
    ArchiveHeader header = makeArchiveHeader();
    writeMap(folder.path(name + "near"), near, header);
    header.parameters.fusion.weigh_labels = is_weighted;
    writeMap(folder.path(name + "far"), far, header);
    mergeArchives(placed({folder.path(name + "near"), folder.path(name + "far")}),
                  folder.path(name));
    const MapArchive merged(folder.path(name), ArchiveAccess::read);
    EXPECT_EQ(merged.header().parameters.fusion.weigh_labels, is_weighted);
    const auto block = merged.get(VoxelIndex(0, 0, 0));
    ASSERT_TRUE(block);
    // -1 and -2 / 4; or -1 and -2
    EXPECT_NEAR(block->measured[0] - block->measured[1], is_weighted ? -0.5f : 1.0f,
                1e-6f);
    EXPECT_EQ(block->records[0].label_deviation, is_weighted ? 1000 : 0);
  }
}

TEST(ArchiveMerge, AddsWhatBothKnowAndKeepsWhatOneKnows)
{
  const TemporaryFolder folder;
  const VoxelIndex both(1, 2, 3), first(0, 0, 0), second(-9, 5, 1);
  Blocks a, b;
  a[both] = makeMapBlock(200, 1);
  b[both] = makeMapBlock(200, 2);
  a[first] = makeMapBlock(50, 3);
  b[second] = makeMapBlock(0, 4);
  ArchiveHeader header = makeArchiveHeader();
  header.parameters.fusion.free_dynamic = false; // plain sums for cars, too
  writeMap(folder.path("a"), a, header);
  writeMap(folder.path("b"), b, header);
  EXPECT_EQ(
      mergeArchives(placed({folder.path("a"), folder.path("b")}), folder.path("c")),
      3u);
  EXPECT_EQ(folder.entries(), 3u);
  Blocks merged = readBlocks(folder.path("c"));
  ASSERT_EQ(merged.size(), 3u);
  EXPECT_TRUE(areSameBlocks(merged[first], a[first], classes));
  EXPECT_TRUE(areSameBlocks(merged[second], b[second], classes));
  int of_one = 0;
  for (int place = 0; place < kBlockVoxels; ++place) {
    expectSum(a[both], b[both], merged[both], place);
    ASSERT_FALSE(HasFailure()) << place;
    const int i = a[both].recordAt(place), m = merged[both].recordAt(place);
    if (i < 0 || b[both].recordAt(place) >= 0)
      continue;
    ++of_one;
    for (int k = 0; k < classes; ++k) {
      EXPECT_EQ(merged[both].refined[std::size_t(m * classes + k)], 0.0f)
          << "its neighbours are others now";
      EXPECT_EQ(merged[both].measured[std::size_t(m * classes + k)],
                a[both].measured[std::size_t(i * classes + k)]);
    }
  }
  EXPECT_GT(of_one, 50);
  EXPECT_TRUE(verifyArchive(folder.path("c")).empty());
}

TEST(ArchiveMerge, TheOrderDoesNotMatter)
{
  const TemporaryFolder folder;
  std::vector<std::string> paths;
  for (unsigned map = 0; map < 3; ++map) {
    Blocks blocks;
    for (int i = 0; i < 12; ++i)
      if ((i + int(map)) % 4 != 0)
        blocks[VoxelIndex(i, 0, 0)] = makeMapBlock(100, 20 * map + unsigned(i));
    paths.push_back(folder.path("map" + std::to_string(map)));
    ArchiveHeader header = makeArchiveHeader();
    header.parameters.fusion.hit_probability = 0.6 + 0.1 * map; // of several sensors
    writeMap(paths.back(), blocks, header, {1000.0 * map, 5.0, 0.0});
  }
  mergeArchives(placed(paths), folder.path("first"));
  const Blocks first = readBlocks(folder.path("first"));
  const auto stateOf = [](const std::string& path) {
    return MapArchive(path, ArchiveAccess::read).state().cloud_origin;
  };
  EXPECT_EQ(stateOf(folder.path("first")), Eigen::Vector3d(0, 5, 0));
  while (std::next_permutation(paths.begin(), paths.end())) {
    const std::string path = folder.path("again");
    fs::remove(path);
    mergeArchives(placed(paths), path);
    expectHolds(MapArchive(path, ArchiveAccess::read), first);
    EXPECT_EQ(stateOf(path), stateOf(folder.path("first")));
    EXPECT_TRUE(bytesOf(path) == bytesOf(folder.path("first")));
  }
}

TEST(ArchiveMerge, MapsThatDoNotFitAreRefused)
{
  const TemporaryFolder folder;
  writeMap(folder.path("a"), makeRandomBlocks(3, 1));
  const auto refusal = [&](const ArchiveHeader& header) {
    fs::remove(folder.path("b"));
    writeMap(folder.path("b"), makeRandomBlocks(3, 2), header);
    const std::string message = thrownMessage<BadInputException>([&] {
      mergeArchives(placed({folder.path("a"), folder.path("b")}), folder.path("c"));
    });
    EXPECT_FALSE(fs::exists(folder.path("c")));
    return message;
  };
  ArchiveHeader header = makeArchiveHeader();
  header.parameters.voxel_size = 0.2;
  EXPECT_EQ(refusal(header),
            folder.path("b") + ": has another voxel size than " + folder.path("a"));
  header = makeArchiveHeader();
  header.label_set = LabelSet({{"road", {}}, {"van", {}}, {"sky", {}, true}});
  EXPECT_TRUE(holds(refusal(header), "another label set"));
  header = makeArchiveHeader();
  header.parameters.fusion.label_max_ratio = 10.0;
  EXPECT_TRUE(holds(refusal(header), "label_max_ratio"));

  writeMap(folder.path("d"), makeRandomBlocks(3, 2));
  const auto bytes = bytesOf(folder.path("d"));
  EXPECT_EQ(
      thrownMessage<OutputException>([&] {
        mergeArchives(placed({folder.path("a"), folder.path("d")}), folder.path("d"));
      }),
      folder.path("d") + ": is there already");
  EXPECT_TRUE(bytesOf(folder.path("d")) == bytes);
  EXPECT_THROW(mergeArchives(placed({folder.path("a")}), folder.path("c")),
               InvalidParameterException);
}

namespace {

// A square across the x axis, in the frame of a map at \a T_world_map.
void
integrateSquare(double x, double half, Label label,
                const Eigen::Isometry3d& T_world_map, SemanticVoxelMap& map)
{
  pcl::PointCloud<pcl::PointXYZ> cloud;
  for (double y = -half; y <= half; y += 0.05)
    for (double z = -half; z <= half; z += 0.05)
      cloud.push_back({float(x), float(y), float(z)});
  LabelDistributions distributions(classes, Eigen::Index(cloud.size()));
  for (Eigen::Index i = 0; i < distributions.size(); ++i)
    distributions.setLabel(i, label, 0.9f);
  map.integrate(cloud, T_world_map.inverse(), distributions);
}

// Writes the map of a drive with a parked car, and with a car that stands before the
// parked one in the first drive and has left in the second.
void
writeDrive(const std::string& path, bool is_first, const Eigen::Isometry3d& T_world_map)
{
  ArchiveHeader header = makeArchiveHeader();
  header.parameters.window = {32, 32, 32};
  header.parameters.max_range = 20;
  SemanticVoxelMap map(header.label_set, header.parameters);
  for (int i = 0; i < 3; ++i)
    integrateSquare(12.1, 3.0, 2, T_world_map, map);
  for (int i = 0; i < 6; ++i)
    if (is_first) // six hits
      integrateSquare(6.1, 0.6, 2, T_world_map, map);
    else if (i < 3) // six misses with those before: fewer than the hits outweigh
      integrateSquare(9.1, 1.2, 1, T_world_map, map);
  saveMap(map, path);
}

} // namespace

TEST(ArchiveMerge, ACarThatLeftStaysAwayAndAParkedOneStays)
{
  const TemporaryFolder folder;
  Eigen::Isometry3d turned = Eigen::Isometry3d::Identity();
  turned.rotate(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ()));
  turned.pretranslate(Eigen::Vector3d(3.3, -1.2, 0.4));
  int number = 0;
  for (const Eigen::Isometry3d& motion : {Eigen::Isometry3d::Identity(), turned}) {
    const std::string first = folder.path("first" + std::to_string(number)),
                      second = folder.path("second" + std::to_string(number)),
                      merged = folder.path("merged" + std::to_string(number++));
    writeDrive(first, true, Eigen::Isometry3d::Identity());
    writeDrive(second, false, motion);
    mergeArchives({{first, Eigen::Isometry3d::Identity()}, {second, motion}}, merged);
    std::size_t left = 0, parked = 0;
    const auto map = loadMap(merged);
    map->moveWindow({8, 0, 0});
    const VoxelCloud occupied = map->occupied();
    for (const pcl::PointXYZRGBL& point : *occupied.cloud) {
      left += point.label == 2 && std::abs(point.x - 6.1f) < 0.4f;
      parked += point.label == 2 && std::abs(point.x - 12.1f) < 0.4f;
    }
    EXPECT_EQ(left, 0u) << number;
    EXPECT_GT(parked, 500u) << number;
  }
}

} // namespace pcl_semantic
