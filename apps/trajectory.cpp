// SPDX-License-Identifier: BSD-3-Clause
#include "messages.h"
#include "tool.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/evaluation/trajectory_error.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/files/trajectory_file.h>

using namespace pcl_semantic;
using namespace pcl_semantic::tool;

namespace {

const Usage usage{
    "pcl_semantic_trajectory", "compare TRUTH ESTIMATE [options]",
    R"(Compares two trajectories, KITTI (matched by row) or TUM (matched by time): errors
by KITTI's definition, and distances of the positions.)",
    R"(pcl_semantic_synthesize /tmp/street && \
  pcl_semantic_odometry /tmp/street /tmp/poses.txt && \
  pcl_semantic_trajectory compare /tmp/street/poses.txt /tmp/poses.txt \
    --lengths 10,20)"};

struct Options {
  std::string command, truth, estimate, times;
  std::string lengths = "100,200,300,400,500,600,700,800";
  int step = 1;
  double tolerance = 0.01; ///< [s]
};

Options
parse(int argc, char** argv)
{
  Options options;
  parseCommandLine(
      argc, argv, usage,
      {{"command", options.command, "compare"},
       {"truth", options.truth, "trajectory that is right"},
       {"estimate", options.estimate, "trajectory to judge"},
       {"times", options.times, "times.txt of a KITTI trajectory that meets a TUM one"},
       {"lengths", withDefault(options.lengths), "of the pieces that are compared [m]"},
       {"step", withDefault(options.step),
        "every which pose begins a piece (KITTI's own: 10)"},
       {"tolerance", withDefault(options.tolerance),
        "how far times that match may differ [s]"}},
      {"command", "truth", "estimate"});
  refuseIf(options.command != "compare",
           options.command.empty() ? "the command is missing"
                                   : "unknown command '" + options.command + "'");
  refuseIf(options.truth.empty() || options.estimate.empty(),
           "compare needs two trajectories");
  refuseIf(!(options.tolerance >= 0.0), "--tolerance is less than 0");
  return options;
}

std::vector<double>
parseLengths(const std::string& text)
{
  const std::vector<double> lengths = parseNumbersOf("--lengths", text);
  for (const double length : lengths)
    refuseIf(!(length > 0.0), "--lengths: a length is not more than 0");
  refuseIf(lengths.empty(), "--lengths: there is none");
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
    fail<BadInputException>(times, ": has ", seconds.size(), " times for the ",
                            poses.size(), " poses of ", path);
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
      warn(shown(matched.first.size()) + " and " + shown(matched.second.size()) +
           " poses: the first " + shown(common) + " are compared, row by row");
    matched.first.resize(common);
    matched.second.resize(common);
    return matched;
  }
  refuseIf(first != second && options.times.empty(),
           "a KITTI trajectory meets a TUM one: --times is missing");
  const TimedTrajectory truth = withTimes(options.truth, first, options.times);
  const TimedTrajectory estimate = withTimes(options.estimate, second, options.times);
  matched = matchByTime(truth, estimate, options.tolerance);
  if (matched.first.empty())
    fail<BadInputException>(options.estimate, ": has no pose at the times of ",
                            options.truth);
  const std::size_t common = matched.first.size();
  if (common < truth.size() || common < estimate.size())
    warn(shown(truth.size()) + " and " + shown(estimate.size()) + " poses: the " +
         shown(common) + " of the same times are compared");
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
  printFigures(trajectoryTable(errors), trajectoryJson(errors));
  return exit_done;
}

} // namespace

int
main(int argc, char** argv)
{
  return run(usage.name, [&] { return compare(parse(argc, argv)); });
}
