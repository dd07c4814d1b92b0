// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/dataset/kitti_calibration.h>

#include "camera_file.h"
#include "core/fail.h"

#include <pcl_semantic/files/input_file.h>

#include <map>

namespace pcl_semantic {

namespace {

using Matrix34 = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;

struct Row {
  std::vector<double> numbers;
  std::string where; ///< "FILE line N: P2"

  Matrix34
  matrix() const
  {
    return Matrix34(numbers.data());
  }
};

// Amount of numbers in a row, by the row's name in the odometry benchmark. The raw data
// calls P2 `P_rect_02` and has its image size in `S_rect_02`. The object and tracking
// benchmarks split Tr into two parts, R0 before V.
std::size_t
countOf(const std::string& name)
{
  static const std::map<std::string, std::size_t> counts{
      {"P0", 12}, {"P1", 12}, {"P2", 12}, {"P3", 12}, {"Tr", 12}, {"S0", 2},
      {"S1", 2},  {"S2", 2},  {"S3", 2},  {"R0", 9},  {"V", 12}};
  const auto found = counts.find(name);
  return found == counts.end() ? 0 : found->second;
}

std::string
odometryName(const std::string& name)
{
  if (name == "R0_rect" || name == "R_rect")
    return "R0";
  if (name == "Tr_velo_to_cam" || name == "Tr_velo_cam")
    return "V";
  const bool is_raw = name.size() == 9 && name.compare(1, 7, "_rect_0") == 0 &&
                      (name[0] == 'P' || name[0] == 'S');
  return is_raw ? std::string{name[0], name[8]} : name;
}

std::map<std::string, Row>
readRows(const std::string& path)
{
  std::map<std::string, Row> rows;
  for (const TextLine& line : readLines(path)) {
    const std::size_t colon = line.text.find(':');
    const std::string stated = line.text.substr(0, colon), name = odometryName(stated);
    const std::size_t count = countOf(name);
    if (count == 0)
      continue;
    const std::string where = atLine(path, line.number) + ": " + stated;
    if (colon == std::string::npos)
      fail<BadInputException>(where, ": expected a colon");
    const Row row{parseNumbers(line.text.substr(colon + 1), where), where};
    if (row.numbers.size() != count)
      fail<BadInputException>(where, ": has ", row.numbers.size(),
                              " numbers, expected ", count,
                              count == 12 ? " (a 3 x 4 matrix)" : " (a size)");
    if (!rows.emplace(name, row).second)
      fail<BadInputException>(where, ": is there twice");
  }
  return rows;
}

/** \brief Requires K [I | t] of a pinhole camera. \return t [m] */
Eigen::Vector3d
translationOf(const Row& row)
{
  Eigen::Matrix3d intrinsics = row.matrix().leftCols<3>();
  const double fx = intrinsics(0, 0), fy = intrinsics(1, 1);
  if (fx <= 0.0 || fy <= 0.0)
    fail<BadInputException>(row.where, ": focal lengths are ", fx, " and ", fy,
                            " px, expected more than 0");
  Eigen::Matrix3d pinhole = Eigen::Matrix3d::Identity();
  pinhole.diagonal() << fx, fy, 1.0;
  pinhole.topRightCorner<2, 1>() = intrinsics.topRightCorner<2, 1>();
  if (!intrinsics.isApprox(pinhole, 1e-9))
    fail<BadInputException>(
        row.where,
        ": the left 3 x 3 block is no camera matrix, expected fx 0 cx, 0 fy cy, 0 0 1");
  return pinhole.inverse() * row.matrix().col(3);
}

Eigen::Quaterniond
rotationOf(const Eigen::Matrix3d& block, const Row& row)
{
  const double deviation =
      (block * block.transpose() - Eigen::Matrix3d::Identity()).norm();
  if (!(deviation <= 1e-2) || block.determinant() < 0.0)
    fail<BadInputException>(row.where, ": the left 3 x 3 block is no rotation");
  return Eigen::Quaterniond(block).normalized();
}

Eigen::Isometry3d
rigidTransformation(const Row& row)
{
  Eigen::Isometry3d transformation = Eigen::Isometry3d::Identity();
  transformation.linear() = rotationOf(row.matrix().leftCols<3>(), row).matrix();
  transformation.translation() = row.matrix().col(3);
  return transformation;
}

} // namespace

KittiCalibration
readKittiCalibration(const std::string& path, KittiCameras cameras)
{
  const std::map<std::string, Row> rows = readRows(path);
  const bool has_one_pair = rows.count("P0") && !rows.count("P2"); // KITTI-360
  const bool grey = cameras == KittiCameras::grey || has_one_pair;
  const auto find = [&](const char* name) -> const Row& {
    const auto row = rows.find(name);
    if (row == rows.end())
      fail<BadInputException>(path, ": has no row '", name,
                              ":', expected KITTI's calibration (YAML files of ROS, "
                              "Kalibr and OpenCV are read, too; of one camera also a "
                              "line fx fy cx cy)");
    return row->second;
  };
  const Row& left = find(grey ? "P0" : "P2");
  const Row& right = find(grey ? "P1" : "P3");
  const Eigen::Vector3d t_left = translationOf(left);
  const Eigen::Vector3d t_right = translationOf(right);
  if (!left.matrix().leftCols<3>().isApprox(right.matrix().leftCols<3>(), 1e-6))
    fail<BadInputException>(right.where, ": the camera matrix differs from the left "
                                         "camera's, expected a rectified pair");

  KittiCalibration calibration;
  const double baseline = t_left.x() - t_right.x();
  if (baseline <= 0.0 || baseline > 10.0) // StereoCamera refuses NaN
    fail<BadInputException>(right.where, ": baseline is ", baseline, " m, expected ",
                            baseline > 10.0 ? "at most 10 m; is it in millimetres?"
                                            : "more than 0 (left and right swapped?)");
  const Matrix34 P = left.matrix();
  calibration.camera = {P(0, 0), P(1, 1), P(0, 2), P(1, 2), baseline};
  if (const auto size = rows.find(grey ? "S0" : "S2"); size != rows.end()) {
    calibration.camera.width = wholePixels(size->second.numbers[0], size->second.where);
    calibration.camera.height =
        wholePixels(size->second.numbers[1], size->second.where);
  }
  calibration.T_camera0_camera.translation() = -t_left;
  if (const auto velodyne = rows.find("Tr"); velodyne != rows.end())
    calibration.T_camera0_velodyne = rigidTransformation(velodyne->second);
  else if (rows.count("V") && rows.count("R0")) {
    using RowMajor33 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
    const Row& R0 = rows.at("R0");
    calibration.T_camera0_velodyne =
        rotationOf(Eigen::Map<const RowMajor33>(R0.numbers.data()), R0) *
        rigidTransformation(rows.at("V"));
  }
  return calibration;
}

} // namespace pcl_semantic
