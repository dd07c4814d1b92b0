/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/files/trajectory_file.h>

#include <Eigen/SVD>

#include <locale>
#include <sstream>

namespace pcl_semantic {

namespace {

using RowMajor34 = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;

Eigen::Isometry3d
parsePose(const TextLine& line, const std::string& path)
{
  const std::string where = placeOf(path, line.number);
  const std::vector<double> numbers = parseNumbers(line.text, where);
  if (numbers.size() != 12)
    PCL_THROW_EXCEPTION(BadInputException,
                        where << ": has " << numbers.size()
                              << " numbers, expected 12 (a 3 x 4 pose)");
  const Eigen::Map<const RowMajor34> rows(numbers.data());
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = rows.col(3);
  pose.linear() = rows.leftCols<3>();

  constexpr double rounding = 1e-6;
  constexpr double tolerance = 1e-2;
  const double deviation =
      (pose.linear() * pose.linear().transpose() - Eigen::Matrix3d::Identity()).norm();
  if (!(deviation <= tolerance) || pose.linear().determinant() < 0.0)
    PCL_THROW_EXCEPTION(BadInputException,
                        where << ": the left 3 x 3 block is no rotation");
  if (deviation > rounding) {
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(pose.linear(), Eigen::ComputeFullU |
                                                                   Eigen::ComputeFullV);
    pose.linear() = svd.matrixU() * svd.matrixV().transpose();
  }
  return pose;
}

} // namespace

Trajectory
readKittiTrajectory(const std::string& path)
{
  std::vector<TextLine> lines = readLines(path);
  while (!lines.empty() && lines.back().text.empty())
    lines.pop_back(); // an empty line between poses would shift the frames' numbers
  Trajectory trajectory;
  for (const TextLine& line : lines)
    trajectory.push_back(parsePose(line, path));
  if (trajectory.empty())
    PCL_THROW_EXCEPTION(BadInputException, path << ": holds no pose");
  return trajectory;
}

void
writeKittiTrajectory(const std::string& path, const Trajectory& trajectory)
{
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text.precision(17);
  for (const Eigen::Isometry3d& pose : trajectory) {
    const RowMajor34 rows = pose.matrix().topRows<3>();
    for (int i = 0; i < 12; ++i)
      text << (i ? " " : "") << rows.data()[i];
    text << "\n";
  }
  writeTextFile(path, text.str());
}

} // namespace pcl_semantic
