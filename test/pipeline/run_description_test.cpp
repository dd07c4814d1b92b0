// SPDX-License-Identifier: BSD-3-Clause
#include "support/temporary_folder.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/pipeline/run_description.h>

#include <gtest/gtest.h>

namespace pcl_semantic {

namespace {

MappingRun
makeRun(const std::string& poses)
{
  MappingRun run;
  run.inputs = {{"sequence", "streets/05"}, {"poses", poses}, {"network", ""}};
  run.frames = {2, 3, 7};
  run.camera.emplace();
  run.camera->fx = 700.1;
  run.camera->baseline = 0.5;
  run.label_set = LabelSet({{"road", {1, 2, 3}}, {"car", {4, 5, 6}, false, true}});
  return run;
}

} // namespace

TEST(RunDescription, NamesWhatHasChanged)
{
  const TemporaryFolder folder;
  const std::string poses = folder.write("poses.txt", "1 2 3");
  const std::string before = describeRun(makeRun(poses));
  EXPECT_EQ(changeOfRun(before, describeRun(makeRun(poses))), "");

  const auto change = [&](auto&& edit) {
    MappingRun run = makeRun(poses);
    edit(run);
    const std::string there = changeOfRun(before, describeRun(run));
    EXPECT_EQ(there.empty(), changeOfRun(describeRun(run), before).empty());
    return there;
  };
  EXPECT_EQ(change([](MappingRun& run) { run.config.threads = 5; }), "");
  EXPECT_EQ(change([](MappingRun& run) { run.config.map.voxel_size = 0.1 + 1e-9; }),
            "voxel_size was 0.1, is 0.100000001");
  EXPECT_EQ(change([](MappingRun& run) { run.config.map.window.y() = 12.5; }),
            "window was 0,0,0, is 0,12.5,0");
  EXPECT_EQ(change([](MappingRun& run) { run.config.crf = CRFModelType::unary; }),
            "crf was dense, is none");
  EXPECT_EQ(change([](MappingRun& run) { run.frames.push_back(8); }),
            "frames was 3, from 2 to 7, is 4, from 2 to 8");
  EXPECT_EQ(change([](MappingRun& run) { run.inputs[2].second = "net.yaml"; }),
            "network was none, is net.yaml");
  EXPECT_EQ(change([](MappingRun& run) { run.inputs[0].second = "streets/06"; }),
            "sequence was streets/05, is streets/06");
  EXPECT_TRUE(holds(change([](MappingRun& run) { run.camera->baseline += 1e-12; }),
                    "camera was 700.1 0 0 0 0.5 0x0, is 700.1 0 0 0 0.50000000000"));
  EXPECT_TRUE(holds(
      change([](MappingRun& run) { run.T_camera0_camera.translation().x() = 0.06; }),
      "camera_pose was "));
  EXPECT_EQ(change([](MappingRun& run) {
              run.label_set = LabelSet({{"road", {1, 2, 3}}, {"car", {4, 5, 6}}});
            }),
            "class_2 was car 4 5 6 dynamic, is car 4 5 6");

  folder.write("poses.txt", "1 2 4");
  EXPECT_TRUE(holds(changeOfRun(before, describeRun(makeRun(poses))),
                    "poses was " + poses + " (digest "));
}

TEST(FrameRecord, SurvivesBytes)
{
  FrameRecord record;
  record.number = 12;
  record.T_world_camera = Eigen::Translation3d(1e6 / 3, -2.0 / 7, 0.1) *
                          Eigen::AngleAxisd(0.3, Eigen::Vector3d(1, 2, 3).normalized());
  record.counts.points = 5;
  record.counts.rays = 1ull << 40;
  record.counts.seen_through = 2;
  record.counts.hit_voxels = 3;
  record.seconds = {{"stereo", 0.1}, {"map", 1.0 / 3.0}};
  record.domain_shift = 2.0 / 3.0;
  record.timestamp = 1e9 / 3.0;
  record.digest = {1ull << 63, 7};
  std::vector<std::uint8_t> bytes = encodeFrameRecord(record);
  const FrameRecord read = decodeFrameRecord(12, bytes);
  EXPECT_EQ(read.number, 12);
  EXPECT_EQ(read.T_world_camera.matrix(), record.T_world_camera.matrix());
  EXPECT_EQ(read.counts.points, 5u);
  EXPECT_EQ(read.counts.rays, 1ull << 40);
  EXPECT_EQ(read.counts.seen_through, 2u);
  EXPECT_EQ(read.counts.hit_voxels, 3u);
  EXPECT_EQ(read.seconds, record.seconds);
  EXPECT_EQ(read.domain_shift, record.domain_shift);
  EXPECT_EQ(read.timestamp, record.timestamp);
  EXPECT_EQ(read.digest.data, 1ull << 63);
  EXPECT_EQ(read.digest.labels, 7u);
  const auto decodeFirst = [&](std::size_t size) {
    return decodeFrameRecord(12, {bytes.begin(), bytes.begin() + long(size)});
  };
  const std::size_t recent = bytes.size() - 2 * sizeof(std::uint64_t);
  EXPECT_EQ(decodeFirst(recent).timestamp, record.timestamp);
  EXPECT_EQ(decodeFirst(recent).digest.data, 0u);
  const std::size_t old = recent - sizeof(double), older = old - sizeof(double);
  EXPECT_EQ(decodeFirst(old).domain_shift, record.domain_shift);
  EXPECT_TRUE(std::isnan(decodeFirst(old).timestamp));
  EXPECT_EQ(decodeFirst(older).seconds, record.seconds);
  EXPECT_TRUE(std::isnan(decodeFirst(older).domain_shift));
  for (std::size_t size = 0; size < bytes.size(); ++size)
    if (size != recent && size != old && size != older) {
      EXPECT_THROW(decodeFirst(size), BadInputException);
    }
  bytes.push_back(0);
  EXPECT_THROW(decodeFrameRecord(12, bytes), BadInputException);
}

} // namespace pcl_semantic
