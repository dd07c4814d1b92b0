// SPDX-License-Identifier: BSD-3-Clause
#include "core/text_stream.h"
#include "image_tool.h"
#include "messages.h"
#include "sequence_options.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/dataset/frame_sequence.h>
#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/files/trajectory_file.h>
#include <pcl_semantic/odometry/stereo_odometry.h>

#include <filesystem>

using namespace pcl_semantic;
using namespace pcl_semantic::tool;

namespace {

const Usage usage{
    "pcl_semantic_odometry",
    R"((SEQUENCE | --left 'L*.png' --right 'R*.png' --calibration FILE.yaml)
  OUT.txt [options])",
    R"(Estimates the poses of a stereo sequence from its images and writes them as a KITTI or
TUM trajectory: poses of camera 0 in the frame of the first one.)",
    R"(pcl_semantic_synthesize /tmp/street && \
  pcl_semantic_odometry /tmp/street /tmp/poses.txt)",
    {{"left GLOB, --right GLOB", "images of any stereo camera, instead of SEQUENCE"},
     {"calibration FILE",
      "calibration of --left and --right: OpenCV, Kalibr, ROS, KITTI"},
     {"format kitti", "format of OUT.txt: kitti or tum"},
     {"frames A:B", "frames with numbers A <= n < B"},
     {"report FILE", "table (.csv) of tracked features and their errors"},
     {"threads 0", "number of threads; 0 = all processors"}}};

struct Options {
  SequenceFiles sequence;
  std::string output, report;
  std::string format = "kitti", frames = ":";
  int threads = 0;
  StereoOdometry::Parameters parameters;
};

Options
parse(int argc, char** argv)
{
  Options options;
  StereoOdometry::Parameters& parameters = options.parameters;
  parseCommandLine(
      argc, argv, usage,
      withSequence(
          options.sequence,
          {{"output", options.output, "output trajectory (.txt)"},
           {"report", options.report,
            "output table (.csv): tracked features and covariance of each pose"},
           {"format", withDefault(options.format),
            "format of the output: kitti (12 numbers per row) or tum (time, "
            "quaternion)"},
           {"frames", withDefault(options.frames),
            "A:B = frames with numbers A <= n < B; : = all"},
           {"threads", withDefault(options.threads),
            "number of threads; 0 = all processors"},
           {"features", withDefault(parameters.features),
            "maximum number of tracked features"},
           {"window", withDefault(parameters.window),
            "number of keyframes in the bundle adjustment"},
           {"offset-drift", withDefault(parameters.offset_drift),
            "standard deviation of the change of the disparity offset per keyframe "
            "[px]; 0 = no offset"}}),
      {"sequence", "output"});
  if (options.sequence.hasFiles() && options.output.empty())
    std::swap(options.sequence.folder, options.output); // OUT.txt is the only one
  asUsage([&] { options.sequence.validate(); });
  refuseIf(options.output.empty(), "OUT.txt is missing");
  refuseIf(options.format != "kitti" && options.format != "tum",
           "--format is '" + options.format + "', expected kitti or tum");
  parameters.validate();
  return options;
}

// Row n of a KITTI trajectory is frame n.
void
requireRowsAreFrames(const FrameSequence& sequence,
                     const std::vector<std::size_t>& frames)
{
  for (std::size_t row = 0; row < frames.size(); ++row)
    refuseIf(sequence.frameNumber(frames[row]) != int(row),
             "frame " + std::to_string(row) +
                 " is not there, but row n of a KITTI trajectory is frame n; use "
                 "--format tum");
}

// Results per frame.
struct Tracked {
  TimedTrajectory trajectory;
  std::vector<int> lost;
  TextStream report;

  Tracked()
  {
    report.precision(9);
    report << "frame,time,tracked,inliers,lost,keyframe,disparity_offset";
    for (int i = 0; i < 36; ++i)
      report << ",c" << i / 6 << i % 6;
    report << "\n";
  }

  void
  add(double time, const Eigen::Isometry3d& pose, const OdometryResult& result)
  {
    trajectory.push_back({time, pose});
    if (result.is_lost)
      lost.push_back(result.frame);
    report << result.frame << ',' << time << ',' << result.tracked << ','
           << result.inliers << ',' << result.is_lost << ',' << result.is_keyframe
           << ',' << result.disparity_offset;
    for (int i = 0; i < 36; ++i)
      report << ',' << result.covariance(i / 6, i % 6);
    report << "\n";
  }
};

void
writeResults(const Options& options, const Tracked& results)
{
  const std::size_t frames = results.trajectory.size();
  const std::string& name = options.sequence.name();
  if (frames > 1 && results.lost.size() + 1 == frames)
    fail<BadInputException>(name, ": no frame could be tracked");
  Trajectory poses;
  for (const TimedPose& timed : results.trajectory)
    poses.push_back(timed.pose);
  if (options.format == "tum")
    writeTumTrajectory(options.output, results.trajectory);
  else
    writeKittiTrajectory(options.output, poses);
  if (!options.report.empty())
    writeTextFile(options.report, results.report.str());
  if (!results.lost.empty())
    warn(shown(results.lost.size()) + " of " + shown(frames) +
         " frames could not be tracked, the first is " + shown(results.lost.front()) +
         ": their poses are predicted");
  printResults({{"poses", std::size_t(frames)},
                {"predicted", results.lost.size()},
                {"trajectory", options.output}});
}

int
track(const Options& options)
{
  for (const std::string& path : {options.output, options.report})
    refuseIf(std::filesystem::path(path).extension() == ".png",
             path +
                 ": is the name of an image, expected that of a trajectory or table");
  setNumberOfThreads(options.threads);
  parseFrameRange(options.frames); // reports wrong options first
  const std::unique_ptr<FrameSequence> opened = openSequenceOf(options.sequence);
  const FrameSequence& sequence = *opened;
  const ImagePairFiles& files = options.sequence.files;
  const std::string& folder = options.sequence.folder;
  refuseSameFiles({files.calibration, files.extrinsics, files.times,
                   sequence.posesPath(), folder + "/calib.txt", folder + "/times.txt"},
                  {options.output, options.report});
  const std::vector<std::size_t> frames =
      chooseFrames(options.sequence.name(), sequence, options.frames);
  if (options.format == "kitti")
    requireRowsAreFrames(sequence, frames);
  StereoOdometry odometry(sequence.camera(), sequence.T_camera0_camera(),
                          options.parameters);
  Tracked results;
  {
    PairWatch watch(options.sequence.strict, sequence.camera());
    forEachStep("tracking", frames.size(), [&](std::size_t i) {
      const StereoFrame frame = sequence.frame(frames[i]);
      watch.look(frame);
      const OdometryResult& result = odometry.process(frame);
      results.add(frame.timestamp,
                  worldFromFirstCamera().inverse() * result.T_world_camera *
                      sequence.T_camera0_camera().inverse(),
                  result);
    });
  }
  writeResults(options, results);
  return exit_done;
}

} // namespace

int
main(int argc, char** argv)
{
  return runWithImages(usage.name, [&] { return track(parse(argc, argv)); });
}
