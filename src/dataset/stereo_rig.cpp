// SPDX-License-Identifier: BSD-3-Clause
#include "files/yaml_config.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/dataset/stereo_rig.h>
#include <pcl_semantic/files/input_file.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <pcl/console/print.h>

#include <algorithm>
#include <cmath>

namespace pcl_semantic {

namespace {

constexpr double kFarthest = 10.0; // [m]; more are millimetres

void
validateCamera(const Eigen::Matrix3d& K, const StereoRig& rig, const char* name)
{
  if (!K.allFinite())
    PCL_THROW_EXCEPTION(InvalidParameterException, name << ": is not finite");
  const double fx = K(0, 0), fy = K(1, 1), cx = K(0, 2), cy = K(1, 2);
  if (!(fx > 0.0 && fy > 0.0))
    PCL_THROW_EXCEPTION(InvalidParameterException, name << ": focal lengths are " << fx
                                                        << " and " << fy
                                                        << " px, expected more than 0");
  if (K(0, 1) != 0.0 || K(1, 0) != 0.0 ||
      !K.row(2).isApprox(Eigen::RowVector3d(0, 0, 1)))
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        name << ": is no camera matrix, expected fx 0 cx, 0 fy cy, "
                                "0 0 1");
  if (rig.width > 0 && !(cx > 0.0 && cx < rig.width && cy > 0.0 && cy < rig.height))
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        name << ": the principal point (" << cx << ", " << cy
                             << ") is outside the images of " << rig.width << " x "
                             << rig.height << " pixels");
}

void
validateDistortion(const std::vector<double>& D, const char* name)
{
  const std::size_t n = D.size();
  if (n != 4 && n != 5 && n != 8 && n != 12 && n != 14)
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        name << ": has " << n
                             << " numbers, expected 4, 5, 8, 12 or 14");
  if (!std::all_of(D.begin(), D.end(), [](double d) { return std::isfinite(d); }))
    PCL_THROW_EXCEPTION(InvalidParameterException, name << ": is not finite");
}

void
validateRotation(const Eigen::Matrix3d& R)
{
  const double deviation = (R * R.transpose() - Eigen::Matrix3d::Identity()).norm();
  if (!(deviation <= 1e-6) || R.determinant() < 0.0)
    PCL_THROW_EXCEPTION(InvalidParameterException, "R: is no rotation (determinant "
                                                       << R.determinant()
                                                       << ", R R^T is off by "
                                                       << deviation << ")");
}

void
validateTranslation(const Eigen::Vector3d& T)
{
  const auto fail = [&T](const char* message) {
    PCL_THROW_EXCEPTION(InvalidParameterException, "T: is (" << T.x() << ", " << T.y()
                                                             << ", " << T.z()
                                                             << "): " << message);
  };
  if (!T.allFinite())
    fail("not finite");
  if (T.isZero(0.0))
    fail("the baseline is 0 m, expected more");
  if (T.norm() > kFarthest)
    fail("the baseline is more than 10 m; if these are millimetres, expected metres");
  if (std::abs(T.y()) >= std::abs(T.x()))
    fail("one camera is above the other, expected them side by side");
  if (std::abs(T.z()) >= std::abs(T.x()))
    fail("one camera is ahead of the other, expected them side by side");
  if (T.x() > 0.0)
    fail("the right camera is on the left, expected T.x < 0 (x_right = R x_left + T); "
         "are left and right swapped?");
}

} // namespace

void
StereoRig::validate() const
{
  if (width < 0 || height < 0 || (width == 0) != (height == 0))
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "image size: is " << width << " x " << height << " pixels");
  validateCamera(K1, *this, "K1");
  validateCamera(K2, *this, "K2");
  validateDistortion(D1, "D1");
  validateDistortion(D2, "D2");
  validateRotation(R);
  validateTranslation(T);
}

