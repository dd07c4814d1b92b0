// SPDX-License-Identifier: BSD-3-Clause

// Accuracy and speed of StereoOdometry: bench_odometry [frames of the street]

#include "bench/ratio.h"
#include "support/kitti_errors.h"
#include "synthesize/renderer.h"

#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/dataset/kitti_sequence.h>
#include <pcl_semantic/odometry/stereo_odometry.h>

#include <cstdlib>
#include <ctime>
#include <string>

namespace {

using namespace pcl_semantic;

constexpr std::size_t kInterpolated = 12; // first rows of 06: see doc/odometry.md

struct Drive {
  StereoCamera camera;
  Eigen::Isometry3d T_camera0_camera = Eigen::Isometry3d::Identity();
  std::vector<StereoFrame> frames;
  Trajectory truth;
};

double
processorSeconds()
{
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return double(time.tv_sec) + 1e-9 * double(time.tv_nsec);
}

Drive
readKitti(const std::string& folder)
{
  const KittiSequence sequence(folder);
  const Trajectory truth = readKittiTrajectory(sequence.posesPath());
  Drive drive{sequence.camera(), sequence.T_camera0_camera(), {}, {}};
  for (std::size_t i = 0; i < sequence.size(); ++i) {
    drive.frames.push_back(sequence.frame(i));
    drive.truth.push_back(truth.at(std::size_t(sequence.frameNumber(i))));
  }
  return drive;
}

Drive
renderStreet(int frames)
{
  const SyntheticScene scene(1, frames);
  const SyntheticRenderer renderer(scene, 620, 188);
  Drive drive{renderer.camera(), Eigen::Isometry3d::Identity(), {}, {}};
  drive.T_camera0_camera.translation().x() = SyntheticRenderer::camera_2_offset;
  for (int i = 0; i < frames; ++i) {
    const SyntheticView view = renderer.render(i);
    drive.frames.push_back(
        {{i, i * SyntheticScene::seconds_per_frame}, view.left, view.right});
    drive.truth.push_back(scene.kittiPose(i));
  }
  return drive;
}

Trajectory
track(const std::string& name, const Drive& drive)
{
  Trajectory poses;
  StereoOdometry odometry(drive.camera, drive.T_camera0_camera);
  const double processor = processorSeconds();
  const double wall = secondsOf([&] {
    for (const StereoFrame& frame : drive.frames)
      poses.push_back(worldFromFirstCamera().inverse() * odometry.pose(frame) *
                      drive.T_camera0_camera.inverse());
  });
  const double count = double(drive.frames.size());
  std::printf("%s: %.0f frames, %.1f m, %d lost; a frame: %.1f ms, processor %.1f ms\n",
              name.c_str(), count, waysAlong(drive.truth).back(), odometry.lostFrames(),
              1e3 * wall / count, 1e3 * (processorSeconds() - processor) / count);
  printRatio(name + "_time", 0.03 / (wall / count), 1);
  return poses;
}

SegmentErrors
printErrors(const std::string& name, const Trajectory& truth,
            const Trajectory& estimate, std::size_t first)
{
  const auto from = std::ptrdiff_t(first);
  const SegmentErrors errors =
      kittiErrors({truth.begin() + from, truth.end()},
                  {estimate.begin() + from, estimate.end()}, {10, 20, 30, 40, 50});
  std::printf("%s: translation %.3f %%, rotation %.5f degrees/m (%zu pieces)\n",
              name.c_str(), 100.0 * errors.translation, errors.rotation * 180.0 / M_PI,
              errors.segments);
  return errors;
}

} // namespace

int
main(int argc, char** argv)
{
  setNumberOfThreads(2);
  const Drive street = renderStreet(argc > 1 ? std::atoi(argv[1]) : 500);
  const Trajectory driven = track("street", street);
  printRatio("street_translation",
             0.005 / printErrors("street", street.truth, driven, 0).translation, 1);
  const char* const data = std::getenv("PCL_SEMANTIC_DATA");
  if (!data) {
    std::printf("KITTI 06 skipped: PCL_SEMANTIC_DATA is not set\n");
    return 0;
  }
  const Drive kitti = readKitti(std::string(data) + "/kitti_gray/06");
  const Trajectory poses = track("kitti_06", kitti);
  const double degree = M_PI / 180.0;
  const SegmentErrors all = printErrors("kitti_06", kitti.truth, poses, 0);
  printRatio("kitti_06_translation", 0.01 / all.translation, 1);
  printRatio("kitti_06_rotation", 0.004 * degree / all.rotation, 1);
  const SegmentErrors rest =
      printErrors("kitti_06 from frame 12", kitti.truth, poses, kInterpolated);
  printRatio("kitti_06_from_12_translation", 0.01 / rest.translation, 1);
  printRatio("kitti_06_from_12_rotation", 0.004 * degree / rest.rotation, 1);
  return 0;
}
