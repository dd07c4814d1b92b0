// SPDX-License-Identifier: BSD-3-Clause
#include "core/text_stream.h"
#include "image_tool.h"
#include "messages.h"
#include "sequence_options.h"

#include <pcl_semantic/core/camera_doubts.h>
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/dataset/frame_source.h>
#include <pcl_semantic/dataset/rgbd_sequence.h>
#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/files/trajectory_file.h>
#include <pcl_semantic/images/image_file.h>
#include <pcl_semantic/odometry/stereo_odometry.h>

#include <algorithm>
#include <filesystem>

using namespace pcl_semantic;
using namespace pcl_semantic::tool;

namespace {

const Usage usage{
    "pcl_semantic_odometry",
    R"((SEQUENCE | --left 'L*.png' --right 'R*.png' --calibration FILE.yaml)
  OUT.txt [options]
or --rgbd DIR (--calibration FILE | --intrinsics FX,FY,CX,CY) OUT.txt [options])",
    R"(Estimates the poses of a stereo or RGB-D sequence from its images and writes them as a
KITTI or TUM trajectory: poses of camera 0 in the frame of the first one. For an RGB-D
sequence, poses of its camera in a world with z up, as pcl_semantic_map reads them.)",
    R"(pcl_semantic_synthesize /tmp/street && \
  pcl_semantic_odometry /tmp/street /tmp/poses.txt)",
    {{"left GLOB, --right GLOB", "images of any stereo camera, instead of SEQUENCE"},
     {"calibration FILE",
      "calibration of --left and --right: OpenCV, Kalibr, ROS, KITTI"},
     {"rgbd DIR", "RGB-D sequence, with --calibration or --intrinsics"},
     {"format kitti", "format of OUT.txt: kitti or tum"},
     {"frames A:B", "frames with numbers A <= n < B"},
     {"report FILE", "table (.csv) of tracked features and their errors"},
     {"threads 0", "number of threads; 0 = all processors"}}};

struct Options {
  SequenceFiles sequence;
  RgbdFiles rgbd; // instead of the sequence
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
  std::vector<Option> all = withSequence(
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
        "[px]; 0 = no offset"}});
  for (Option& option : optionsOf(parametersOf(options.rgbd)))
    all.push_back(std::move(option));
  const po::variables_map values =
      parseCommandLine(argc, argv, usage, all, {"sequence", "output"});
  const bool is_rgbd = !options.rgbd.folder.empty();
  if ((options.sequence.hasFiles() || is_rgbd) && options.output.empty())
    std::swap(options.sequence.folder, options.output); // OUT.txt is the only one
  refuseUnread(
      values,
      {{is_rgbd,
        "with --rgbd",
        {"left", "right", "extrinsics", "times", "strict", "offset-drift"}},
       {!is_rgbd, "without --rgbd", {"intrinsics", "depth-scale", "depth-within"}}});
  refuseIf(is_rgbd && !options.sequence.folder.empty(),
           "--rgbd and a SEQUENCE exclude each other");
  asUsage([&] {
    is_rgbd ? options.rgbd.requireCamera(options.sequence.files.calibration)
            : options.sequence.validate();
  });
  refuseIf(options.output.empty(), "OUT.txt is missing");
  refuseIf(options.format != "kitti" && options.format != "tum",
           "--format is '" + options.format + "', expected kitti or tum");
  parameters.validate();
  return options;
}

// Row n of a KITTI trajectory is frame n.
void
requireRowsAreFrames(const std::vector<FrameTime>& frames)
{
  for (std::size_t row = 0; row < frames.size(); ++row)
    refuseIf(frames[row].number != int(row),
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

const std::string&
nameOf(const Options& options)
{
  return options.rgbd.folder.empty() ? options.sequence.name() : options.rgbd.folder;
}

void
writeResults(const Options& options, const Tracked& results)
{
  const std::size_t frames = results.trajectory.size();
  const std::string& name = nameOf(options);
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

// Opened frames, and their odometry.
struct Tracking {
  std::unique_ptr<FrameSource> source;
  std::unique_ptr<StereoOdometry> odometry;
  Eigen::Isometry3d T_file_world; // of the trajectory file
};

Tracking
openStereo(const Options& options)
{
  const std::shared_ptr<FrameSequence> sequence = openSequenceOf(options.sequence);
  const ImagePairFiles& files = options.sequence.files;
  const std::string& folder = options.sequence.folder;
  refuseSameFiles({files.calibration, files.extrinsics, files.times,
                   sequence->posesPath(), folder + "/calib.txt", folder + "/times.txt"},
                  {options.output, options.report});
  warnOf(doubtsOf(sequence->camera(), options.sequence.strict));
  return {std::make_unique<RecordedFrames>(sequence, parseFrameRange(options.frames)),
          std::make_unique<StereoOdometry>(
              sequence->camera(), sequence->T_camera0_camera(), options.parameters),
          worldFromFirstCamera().inverse()};
}

Tracking
openRgbd(const Options& options)
{
  const auto sequence = std::make_shared<const RgbdSequence>(
      options.rgbd, options.sequence.files.calibration);
  warnOf(sequence->doubts());
  const std::string& folder = options.rgbd.folder;
  refuseSameFiles({options.sequence.files.calibration, sequence->posesPath(),
                   folder + "/rgb.txt", folder + "/depth.txt"},
                  {options.output, options.report});
  StereoOdometry::Parameters parameters = StereoOdometry::parametersOfDepths();
  parameters.features = options.parameters.features;
  parameters.window = options.parameters.window;
  return {std::make_unique<RecordedFrames>(sequence, parseFrameRange(options.frames)),
          std::make_unique<StereoOdometry>(
              StereoOdometry::cameraOfDepths(sequence->camera()),
              Eigen::Isometry3d::Identity(), parameters),
          Eigen::Isometry3d::Identity()};
}

bool
isImageName(const std::string& path)
{
  const auto& all = imageExtensions();
  return std::count(all.begin(), all.end(),
                    std::filesystem::path(path).extension().string()) > 0;
}

int
track(const Options& options)
{
  for (const std::string& path : {options.output, options.report})
    refuseIf(isImageName(path),
             path +
                 ": is the name of an image, expected that of a trajectory or table");
  setNumberOfThreads(options.threads);
  parseFrameRange(options.frames); // reports wrong options first
  Tracking tracking =
      options.rgbd.folder.empty() ? openStereo(options) : openRgbd(options);
  const std::vector<FrameTime>& frames = tracking.source->frames();
  if (frames.empty())
    fail<BadInputException>(nameOf(options), ": has no frame in ", options.frames);
  if (options.format == "kitti")
    requireRowsAreFrames(frames);
  Tracked results;
  {
    PairWatch watch(options.sequence.strict);
    forEachStep("tracking", frames.size(), [&](std::size_t i) {
      tracking.source->seek(i);
      const SensorFrame frame = *tracking.source->next();
      if (const auto* const pair = std::get_if<StereoFrame>(&frame))
        watch.look(*pair);
      tracking.odometry->pose(frame);
      const OdometryResult& result = tracking.odometry->result();
      results.add(frames[i].timestamp,
                  tracking.T_file_world * result.T_world_camera *
                      tracking.source->sensor().T_camera0_sensor.inverse(),
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
