// SPDX-License-Identifier: BSD-3-Clause
#include "support/archives.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/trajectory_file.h>
#include <pcl_semantic/io/submaps.h>
#include <pcl_semantic/odometry/pose_source.h>
#include <pcl_semantic/pipeline/run_description.h>

#include <gtest/gtest.h>

namespace pcl_semantic {

namespace {

TEST(SubmapStarts, AreEverySoManyFramesOrMetres)
{
  std::vector<Eigen::Vector3d> positions;
  for (int i = 0; i < 10; ++i)
    positions.emplace_back(i < 5 ? i : 5, i < 5 ? 0 : i - 4, 0.0); // round a corner
  using Starts = std::vector<std::size_t>;
  EXPECT_EQ(submapStarts(positions, {0.0, 4}), (Starts{0, 4, 8}));
  EXPECT_EQ(submapStarts(positions, {0.0, 100}), (Starts{0}));
  EXPECT_EQ(submapStarts(positions, {3.0, 0}), (Starts{0, 3, 6, 9}));
  EXPECT_EQ(submapStarts(positions, {2.4, 0}), (Starts{0, 3, 5, 8}))
      << "the way round the corner is 1.4 m";
  EXPECT_EQ(submapStarts({}, {3.0, 0}), Starts());
  for (const SubmapLength& length :
       {SubmapLength{0.0, 0}, SubmapLength{1.0, 1}, SubmapLength{-1.0, 0},
        SubmapLength{std::nan(""), 0}, SubmapLength{0.0, -3}})
    EXPECT_THROW(submapStarts(positions, length), InvalidParameterException);
}

// A pose of a drive, turned and tilted.
Eigen::Isometry3d
somePose(int frame)
{
  Eigen::Isometry3d pose(Eigen::Translation3d(0.1 * frame, -0.02 * frame, 0.9 * frame));
  pose.rotate(
      Eigen::AngleAxisd(0.05 * frame, Eigen::Vector3d(0.1, 1.0, 0.2).normalized()));
  return pose;
}

MappingRun
someRun()
{
  MappingRun run;
  run.inputs = {{"sequence", "somewhere"}};
  run.T_camera0_camera.translation().x() = 0.06;
  run.label_set = threeClasses();
  return run;
}

class SubmapFile : public testing::Test {
protected:
  // Of the frames first to last, whose poses are \a poses.
  std::string
  write(const std::string& name, const MappingRun& run, int first, int last) const
  {
    ArchiveHeader header = makeArchiveHeader();
    header.configuration = describeRun(run);
    std::string path = folder_.path(name);
    const auto archive = MapArchive::create(path, header);
    archive->put({1, 2, 3}, makeRandomBlock(100, 3, 7));
    for (int frame = first; frame <= last; ++frame) {
      FrameRecord record;
      record.number = frame;
      record.timestamp = 0.1 * frame;
      record.T_world_camera =
          worldFromFirstCamera() * somePose(frame) * run.T_camera0_camera;
      archive->putFrame(frame, encodeFrameRecord(record));
    }
    archive->commit({});
    return path;
  }

  Eigen::Isometry3d
  motionBy(const std::string& submap, const std::string& trajectory) const
  {
    return submapMotion(MapArchive(submap, ArchiveAccess::read), trajectory);
  }

  TemporaryFolder folder_;
};

TEST_F(SubmapFile, MovesAsTheMiddleOfItsFrames)
{
  const std::string submap = write("a.map", someRun(), 3, 8);
  // All poses as they were: nothing moves.
  Trajectory poses;
  TimedTrajectory timed;
  for (int frame = 0; frame < 12; ++frame) {
    poses.push_back(somePose(frame));
    timed.push_back({0.1 * frame, somePose(frame)});
  }
  const std::string kitti = folder_.path("poses.txt"), tum = folder_.path("tum.txt");
  writeKittiTrajectory(kitti, poses);
  EXPECT_TRUE(motionBy(submap, kitti).isApprox(Eigen::Isometry3d::Identity(), 1e-9));
  // The anchor is frame 6; what becomes of the others does not matter.
  Eigen::Isometry3d motion(Eigen::Translation3d(3.0, -1.0, 0.5));
  motion.rotate(Eigen::AngleAxisd(0.2, Eigen::Vector3d(0.0, 0.1, 1.0).normalized()));
  const Eigen::Isometry3d W = worldFromFirstCamera();
  timed[6].pose = poses[6] = W.inverse() * motion * W * somePose(6);
  poses[3] = timed[3].pose = Eigen::Isometry3d::Identity();
  writeKittiTrajectory(kitti, poses);
  writeTumTrajectory(tum, timed);
  EXPECT_TRUE(motionBy(submap, kitti).isApprox(motion, 1e-9));
  EXPECT_TRUE(motionBy(submap, tum).isApprox(motion, 1e-7)) << "found by its time";
}

TEST_F(SubmapFile, OfASensorWithPosesOfItsOwn)
{
  MappingRun run = someRun();
  run.inputs = {{"clouds", "somewhere"}, {"sensor", "own"}};
  run.T_camera0_camera.setIdentity();
  const std::string submap = write("own.map", run, 0, 0);
  const Eigen::Isometry3d motion(Eigen::Translation3d(3.0, -1.0, 0.5));
  const std::string path = folder_.path("poses.txt");
  writeKittiTrajectory(path, {motion * worldFromFirstCamera() * somePose(0)});
  EXPECT_TRUE(motionBy(submap, path).isApprox(motion, 1e-9));
}

TEST_F(SubmapFile, SaysWhatItsPosesLack)
{
  const std::string submap = write("a.map", someRun(), 3, 8);
  const std::string path = folder_.path("poses.txt");
  writeKittiTrajectory(path, {somePose(0), somePose(1)});
  const auto refusal = [&](const std::string& archive) {
    return thrownMessage<BadInputException>([&] { motionBy(archive, path); });
  };
  EXPECT_EQ(refusal(submap),
            submap + ": " + path +
                ": has 2 poses, none for frame 6 (row = frame number)");
  const std::string empty = write("empty.map", someRun(), 1, 0);
  EXPECT_EQ(refusal(empty), empty + ": holds no frame whose pose could be corrected");
  ArchiveHeader header = makeArchiveHeader();
  const std::string other = folder_.path("other.map");
  const auto archive = MapArchive::create(other, header);
  archive->putFrame(0, encodeFrameRecord({}));
  archive->commit({});
  EXPECT_TRUE(holds(refusal(other), "has no camera_pose"));
}

TEST(RunDescription, TellsTheParametersOfItsRun)
{
  MappingRun run = someRun();
  run.config.map.voxel_size = 0.123456789;
  run.config.map.window = {10.5, 20.0, 5.25};
  run.config.crf = CRFModelType::hierarchical;
  run.config.crf_parameters.smoothness_weight = 4.5;
  EXPECT_EQ(
      describeRun({{},
                   {},
                   {},
                   Eigen::Isometry3d::Identity(),
                   run.label_set,
                   configOf(describeRun(run))}),
      describeRun(
          {{}, {}, {}, Eigen::Isometry3d::Identity(), run.label_set, run.config}));
  EXPECT_EQ(configOf("merged_1: a.map\n").crf, MapperConfig().crf);
  EXPECT_THROW(configOf("voxel_size: much\n"), BadInputException);
}

} // namespace

} // namespace pcl_semantic