namespace {

using RowMajor33 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
using Keys = std::vector<std::string>;

// A calibration file and its name.
struct Source {
  std::string path;
  YamlMap map;
};

Source
load(const std::string& path)
{
  for (const TextLine& line : readLines(path)) {
    if (line.text.empty())
      continue;
    if (line.text[0] == '<')
      PCL_THROW_EXCEPTION(BadInputException,
                          path
                              << ": is XML, expected YAML as cv::FileStorage writes it "
                                 "to a file named .yaml");
    break;
  }
  return {path, YamlMap::load(path)};
}

// The one of the keys that is there; empty if none is.
std::string
findKey(const Source& source, const Keys& keys)
{
  std::string found;
  for (const std::string& key : keys) {
    if (!source.map.has(key))
      continue;
    if (!found.empty())
      PCL_THROW_EXCEPTION(BadInputException,
                          source.map.where(key) << ": '" << key << "' is '" << found
                                                << "' once more, expected one of them");
    found = key;
  }
  return found;
}

std::vector<double>
numbersOf(const std::vector<std::string>& words, const std::string& where)
{
  std::vector<double> numbers;
  for (const std::string& word : words) {
    numbers.push_back(parseNumber(word, where));
    if (!std::isfinite(numbers.back()))
      PCL_THROW_EXCEPTION(BadInputException,
                          where << ": '" << word << "' is not a finite number");
  }
  return numbers;
}

// The numbers of a matrix, row after row.
std::vector<double>
readMatrix(const Source& source, const Keys& keys)
{
  const std::string key = findKey(source, keys);
  if (key.empty()) {
    std::string names;
    for (const std::string& name : keys)
      names += (names.empty() ? "'" : " or '") + name + "'";
    PCL_THROW_EXCEPTION(BadInputException,
                        source.path << ": key " << names << " is missing");
  }
  const std::string where = source.map.where(key) + ": " + key;
  if (!source.map.isMap(key))
    return numbersOf(source.map.require<std::vector<std::string>>(key), where);
  const YamlMap matrix = source.map.requireMap(key);
  const std::vector<double> data =
      numbersOf(matrix.require<std::vector<std::string>>("data"), where);
  const int rows = matrix.require<int>("rows"), columns = matrix.require<int>("cols");
  if (rows < 1 || columns < 1 || double(rows) * columns != double(data.size()))
    PCL_THROW_EXCEPTION(BadInputException, where << ": has " << data.size()
                                                 << " numbers, expected " << rows
                                                 << " x " << columns);
  return data;
}

std::vector<double>
readMatrix(const Source& source, const Keys& keys, std::size_t count)
{
  std::vector<double> data = readMatrix(source, keys);
  const std::string key = findKey(source, keys);
  if (data.size() != count)
    PCL_THROW_EXCEPTION(BadInputException, source.map.where(key)
                                               << ": " << key << ": has " << data.size()
                                               << " numbers, expected " << count);
  return data;
}

Eigen::Matrix3d
readSquare(const Source& source, const Keys& keys)
{
  return Eigen::Map<const RowMajor33>(readMatrix(source, keys, 9).data());
}

// Fewer digits than those of a double leave no exact rotation.
Eigen::Matrix3d
nearestRotation(const Eigen::Matrix3d& R, const std::string& where)
{
  const double deviation = (R * R.transpose() - Eigen::Matrix3d::Identity()).norm();
  if (!(deviation <= 1e-2) || R.determinant() < 0.0)
    PCL_THROW_EXCEPTION(BadInputException,
                        where << ": is no rotation (determinant " << R.determinant()
                              << ", R R^T is off by " << deviation << ")");
  if (deviation > 1e-4)
    PCL_WARN("%s: was not quite a rotation and made one\n", where.c_str());
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(R, Eigen::ComputeFullU |
                                                     Eigen::ComputeFullV);
  return svd.matrixU() * svd.matrixV().transpose();
}

void
readSize(const Source& source, StereoRig& rig)
{
  const bool has_width = source.map.get("image_width", rig.width);
  const bool has_height = source.map.get("image_height", rig.height);
  if (has_width != has_height)
    PCL_THROW_EXCEPTION(BadInputException,
                        source.path
                            << ": expected both 'image_width' and 'image_height'");
  const std::string key = findKey(source, {"image_size", "imageSize"});
  if (!has_width && !key.empty()) {
    const auto size = source.map.require<std::vector<int>>(key);
    if (size.size() != 2)
      PCL_THROW_EXCEPTION(BadInputException, source.map.where(key)
                                                 << ": " << key << ": has "
                                                 << size.size()
                                                 << " numbers, expected width, height");
    rig.width = size[0];
    rig.height = size[1];
  }
  if ((has_width || !key.empty()) && (rig.width < 2 || rig.height < 2))
    PCL_THROW_EXCEPTION(BadInputException, source.path << ": the image size is "
                                                       << rig.width << " x "
                                                       << rig.height << " pixels");
}

StereoRig
readOpenCvRig(const Source& source, const Source& extrinsics)
{
  StereoRig rig;
  readSize(source, rig);
  rig.K1 = readSquare(source, {"K1", "M1", "cameraMatrix1", "camera_matrix_1"});
  rig.D1 = readMatrix(source, {"D1", "distCoeffs1", "dist_coeffs_1"});
  rig.K2 = readSquare(source, {"K2", "M2", "cameraMatrix2", "camera_matrix_2"});
  rig.D2 = readMatrix(source, {"D2", "distCoeffs2", "dist_coeffs_2"});
  rig.R =
      nearestRotation(readSquare(extrinsics, {"R"}), extrinsics.map.where("R") + ": R");
  rig.T = Eigen::Map<const Eigen::Vector3d>(readMatrix(extrinsics, {"T"}, 3).data());
  return rig;
}

void
requireModel(const YamlMap& camera, const std::string& key, const Keys& known)
{
  std::string model;
  if (!camera.get(key, model) || std::count(known.begin(), known.end(), model))
    return;
  PCL_THROW_EXCEPTION(BadInputException, camera.where(key)
                                             << ": " << key << " is " << inQuotes(model)
                                             << ", expected " << inQuotes(known[0])
                                             << " (no fisheyes)");
}

// A camera of Kalibr's camchain.
void
readKalibrCamera(const Source& camera, Eigen::Matrix3d& K, std::vector<double>& D)
{
  requireModel(camera.map, "camera_model", {"pinhole"});
  requireModel(camera.map, "distortion_model", {"radtan", "none"});
  const std::vector<double> values = readMatrix(camera, {"intrinsics"}, 4);
  K << values[0], 0, values[2], 0, values[1], values[3], 0, 0, 1;
  D = camera.map.has("distortion_coeffs") ? readMatrix(camera, {"distortion_coeffs"})
                                          : std::vector<double>();
  if (D.empty())
    D.assign(4, 0.0);
}

StereoRig
readKalibrRig(const Source& source)
{
  if (!source.map.isMap("cam1"))
    PCL_THROW_EXCEPTION(BadInputException,
                        source.path << ": has one camera, expected cam0 and cam1");
  const Source left{source.path, source.map.requireMap("cam0")};
  const Source right{source.path, source.map.requireMap("cam1")};
  StereoRig rig;
  readKalibrCamera(left, rig.K1, rig.D1);
  readKalibrCamera(right, rig.K2, rig.D2);
  if (left.map.has("resolution")) {
    const std::vector<double> size = readMatrix(left, {"resolution"}, 2);
    rig.width = int(size[0]);
    rig.height = int(size[1]);
  }
  const std::string key = "T_cn_cnm1", where = right.map.where(key) + ": " + key;
  const auto rows = right.map.require<std::vector<std::vector<double>>>(key);
  Eigen::Matrix4d T_right_left;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < 4; ++j) {
      if (rows.size() != 4 || rows[i].size() != 4)
        PCL_THROW_EXCEPTION(BadInputException, where << ": is no 4 x 4 matrix");
      T_right_left(Eigen::Index(i), Eigen::Index(j)) = rows[i][j];
    }
  rig.R = nearestRotation(T_right_left.topLeftCorner<3, 3>(), where);
  rig.T = T_right_left.topRightCorner<3, 1>();
  return rig;
}

