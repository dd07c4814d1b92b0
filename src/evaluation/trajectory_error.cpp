// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/evaluation/trajectory_error.h>

#include "core/fail.h"
#include "files/report_text.h"

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include <algorithm>
#include <cmath>

namespace pcl_semantic {

namespace {

void
requirePairs(const Trajectory& truth, const Trajectory& estimate)
{
  if (truth.size() != estimate.size() || truth.empty())
    badParameter("trajectories of ", truth.size(), " and ", estimate.size(),
                 " poses cannot be compared");
}

// Way from the first pose to each.
std::vector<double>
waysAlong(const Trajectory& trajectory)
{
  std::vector<double> ways(trajectory.size(), 0.0);
  for (std::size_t i = 1; i < ways.size(); ++i)
    ways[i] = ways[i - 1] +
              (trajectory[i].translation() - trajectory[i - 1].translation()).norm();
  return ways;
}

SegmentErrors
mean(SegmentErrors sum)
{
  sum.translation /= double(sum.segments); // 0 / 0 is NaN, as promised
  sum.rotation /= double(sum.segments);
  return sum;
}

SegmentErrors
sumOfErrors(const Trajectory& truth, const Trajectory& estimate,
            const std::vector<double>& ways, double length, int step)
{
  SegmentErrors sum;
  sum.length = length;
  std::size_t end = 0;
  for (std::size_t begin = 0; begin < ways.size(); begin += std::size_t(step)) {
    while (end < ways.size() && ways[end] <= ways[begin] + length)
      ++end;
    if (end == ways.size())
      break;
    const Eigen::Isometry3d error =
        (estimate[begin].inverse() * estimate[end]).inverse() *
        (truth[begin].inverse() * truth[end]);
    ++sum.segments;
    sum.translation += error.translation().norm() / length;
    sum.rotation += Eigen::AngleAxisd(error.linear()).angle() / length;
  }
  return sum;
}

AbsoluteErrors
distances(const Trajectory& truth, const Trajectory& estimate,
          const Eigen::Isometry3d& T_truth_estimate)
{
  AbsoluteErrors errors;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const double distance =
        (truth[i].translation() - T_truth_estimate * estimate[i].translation()).norm();
    errors.mean += distance / double(truth.size());
    errors.rms += distance * distance / double(truth.size());
    errors.largest = std::max(errors.largest, distance);
    errors.last = distance;
  }
  errors.rms = std::sqrt(errors.rms);
  return errors;
}

} // namespace

std::vector<SegmentErrors>
kittiErrors(const Trajectory& truth, const Trajectory& estimate,
            const std::vector<double>& lengths, int step)
{
  requirePairs(truth, estimate);
  if (step < 1)
    badParameter("step of KITTI's errors: ", step, ", expected 1 or more");
  const std::vector<double> ways = waysAlong(truth);
  std::vector<SegmentErrors> errors;
  SegmentErrors all;
  for (const double length : lengths) {
    if (!(length > 0.0) || std::isinf(length))
      badParameter("length of a piece: ", length, " m, expected more than 0");
    const SegmentErrors sum = sumOfErrors(truth, estimate, ways, length, step);
    all.segments += sum.segments;
    all.translation += sum.translation;
    all.rotation += sum.rotation;
    errors.push_back(mean(sum));
  }
  errors.push_back(mean(all));
  return errors;
}

AbsoluteErrors
errorsFromStart(const Trajectory& truth, const Trajectory& estimate)
{
  requirePairs(truth, estimate);
  return distances(truth, estimate, truth.front() * estimate.front().inverse());
}

AbsoluteErrors
errorsAligned(const Trajectory& truth, const Trajectory& estimate)
{
  requirePairs(truth, estimate);
  Eigen::Matrix3Xd from(3, Eigen::Index(truth.size())), to(from);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    from.col(Eigen::Index(i)) = estimate[i].translation();
    to.col(Eigen::Index(i)) = truth[i].translation();
  }
  Eigen::Isometry3d T_truth_estimate;
  T_truth_estimate.matrix() = Eigen::umeyama(from, to, false);
  return distances(truth, estimate, T_truth_estimate);
}

double
lengthOf(const Trajectory& trajectory)
{
  return trajectory.empty() ? 0.0 : waysAlong(trajectory).back();
}

MatchedTrajectories
matchByTime(const TimedTrajectory& first, const TimedTrajectory& second,
            double tolerance)
{
  MatchedTrajectories matched;
  for (const TimedPose& timed : first)
    if (const TimedPose* const other = findPose(second, timed.time, tolerance);
        other && findPose(first, other->time, tolerance) == &timed) {
      matched.first.push_back(timed.pose);
      matched.second.push_back(other->pose);
    }
  return matched;
}

namespace {

using Json = nlohmann::ordered_json;

double
percent(const SegmentErrors& each)
{
  return 100.0 * each.translation;
}

double
degrees(const SegmentErrors& each)
{
  return each.rotation * 180.0 / M_PI;
}

std::string
lineOf(const char* name, const AbsoluteErrors& errors)
{
  return cv::format("%-16s mean %.4f m, rms %.4f m, largest %.4f m, last %.4f m\n",
                    name, errors.mean, errors.rms, errors.largest, errors.last);
}

Json
jsonOf(const AbsoluteErrors& errors)
{
  return {{"mean", errors.mean},
          {"rms", errors.rms},
          {"largest", errors.largest},
          {"last", errors.last}};
}

} // namespace

std::string
trajectoryTable(const TrajectoryErrors& errors)
{
  std::string text =
      cv::format("%zu poses, %.1f m\n\n%8s %9s %14s %16s\n", errors.poses,
                 errors.length, "length", "pieces", "translation %", "rotation deg/m");
  for (const SegmentErrors& each : errors.pieces) {
    const std::string name =
        each.length > 0.0 ? cv::format("%g m", each.length) : std::string("all");
    if (each.segments > 0)
      text += cv::format("%8s %9zu %14.4f %16.5f\n", name.c_str(), each.segments,
                         percent(each), degrees(each));
    else
      text += cv::format("%8s %9zu %14s %16s\n", name.c_str(), each.segments, "-", "-");
  }
  return text + "\n" + lineOf("from the start:", errors.from_start) +
         lineOf("aligned:", errors.aligned);
}

std::string
trajectoryJson(const TrajectoryErrors& errors)
{
  Json json = {{"poses", errors.poses}, {"length", errors.length}};
  json["pieces"] = Json::array();
  for (const SegmentErrors& each : errors.pieces) {
    Json piece = {{"length", each.length > 0.0 ? Json(each.length) : Json("all")},
                  {"pieces", each.segments}};
    piece["translation_percent"] = percent(each); // NaN becomes null
    piece["rotation_degrees_per_metre"] = degrees(each);
    json["pieces"].push_back(piece);
  }
  json["from_start"] = jsonOf(errors.from_start);
  json["aligned"] = jsonOf(errors.aligned);
  return jsonText(json);
}

} // namespace pcl_semantic
