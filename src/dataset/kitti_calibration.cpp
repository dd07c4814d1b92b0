// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/dataset/kitti_calibration.h>
#include <pcl_semantic/files/input_file.h>

#include <map>

namespace pcl_semantic {

namespace {

using Matrix34 = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;

struct Row {
  Matrix34 matrix;
  std::string where; ///< "FILE line N: P2"
};

bool
isKnown(const std::string& name)
{
  return name == "P0" || name == "P1" || name == "P2" || name == "P3" || name == "Tr";
}

std::map<std::string, Row>
readRows(const std::string& path)
{
  std::map<std::string, Row> rows;
  for (const TextLine& line : readLines(path)) {
    const std::size_t colon = line.text.find(':');
    const std::string name = line.text.substr(0, colon);
    if (line.text.empty() || !isKnown(name))
      continue;
    const std::string where = atLine(path, line.number) + ": " + name;
    if (colon == std::string::npos)
      PCL_THROW_EXCEPTION(BadInputException, where << ": expected a colon");
    const std::vector<double> numbers =
        parseNumbers(line.text.substr(colon + 1), where);
    if (numbers.size() != 12)
      PCL_THROW_EXCEPTION(BadInputException,
                          where << ": has " << numbers.size()
                                << " numbers, expected 12 (a 3 x 4 matrix)");
    const Row row{Eigen::Map<const Matrix34>(numbers.data()), where};
    if (!rows.emplace(name, row).second)
      PCL_THROW_EXCEPTION(BadInputException, where << ": is there twice");
  }
  return rows;
}

const Row&
findRow(const std::map<std::string, Row>& rows, const char* name,
        const std::string& path)
{
  const auto row = rows.find(name);
  if (row == rows.end())
    PCL_THROW_EXCEPTION(BadInputException, path << ": has no row '" << name << ":'");
  return row->second;
}

/** \brief Checks that a row is K [I | t] of a pinhole camera. \return t [m] */
Eigen::Vector3d
translationOf(const Row& row)
{
  Eigen::Matrix3d intrinsics = row.matrix.leftCols<3>();
  const double fx = intrinsics(0, 0), fy = intrinsics(1, 1);
  if (fx <= 0.0 || fy <= 0.0)
    PCL_THROW_EXCEPTION(BadInputException, row.where << ": focal lengths are " << fx
                                                     << " and " << fy
                                                     << " px, expected more than 0");
  Eigen::Matrix3d pinhole = Eigen::Matrix3d::Identity();
  pinhole.diagonal() << fx, fy, 1.0;
  pinhole.topRightCorner<2, 1>() = intrinsics.topRightCorner<2, 1>();
  if (!intrinsics.isApprox(pinhole, 1e-9))
    PCL_THROW_EXCEPTION(BadInputException,
                        row.where
                            << ": the left 3 x 3 block is no camera matrix, expected "
                               "fx 0 cx, 0 fy cy, 0 0 1");
  return pinhole.inverse() * row.matrix.col(3);
}

Eigen::Isometry3d
rigidTransformation(const Row& row)
{
  const Eigen::Matrix3d block = row.matrix.leftCols<3>();
  const double deviation =
      (block * block.transpose() - Eigen::Matrix3d::Identity()).norm();
  if (!(deviation <= 1e-2) || block.determinant() < 0.0)
    PCL_THROW_EXCEPTION(BadInputException,
                        row.where << ": the left 3 x 3 block is no rotation");
  Eigen::Isometry3d transformation = Eigen::Isometry3d::Identity();
  transformation.linear() = Eigen::Quaterniond(block).normalized().matrix();
  transformation.translation() = row.matrix.col(3);
  return transformation;
}

} // namespace

KittiCalibration
readKittiCalibration(const std::string& path, KittiCameras cameras)
{
  const bool grey = cameras == KittiCameras::grey;
  const std::map<std::string, Row> rows = readRows(path);
  const Row& left = findRow(rows, grey ? "P0" : "P2", path);
  const Row& right = findRow(rows, grey ? "P1" : "P3", path);

  const Eigen::Vector3d t_left = translationOf(left);
  const Eigen::Vector3d t_right = translationOf(right);
  if (!left.matrix.leftCols<3>().isApprox(right.matrix.leftCols<3>(), 1e-6))
    PCL_THROW_EXCEPTION(BadInputException,
                        right.where << ": the camera matrix differs from the left "
                                       "camera's, expected a rectified pair");

  KittiCalibration calibration;
  StereoCamera& camera = calibration.camera;
  camera.fx = left.matrix(0, 0);
  camera.fy = left.matrix(1, 1);
  camera.cx = left.matrix(0, 2);
  camera.cy = left.matrix(1, 2);
  camera.baseline = t_left.x() - t_right.x();
  if (camera.baseline > 10.0)
    PCL_THROW_EXCEPTION(BadInputException, right.where
                                               << ": baseline is " << camera.baseline
                                               << " m, expected at most 10 m; is it in "
                                                  "millimetres?");
  if (camera.baseline <= 0.0)
    PCL_THROW_EXCEPTION(BadInputException,
                        right.where << ": baseline is " << camera.baseline
                                    << " m, expected more than 0 (left and right "
                                       "swapped?)");
  calibration.T_camera0_camera.translation() = -t_left;
  const auto velodyne = rows.find("Tr");
  if (velodyne != rows.end())
    calibration.T_camera0_velodyne = rigidTransformation(velodyne->second);
  return calibration;
}

} // namespace pcl_semantic