const Keys ros_projection = {"projection_matrix", "P", "p"};

// A camera_info: its rectification takes the camera's frame to that of the pair, where
// its projection says how far the camera stands to the right [m].
Eigen::Isometry3d
readRosCamera(const Source& camera, Eigen::Matrix3d& K, std::vector<double>& D)
{
  requireModel(camera.map, "distortion_model", {"plumb_bob", "rational_polynomial"});
  K = readSquare(camera, {"camera_matrix", "K", "k"});
  D = readMatrix(camera, {"distortion_coefficients", "D", "d"});
  if (D.empty())
    D.assign(4, 0.0);
  const Keys keys = {"rectification_matrix", "R", "r"};
  const std::vector<double> P = readMatrix(camera, ros_projection, 12);
  Eigen::Isometry3d T_pair_camera = Eigen::Isometry3d::Identity();
  T_pair_camera.linear() = nearestRotation(
      readSquare(camera, keys), camera.map.where(findKey(camera, keys)) + ": R");
  T_pair_camera.translation().x() = -P[3] / P[0];
  return T_pair_camera;
}

StereoRig
readRosRig(const Source& left, const Source& right)
{
  StereoRig rig;
  readSize(left, rig);
  const Eigen::Isometry3d T_pair_left = readRosCamera(left, rig.K1, rig.D1);
  const Eigen::Isometry3d T_pair_right = readRosCamera(right, rig.K2, rig.D2);
  const Eigen::Isometry3d T_right_left = T_pair_right.inverse() * T_pair_left;
  rig.R = T_right_left.linear();
  rig.T = T_right_left.translation();
  return rig;
}

StereoRig
readAnyRig(const Source& source, const std::string& extrinsics_path)
{
  if (source.map.isMap("cam0")) {
    if (!extrinsics_path.empty())
      PCL_THROW_EXCEPTION(BadInputException,
                          source.path << ": is a camchain, which has its extrinsics; "
                                      << extrinsics_path << " is one too many");
    return readKalibrRig(source);
  }
  if (findKey(source, ros_projection).empty())
    return readOpenCvRig(source,
                         extrinsics_path.empty() ? source : load(extrinsics_path));
  if (extrinsics_path.empty())
    PCL_THROW_EXCEPTION(BadInputException,
                        source.path << ": is the camera_info of one camera; give that "
                                       "of the right one as extrinsics");
  return readRosRig(source, load(extrinsics_path));
}

} // namespace

StereoRig
readStereoRig(const std::string& path, const std::string& extrinsics_path)
{
  const StereoRig rig = readAnyRig(load(path), extrinsics_path);
  try {
    rig.validate();
  }
  catch (const InvalidParameterException& error) {
    const std::string message = error.what();
    PCL_THROW_EXCEPTION(
        BadInputException,
        (message[0] == 'T' && !extrinsics_path.empty() ? extrinsics_path : path)
            << ": " << message);
  }
  return rig;
}

} // namespace pcl_semantic
