// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/files/trajectory_file.h>

#include "core/fail.h"
#include "core/split.h"

#include <pcl_semantic/core/sensor_pose.h>
#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/files/input_file.h>

#include <Eigen/SVD>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace pcl_semantic {

namespace {

using RowMajor34 = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;

constexpr double kRounding = 1e-6;     // of double precision
constexpr double kTextRounding = 1e-4; // of numbers with few digits
constexpr double kTolerance = 1e-2;
constexpr double kNanoseconds = 1e17; // as seconds, 3 billion years

// Corrections while reading a file, reported in one warning.
struct Repairs {
  std::size_t count = 0;
  std::string first;

  void
  add(const std::string& where)
  {
    if (count++ == 0)
      first = where;
  }

  void
  addTo(std::vector<std::string>* doubts, const std::string& path,
        std::size_t poses) const
  {
    if (count > 0 && doubts)
      doubts->push_back(
          path + ": " + std::to_string(count) + " of " + std::to_string(poses) +
          " poses were not exactly rigid and were corrected, the first in " + first);
  }
};

bool
isComment(const std::string& text)
{
  const std::size_t first = text.find_first_not_of(" \t");
  return first != std::string::npos && text[first] == '#';
}

// Without comments before the first row and empty lines after the last; elsewhere they
// would shift the frame numbers.
std::vector<TextLine>
rowsOf(const std::string& path)
{
  std::vector<TextLine> lines = readLines(path);
  while (!lines.empty() && lines.back().text.empty())
    lines.pop_back();
  lines.erase(lines.begin(),
              std::find_if_not(lines.begin(), lines.end(), [](const TextLine& line) {
                return isComment(line.text);
              }));
  return lines;
}

double
inSeconds(double time)
{
  return std::abs(time) >= kNanoseconds ? 1e-9 * time : time;
}

std::string
lineText(int number)
{
  return "line " + std::to_string(number);
}

// \param[in] rows the upper 3 x 4 of a pose
// \param[in] where for the message, and in \a repairs as \a place
Eigen::Isometry3d
poseOf(const RowMajor34& rows, const std::string& where, const std::string& place,
       Repairs& repairs)
{
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = rows.col(3);
  pose.linear() = rows.leftCols<3>();
  const double deviation =
      (pose.linear() * pose.linear().transpose() - Eigen::Matrix3d::Identity()).norm();
  if (!(deviation <= kTolerance) || pose.linear().determinant() < 0.0)
    badInput(where, ": the left 3 x 3 block is no rotation");
  if (deviation > kTextRounding)
    repairs.add(place);
  if (deviation > kRounding) {
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(pose.linear(), Eigen::ComputeFullU |
                                                                   Eigen::ComputeFullV);
    pose.linear() = svd.matrixU() * svd.matrixV().transpose();
  }
  return pose;
}

Eigen::Isometry3d
parsePose(const TextLine& line, const std::string& path, Repairs& repairs)
{
  const std::string where = atLine(path, line.number);
  if (line.text.empty() || isComment(line.text))
    badInput(where,
             ": is empty, but a later line has a pose; expected one row per frame");
  const std::vector<double> numbers = parseNumbers(line.text, where);
  if (numbers.size() != 12)
    badInput(where, ": has ", numbers.size(), " numbers, expected 12 (a 3 x 4 pose)");
  return poseOf(RowMajor34(numbers.data()), where, lineText(line.number), repairs);
}

TimedPose
parseTimedPose(const TextLine& line, const std::string& path, Repairs& repairs)
{
  const std::string where = atLine(path, line.number);
  const std::vector<double> numbers = parseNumbers(line.text, where);
  if (numbers.size() != 8)
    badInput(where, ": has ", numbers.size(),
             " numbers, expected 8 (time, translation, quaternion)");
  TimedPose timed;
  timed.time = inSeconds(numbers[0]);
  const Eigen::Quaterniond rotation(numbers[7], numbers[4], numbers[5], numbers[6]);
  const double deviation = std::abs(rotation.norm() - 1.0);
  if (!(deviation <= kTolerance))
    badInput(where, ": the quaternion has length ", rotation.norm(), ", expected 1");
  if (deviation > kTextRounding)
    repairs.add(lineText(line.number));
  timed.pose.linear() = rotation.normalized().toRotationMatrix();
  timed.pose.translation() << numbers[1], numbers[2], numbers[3];
  return timed;
}

constexpr const char* expected_numbers =
    "expected lines of 12 numbers (KITTI) or 8 (TUM: time x y z qx qy qz qw)";

void
refuseOtherTrajectories(const std::string& text, const std::string& path, int number)
{
  if (text.find(',') != std::string::npos)
    badInput(atLine(path, number), ": has commas, ", expected_numbers,
             "; convert EuRoC files: evo_traj euroc ", path, " --save_as_tum");
  const std::size_t first = text.find_first_not_of(" \t");
  if (text.find_first_of("0123456789+-.") != first)
    badInput(atLine(path, number), ": begins with ", inQuotes(text.substr(first, 20)),
             ", ", expected_numbers);
}

} // namespace

