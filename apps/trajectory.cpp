// SPDX-License-Identifier: BSD-3-Clause
#include "messages.h"
#include "tool.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/evaluation/trajectory_error.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/files/trajectory_file.h>

using namespace pcl_semantic;

namespace {

const tool::Usage usage{
    "pcl_semantic_trajectory", "compare TRUTH ESTIMATE [options]",
    "Compares two trajectories, KITTI (matched by row) or TUM (matched by time): "
    "errors\n"
    "by KITTI's definition, and distances of the positions.",
    "pcl_semantic_synthesize /tmp/street && \\\n"
    "  pcl_semantic_odometry /tmp/street /tmp/poses.txt && \\\n"
    "  pcl_semantic_trajectory compare /tmp/street/poses.txt /tmp/poses.txt \\\n"
    "    --lengths 10,20"};

struct Options {
  std::string command, truth, estimate, times;
  std::string lengths = "100,200,300,400,500,600,700,800";
  int step = 1;
  double tolerance = 0.01; ///< [s]
};

bool
parseOptions(int argc, char** argv, Options& options)
{
  namespace po = tool::po;
  po::options_description visible("Options");
  visible.add_options()("command", po::value(&options.command), "compare")(
      "truth", po::value(&options.truth), "trajectory that is right")(
      "estimate", po::value(&options.estimate),
      "trajectory to judge")("times", po::value(&options.times),
                             "times.txt of a KITTI trajectory that meets a TUM one");
  tool::addOption(visible, "lengths", options.lengths,
                  "of the pieces that are compared [m]");
  tool::addOption(visible, "step", options.step,
                  "every which pose begins a piece (KITTI's own: 10)");
  tool::addOption(visible, "tolerance", options.tolerance,
                  "how far times that match may differ [s]");
  po::positional_options_description positional;
  positional.add("command", 1).add("truth", 1).add("estimate", 1);
  po::variables_map values;
  if (!tool::parseCommandLine(argc, argv, usage, visible, positional, values))
    return false;
  if (options.command != "compare")
    tool::failUsage(usage, options.command.empty()
                               ? "the command is missing"
                               : "unknown command '" + options.command + "'");
  if (options.truth.empty() || options.estimate.empty())
    tool::failUsage(usage, "compare needs two trajectories");
  if (!(options.tolerance >= 0.0))
    tool::failUsage(usage, "--tolerance is less than 0");
  return true;
}

std::vector<double>
parseLengths(std::string text)
{
  std::vector<double> lengths;
  std::replace(text.begin(), text.end(), ',', ' ');
  try {
    lengths = parseNumbers(text, "--lengths");
  }
  catch (const BadInputException& error) {
    tool::failUsage(usage, error.what());
  }
  for (const double length : lengths)
    if (!(length > 0.0))
      tool::failUsage(usage, "--lengths: a length is not more than 0");
  if (lengths.empty())
    tool::failUsage(usage, "--lengths: there is none");
  return lengths;
}

TimedTrajectory
withTimes(const std::string& path, TrajectoryFormat format, const std::string& times)
{
  if (format == TrajectoryFormat::tum)
    return readTumTrajectory(path);
  const Trajectory poses = readKittiTrajectory(path);
  const std::vector<double> seconds = readTimes(times);
  if (seconds.size() < poses.size())
    PCL_THROW_EXCEPTION(BadInputException, times << ": has " << seconds.size()
                                                 << " times for the " << poses.size()
                                                 << " poses of " << path);
  TimedTrajectory trajectory;
  for (std::size_t i = 0; i < poses.size(); ++i)
    trajectory.push_back({seconds[i], poses[i]});
  return trajectory;
}

MatchedTrajectories
readMatched(const Options& options)
{
  const TrajectoryFormat first = trajectoryFormatOf(options.truth);
  const TrajectoryFormat second = trajectoryFormatOf(options.estimate);
  MatchedTrajectories matched;
  if (first == TrajectoryFormat::kitti && second == TrajectoryFormat::kitti) {
    matched = {readKittiTrajectory(options.truth),
               readKittiTrajectory(options.estimate)};
    const std::size_t common = std::min(matched.first.size(), matched.second.size());
    if (matched.first.size() != matched.second.size())
      tool::warn(tool::shown(matched.first.size()) + " and " +
                 tool::shown(matched.second.size()) + " poses: the first " +
                 tool::shown(common) + " are compared, row by row");
    matched.first.resize(common);
    matched.second.resize(common);
    return matched;
  }
  if (first != second && options.times.empty())
    tool::failUsage(usage, "a KITTI trajectory meets a TUM one: --times is missing");
  const TimedTrajectory truth = withTimes(options.truth, first, options.times);
  const TimedTrajectory estimate = withTimes(options.estimate, second, options.times);
  matched = matchByTime(truth, estimate, options.tolerance);
  if (matched.first.empty())
    PCL_THROW_EXCEPTION(BadInputException, options.estimate
                                               << ": has no pose at the times of "
                                               << options.truth);
  const std::size_t common = matched.first.size();
  if (common < truth.size() || common < estimate.size())
    tool::warn(tool::shown(truth.size()) + " and " + tool::shown(estimate.size()) +
               " poses: the " + tool::shown(common) +
               " of the same times are compared");
  return matched;
}

int
compare(const Options& options)
{
  const std::vector<double> lengths = parseLengths(options.lengths);
  const MatchedTrajectories matched = readMatched(options);
  const TrajectoryErrors errors{
      matched.first.size(), lengthOf(matched.first),
      kittiErrors(matched.first, matched.second, lengths, options.step),
      errorsFromStart(matched.first, matched.second),
      errorsAligned(matched.first, matched.second)};
  tool::printFigures(trajectoryTable(errors), trajectoryJson(errors));
  return tool::exit_done;
}

} // namespace

int
main(int argc, char** argv)
{
  return tool::run(usage.name, [&] {
    Options options;
    return parseOptions(argc, argv, options) ? compare(options) : int(tool::exit_done);
  });
}
