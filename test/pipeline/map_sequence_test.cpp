// SPDX-License-Identifier: BSD-3-Clause
#include "support/known_frames.h"
#include "support/temporary_folder.h"
#include "synthesize/sequence.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/trajectory_file.h>
#include <pcl_semantic/odometry/trajectory_poses.h>
#include <pcl_semantic/pipeline/map_sequence.h>

#include <gtest/gtest.h>

using namespace pcl_semantic;

namespace {

// The street with a trajectory beside it.
class Street : public SyntheticSequence {
public:
  explicit Street(std::string poses)
      : SyntheticSequence(3, 208, 64), poses_(std::move(poses))
  {}

  std::string
  posesPath() const override
  {
    return poses_;
  }

private:
  std::string poses_;
};

// Counts how often it is asked.
std::unique_ptr<LabelPredictor>
labelsOf(const Street& street, int& calls)
{
  return std::make_unique<KnownLabels>([&](int number) {
    ++calls;
    return street.labels(std::size_t(number));
  });
}

LabelSet
elevenClasses()
{
  std::vector<LabelClass> classes(synthetic_classes);
  for (std::size_t i = 0; i < classes.size(); ++i)
    classes[i].name = "class" + std::to_string(i);
  classes[synthetic_sky - 1].sky = true;
  return LabelSet(classes);
}

MapperConfig
coarse()
{
  MapperConfig config;
  config.map.voxel_size = 0.25;
  config.crf_every = 3; // finish() runs the last
  return config;
}

VoxelCloud
mapOf(const Street& street, int& calls)
{
  return mapSequence(street, elevenClasses(), labelsOf(street, calls), coarse());
}

// A row for each of the first frames of the street.
std::string
trajectory(int frames)
{
  const SyntheticScene scene(1, 3);
  Trajectory poses;
  for (int frame = 0; frame < frames; ++frame)
    poses.push_back(scene.kittiPose(frame));
  static const TemporaryFolder folder;
  const std::string path = folder.path(std::to_string(frames) + ".txt");
  writeKittiTrajectory(path, poses);
  return path;
}

} // namespace

TEST(MapSequence, IsTheMapperOverAllFrames)
{
  const Street street(trajectory(3));
  int calls = 0;
  const VoxelCloud voxels = mapOf(street, calls);
  EXPECT_EQ(calls, 3);
  SemanticMapper mapper(elevenClasses(), coarse(),
                        readPoses(street.posesPath(), street.T_camera0_camera()),
                        street.camera(), labelsOf(street, calls));
  for (std::size_t i = 0; i < 3; ++i)
    mapper.process(street.frame(i));
  mapper.finish();
  const VoxelCloud expected = mapper.map().occupiedEverywhere();
  EXPECT_GT(voxels.size(), 1000u);
  EXPECT_EQ(voxels.indices, expected.indices);
  EXPECT_EQ(voxels.refined.matrix(), expected.refined.matrix());
  EXPECT_NE(voxels.refined.matrix(), voxels.measured.matrix());
}

TEST(MapSequence, FindsPosesWhereThereAreNone)
{
  int calls = 0;
  const VoxelCloud given = mapOf(Street(trajectory(3)), calls);
  const VoxelCloud found = mapOf(Street(""), calls);
  EXPECT_NE(found.indices, given.indices); // not bit-identical
  EXPECT_NEAR(double(found.size()), double(given.size()), 0.05 * double(given.size()));
}

TEST(MapSequence, RefusesAMissingPoseBeforeTheFirstFrame)
{
  int calls = 0;
  EXPECT_THROW(mapOf(Street(trajectory(2)), calls), BadInputException);
  EXPECT_EQ(calls, 0);
}