TrajectoryFormat
trajectoryFormatOf(const std::string& path)
{
  for (const TextLine& line : readLines(path)) {
    if (line.text.empty() || isComment(line.text))
      continue;
    refuseOtherTrajectories(line.text, path, line.number);
    const std::size_t count = parseNumbers(line.text, atLine(path, line.number)).size();
    if (count == 8)
      return TrajectoryFormat::tum;
    if (count >= 11 && count <= 13) // near 12: the reader reports the error
      return TrajectoryFormat::kitti;
    badInput(atLine(path, line.number), ": has ", count,
             " numbers, expected 12 (a KITTI trajectory) or 8 (TUM)");
  }
  badInput(path, ": holds no pose");
}

Trajectory
readKittiTrajectory(const std::string& path, std::vector<std::string>* doubts)
{
  Repairs repairs;
  Trajectory trajectory;
  for (const TextLine& line : rowsOf(path))
    trajectory.push_back(parsePose(line, path, repairs));
  if (trajectory.empty())
    badInput(path, ": holds no pose");
  repairs.addTo(doubts, path, trajectory.size());
  return trajectory;
}

// Old programs for Windows wrote NaN as "-1.#IND".
Eigen::Isometry3d
readPoseFile(const std::string& path, std::vector<std::string>* doubts)
{
  std::vector<double> numbers;
  for (const TextLine& line : readLines(path))
    for (const std::string_view word : wordsOf(line.text))
      numbers.push_back(
          word.find(".#") != std::string_view::npos
              ? std::numeric_limits<double>::quiet_NaN()
              : parseNumber(std::string(word), atLine(path, line.number)));
  if (numbers.size() != 16)
    badInput(path, ": has ", numbers.size(), " numbers, expected 16 (a 4 x 4 pose)");
  Eigen::Isometry3d lost;
  lost.matrix().setConstant(std::numeric_limits<double>::quiet_NaN());
  if (!std::all_of(numbers.begin(), numbers.end(),
                   [](double number) { return std::isfinite(number); }))
    return lost;
  if (!std::equal(numbers.begin() + 12, numbers.end(),
                  std::array{0., 0., 0., 1.}.begin()))
    badInput(path, ": the last row of its matrix is not 0 0 0 1");
  Repairs repairs;
  const Eigen::Isometry3d pose =
      poseOf(RowMajor34(numbers.data()), path, "its matrix", repairs);
  repairs.addTo(doubts, path, 1);
  return pose;
}

void
writeKittiTrajectory(const std::string& path, const Trajectory& trajectory)
{
  TextStream text;
  text.precision(17);
  for (const Eigen::Isometry3d& pose : trajectory) {
    requireRigid(pose, path + ": a pose");
    const RowMajor34 rows = pose.matrix().topRows<3>();
    for (int i = 0; i < 12; ++i)
      text << (i ? " " : "") << rows.data()[i];
    text << "\n";
  }
  writeTextFile(path, text.str());
}

TimedTrajectory
readTumTrajectory(const std::string& path, std::vector<std::string>* doubts)
{
  Repairs repairs;
  TimedTrajectory trajectory;
  for (const TextLine& line : readLines(path)) {
    if (line.text.empty() || isComment(line.text))
      continue;
    trajectory.push_back(parseTimedPose(line, path, repairs));
    if (trajectory.size() > 1 &&
        !(trajectory.back().time > trajectory[trajectory.size() - 2].time))
      badInput(atLine(path, line.number),
               ": time is not later than that of the previous pose");
  }
  if (trajectory.empty())
    badInput(path, ": holds no pose");
  repairs.addTo(doubts, path, trajectory.size());
  return trajectory;
}

void
writeTumTrajectory(const std::string& path, const TimedTrajectory& trajectory)
{
  TextStream text;
  text << "# time [s] tx ty tz [m] qx qy qz qw\n";
  for (const TimedPose& timed : trajectory) {
    requireRigid(timed.pose, path + ": a pose");
    const Eigen::Quaterniond rotation(timed.pose.linear());
    text.setf(std::ios::fixed);
    text.precision(9);
    text << timed.time;
    text.unsetf(std::ios::floatfield);
    text.precision(17);
    const Eigen::Vector3d position = timed.pose.translation();
    for (const double number : {position.x(), position.y(), position.z(), rotation.x(),
                                rotation.y(), rotation.z(), rotation.w()})
      text << " " << number;
    text << "\n";
  }
  writeTextFile(path, text.str());
}

const TimedPose*
findPose(const TimedTrajectory& trajectory, double time, double tolerance)
{
  const auto after = std::lower_bound(
      trajectory.begin(), trajectory.end(), time,
      [](const TimedPose& timed, double value) { return timed.time < value; });
  const TimedPose* nearest = after == trajectory.end() ? nullptr : &*after;
  if (after != trajectory.begin() &&
      (!nearest || time - (after - 1)->time < nearest->time - time))
    nearest = &*(after - 1);
  return nearest && std::abs(nearest->time - time) <= tolerance ? nearest : nullptr;
}

std::vector<double>
readTimes(const std::string& path)
{
  std::vector<double> times;
  for (const TextLine& line : rowsOf(path)) {
    const std::string where = atLine(path, line.number);
    const std::vector<double> numbers = parseNumbers(line.text, where);
    if (numbers.size() != 1)
      badInput(where, ": has ", numbers.size(), " numbers, expected one time [s]");
    const double time = inSeconds(numbers[0]);
    if (!times.empty() && time <= times.back())
      badInput(where, ": is not later than the previous time");
    times.push_back(time);
  }
  return times;
}

} // namespace pcl_semantic
