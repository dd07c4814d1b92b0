// SPDX-License-Identifier: BSD-3-Clause
#include "messages.h"
#include "pair_watch.h"
#include "sequence_options.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/dataset/frame_sequence.h>
#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/files/trajectory_file.h>
#include <pcl_semantic/odometry/stereo_odometry.h>

#include <filesystem>
#include <locale>
#include <sstream>

using namespace pcl_semantic;

namespace {

const tool::Usage usage{"pcl_semantic_odometry",
                        "(SEQUENCE | --left 'L*.png' --right 'R*.png' --calibration "
                        "FILE.yaml) OUT.txt\n  [options]",
                        "Poses of a stereo sequence from its images alone, of camera 0 "
                        "in the frame of the\n"
                        "first one, as KITTI or TUM trajectory.",
                        "pcl_semantic_synthesize /tmp/street && \\\n"
                        "  pcl_semantic_odometry /tmp/street /tmp/poses.txt"};

struct Options {
  tool::SequenceOptions sequence;
  std::string output, report;
  std::string format = "kitti", frames = ":";
  int threads = 0;
  StereoOdometry::Parameters parameters;
};

bool
parseOptions(int argc, char** argv, Options& options)
{
  namespace po = tool::po;
  po::options_description visible("Options");
  StereoOdometry::Parameters& parameters = options.parameters;
  tool::addSequenceOptions(options.sequence, visible);
  visible.add_options()("output", po::value(&options.output), "output trajectory")(
      "report", po::value(&options.report),
      "output table (.csv): tracked features and covariance of each pose");
  tool::addOption(
      visible, "format", options.format,
      "format of the output: kitti (12 numbers per row) or tum (time, quaternion)");
  tool::addOption(visible, "frames", options.frames,
                  "A:B = frames with numbers A <= n < B");
  tool::addOption(visible, "threads", options.threads,
                  "number of threads; 0 = all processors");
  tool::addOption(visible, "features", parameters.features,
                  "maximum number of tracked features");
  tool::addOption(visible, "window", parameters.window,
                  "number of keyframes in the bundle adjustment");
  tool::addOption(visible, "offset-drift", parameters.offset_drift,
                  "standard deviation of the change of the disparity offset per "
                  "keyframe [px]; 0 = no offset");
  po::positional_options_description positional;
  positional.add("sequence", 1).add("output", 1);
  po::variables_map values;
  if (!tool::parseCommandLine(argc, argv, usage, visible, positional, values))
    return false;
  if (options.sequence.hasFiles() && options.output.empty())
    std::swap(options.sequence.folder, options.output); // OUT.txt is the only one
  tool::requireSequence(options.sequence, usage.name);
  if (options.output.empty())
    tool::failUsage(usage, "OUT.txt is missing");
  if (options.format != "kitti" && options.format != "tum")
    tool::failUsage(usage,
                    "--format is '" + options.format + "', expected kitti or tum");
  parameters.validate();
  return true;
}

// Row n of a KITTI trajectory is frame n.
void
requireRowsAreFrames(const FrameSequence& sequence,
                     const std::vector<std::size_t>& frames)
{
  for (std::size_t row = 0; row < frames.size(); ++row)
    if (sequence.frameNumber(frames[row]) != int(row))
      tool::failUsage(usage, "frame " + std::to_string(row) +
                                 " is not there, but row n of a KITTI trajectory is "
                                 "frame n; use --format tum");
}

// What comes out, frame by frame.
struct Results {
  TimedTrajectory trajectory;
  std::vector<int> lost;
  std::ostringstream report;

  Results()
  {
    report.imbue(std::locale::classic());
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
writeResults(const Options& options, const Results& results)
{
  const std::size_t frames = results.trajectory.size();
  const std::string& name = options.sequence.name();
  if (frames > 1 && results.lost.size() + 1 == frames)
    PCL_THROW_EXCEPTION(BadInputException, name << ": no frame could be tracked");
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
    tool::warn(tool::shown(results.lost.size()) + " of " + tool::shown(frames) +
               " frames could not be tracked, the first is " +
               tool::shown(results.lost.front()) + ": their poses are predicted");
  tool::printResults({{"poses", std::size_t(frames)},
                      {"predicted", results.lost.size()},
                      {"trajectory", options.output}});
}

int
track(const Options& options)
{
  for (const std::string& path : {options.output, options.report})
    if (std::filesystem::path(path).extension() == ".png")
      tool::failUsage(usage, path + ": is a name for an image");
  setNumberOfThreads(options.threads);
  parseFrameRange(options.frames); // wrong options are found first
  const std::unique_ptr<FrameSequence> opened = tool::openSequence(options.sequence);
  const FrameSequence& sequence = *opened;
  tool::refuseSameFiles(tool::textFilesOf(options.sequence, sequence),
                        {options.output, options.report});
  const std::vector<std::size_t> frames =
      tool::chooseFrames(options.sequence, sequence, options.frames);
  if (options.format == "kitti")
    requireRowsAreFrames(sequence, frames);
  StereoOdometry odometry(sequence.camera(), sequence.T_camera0_camera(),
                          options.parameters);
  Results results;
  tool::catchInterrupts();
  {
    tool::PairWatch watch(options.sequence.strict, sequence.camera());
    tool::ProgressBar progress("tracking", frames.size());
    for (const std::size_t i : frames) {
      const StereoFrame frame = sequence.frame(i);
      watch.look(frame);
      const OdometryResult& result = odometry.process(frame);
      results.add(frame.timestamp,
                  worldFromFirstCamera().inverse() * result.T_world_camera *
                      sequence.T_camera0_camera().inverse(),
                  result);
      if (tool::interrupted())
        return tool::exit_interrupted;
      progress.step();
    }
  }
  writeResults(options, results);
  return tool::exit_done;
}

} // namespace

int
main(int argc, char** argv)
{
  return tool::run(usage.name, [&] {
    Options options;
    return parseOptions(argc, argv, options) ? track(options) : int(tool::exit_done);
  });
}
