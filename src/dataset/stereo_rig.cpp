// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/dataset/stereo_rig.h>

#include "core/fail.h"
#include "files/yaml_config.h"

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

using Keys = std::vector<std::string>;

// How far R R^T is off the identity.
double
deviationOf(const Eigen::Matrix3d& R)
{
  return (R * R.transpose() - Eigen::Matrix3d::Identity()).norm();
}

template <typename Error>
void
requireRotation(const Eigen::Matrix3d& R, double tolerance, const std::string& name)
{
  const double deviation = deviationOf(R);
  if (!(deviation <= tolerance) || R.determinant() < 0.0)
    fail<Error>(name, ": is no rotation (determinant ", R.determinant(),
                ", R R^T is off by ", deviation, ")");
}

void
validateCamera(const Eigen::Matrix3d& K, const std::vector<double>& D,
               const StereoRig& rig, const std::string& number)
{
  using Invalid = InvalidParameterException;
  const double fx = K(0, 0), fy = K(1, 1), cx = K(0, 2), cy = K(1, 2);
  if (!K.allFinite())
    fail<Invalid>("K", number, ": is not finite");
  if (!(fx > 0.0 && fy > 0.0))
    fail<Invalid>("K", number, ": focal lengths are ", fx, " and ", fy,
                  " px, expected more than 0");
  if (K(0, 1) != 0.0 || K(1, 0) != 0.0 ||
      !K.row(2).isApprox(Eigen::RowVector3d(0, 0, 1)))
    fail<Invalid>("K", number,
                  ": is no camera matrix, expected fx 0 cx, 0 fy cy, 0 0 1");
  if (rig.width > 0 && !(cx > 0.0 && cx < rig.width && cy > 0.0 && cy < rig.height))
    fail<Invalid>("K", number, ": the principal point (", cx, ", ", cy,
                  ") is outside the images of ", rig.width, " x ", rig.height,
                  " pixels");
  const std::size_t n = D.size();
  if (n != 4 && n != 5 && n != 8 && n != 12 && n != 14)
    fail<Invalid>("D", number, ": has ", n, " numbers, expected 4, 5, 8, 12 or 14");
  if (!std::all_of(D.begin(), D.end(), [](double d) { return std::isfinite(d); }))
    fail<Invalid>("D", number, ": is not finite");
}

void
validateTranslation(const Eigen::Vector3d& T)
{
  const auto refuse = [&T](const char* why) {
    fail<InvalidParameterException>("T: is (", T.x(), ", ", T.y(), ", ", T.z(),
                                    "): ", why);
  };
  if (!T.allFinite())
    refuse("not finite");
  if (T.isZero(0.0))
    refuse("the baseline is 0 m, expected more");
  if (T.norm() > kFarthest)
    refuse("the baseline is more than 10 m; if these are millimetres, expected metres");
  if (std::abs(T.y()) >= std::abs(T.x()))
    refuse("one camera is above the other, expected them side by side");
  if (std::abs(T.z()) >= std::abs(T.x()))
    refuse("one camera is ahead of the other, expected them side by side");
  if (T.x() > 0.0)
    refuse("the right camera is on the left, expected T.x < 0 (x_right = R x_left + "
           "T); are left and right swapped?");
}

// A calibration file, or the mapping of one camera in it.
struct Source {
  std::string path;
  YamlMap map;

  // The one of a value's keys that is there; empty if none is.
  std::string
  find(const Keys& keys) const
  {
    std::string found;
    for (const std::string& key : keys) {
      if (!map.has(key))
        continue;
      if (!found.empty())
        fail<BadInputException>(map.where(key), ": '", key, "' is '", found,
                                "' once more, expected one of them");
      found = key;
    }
    return found;
  }

  // The numbers of a matrix, row after row; as many as there are, or \a count.
  std::vector<double>
  numbers(const Keys& keys, std::size_t count = 0) const
  {
    const std::string key = find(keys);
    if (key.empty()) {
      std::string names;
      for (const std::string& name : keys)
        names += (names.empty() ? "'" : " or '") + name + "'";
      fail<BadInputException>(path, ": key ", names, " is missing");
    }
    const std::string where = map.where(key) + ": " + key;
    const bool is_matrix = map.isMap(key);
    const YamlMap matrix = is_matrix ? map.requireMap(key) : map;
    std::string words;
    for (const std::string& word :
         matrix.require<std::vector<std::string>>(is_matrix ? "data" : key))
      words += word + " ";
    const std::vector<double> data = parseNumbers(words, where);
    if (is_matrix) {
      const int rows = matrix.require<int>("rows"),
                columns = matrix.require<int>("cols");
      if (rows < 1 || columns < 1 || double(rows) * columns != double(data.size()))
        fail<BadInputException>(where, ": has ", data.size(), " numbers, expected ",
                                rows, " x ", columns);
    }
    if (count > 0 && data.size() != count)
      fail<BadInputException>(where, ": has ", data.size(), " numbers, expected ",
                              count);
    return data;
  }

  Eigen::Matrix3d
  square(const Keys& keys) const
  {
    using RowMajor33 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
    return Eigen::Map<const RowMajor33>(numbers(keys, 9).data());
  }

  // Distortion; without any, zeros.
  std::vector<double>
  coefficients(const Keys& keys) const
  {
    const std::vector<double> D = numbers(keys);
    return D.empty() ? std::vector<double>(4, 0.0) : D;
  }

  void
  requireModel(const std::string& key, const Keys& known) const
  {
    std::string model;
    if (map.get(key, model) && !std::count(known.begin(), known.end(), model))
      fail<BadInputException>(map.where(key), ": ", key, " is ", inQuotes(model),
                              ", expected ", inQuotes(known[0]), " (no fisheyes)");
  }
};

// Fewer digits than those of a double leave no exact rotation.
Eigen::Matrix3d
nearestRotation(const Eigen::Matrix3d& R, const std::string& where)
{
  requireRotation<BadInputException>(R, 1e-2, where);
  if (deviationOf(R) > 1e-4)
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
    fail<BadInputException>(source.path,
                            ": expected both 'image_width' and 'image_height'");
  const std::string key = source.find({"image_size", "imageSize"});
  if (!has_width && !key.empty()) {
    const auto size = source.map.require<std::vector<int>>(key);
    if (size.size() != 2)
      fail<BadInputException>(source.map.where(key), ": ", key, ": has ", size.size(),
                              " numbers, expected width, height");
    rig.width = size[0];
    rig.height = size[1];
  }
  if ((has_width || !key.empty()) && (rig.width < 2 || rig.height < 2))
    fail<BadInputException>(source.path, ": the image size is ", rig.width, " x ",
                            rig.height, " pixels");
}

StereoRig
readOpenCvRig(const Source& source, const Source& extrinsics)
{
  StereoRig rig;
  readSize(source, rig);
  rig.K1 = source.square({"K1", "M1", "cameraMatrix1", "camera_matrix_1"});
  rig.D1 = source.numbers({"D1", "distCoeffs1", "dist_coeffs_1"});
  rig.K2 = source.square({"K2", "M2", "cameraMatrix2", "camera_matrix_2"});
  rig.D2 = source.numbers({"D2", "distCoeffs2", "dist_coeffs_2"});
  rig.R = nearestRotation(extrinsics.square({"R"}), extrinsics.map.where("R") + ": R");
  rig.T = Eigen::Map<const Eigen::Vector3d>(extrinsics.numbers({"T"}, 3).data());
  return rig;
}

// A camera of Kalibr's camchain.
void
readKalibrCamera(const Source& camera, Eigen::Matrix3d& K, std::vector<double>& D)
{
  camera.requireModel("camera_model", {"pinhole"});
  camera.requireModel("distortion_model", {"radtan", "none"});
  const std::vector<double> values = camera.numbers({"intrinsics"}, 4);
  K << values[0], 0, values[2], 0, values[1], values[3], 0, 0, 1;
  D.assign(4, 0.0);
  if (camera.map.has("distortion_coeffs"))
    D = camera.coefficients({"distortion_coeffs"});
}

StereoRig
readKalibrRig(const Source& source)
{
  if (!source.map.isMap("cam1"))
    fail<BadInputException>(source.path, ": has one camera, expected cam0 and cam1");
  const Source left{source.path, source.map.requireMap("cam0")};
  const Source right{source.path, source.map.requireMap("cam1")};
  StereoRig rig;
  readKalibrCamera(left, rig.K1, rig.D1);
  readKalibrCamera(right, rig.K2, rig.D2);
  if (left.map.has("resolution")) {
    const std::vector<double> size = left.numbers({"resolution"}, 2);
    rig.width = int(size[0]);
    rig.height = int(size[1]);
  }
  const std::string key = "T_cn_cnm1", where = right.map.where(key) + ": " + key;
  const auto rows = right.map.require<std::vector<std::vector<double>>>(key);
  if (rows.size() != 4 ||
      std::any_of(rows.begin(), rows.end(), [](auto& row) { return row.size() != 4; }))
    fail<BadInputException>(where, ": is no 4 x 4 matrix");
  for (int i = 0; i < 3; ++i) {
    const std::vector<double>& row = rows[std::size_t(i)];
    rig.R.row(i) << row[0], row[1], row[2];
    rig.T[i] = row[3];
  }
  rig.R = nearestRotation(rig.R, where);
  return rig;
}

const Keys ros_projection = {"projection_matrix", "P", "p"};

// A camera_info: its rectification takes the camera's frame to that of the pair, where
// its projection says how far the camera stands to the right [m].
Eigen::Isometry3d
readRosCamera(const Source& camera, Eigen::Matrix3d& K, std::vector<double>& D)
{
  camera.requireModel("distortion_model", {"plumb_bob", "rational_polynomial"});
  K = camera.square({"camera_matrix", "K", "k"});
  D = camera.coefficients({"distortion_coefficients", "D", "d"});
  const Keys keys = {"rectification_matrix", "R", "r"};
  const std::vector<double> P = camera.numbers(ros_projection, 12);
  Eigen::Isometry3d T_pair_camera = Eigen::Isometry3d::Identity();
  T_pair_camera.linear() =
      nearestRotation(camera.square(keys), camera.map.where(camera.find(keys)) + ": R");
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

Source
load(const std::string& path)
{
  for (const TextLine& line : readLines(path)) {
    if (line.text.empty())
      continue;
    if (line.text[0] == '<')
      fail<BadInputException>(path, ": is XML, expected YAML as cv::FileStorage writes "
                                    "it to a file named .yaml");
    break;
  }
  return {path, YamlMap::load(path)};
}

StereoRig
readAnyRig(const Source& source, const std::string& extrinsics_path)
{
  if (source.map.isMap("cam0")) {
    if (!extrinsics_path.empty())
      fail<BadInputException>(source.path,
                              ": is a camchain, which has its extrinsics; ",
                              extrinsics_path, " is one too many");
    return readKalibrRig(source);
  }
  if (source.find(ros_projection).empty())
    return readOpenCvRig(source,
                         extrinsics_path.empty() ? source : load(extrinsics_path));
  if (extrinsics_path.empty())
    fail<BadInputException>(source.path,
                            ": is the camera_info of one camera; give that "
                            "of the right one as extrinsics");
  return readRosRig(source, load(extrinsics_path));
}

} // namespace

void
StereoRig::validate() const
{
  if (width < 0 || height < 0 || (width == 0) != (height == 0))
    fail<InvalidParameterException>("image size: is ", width, " x ", height, " pixels");
  validateCamera(K1, D1, *this, "1");
  validateCamera(K2, D2, *this, "2");
  requireRotation<InvalidParameterException>(R, 1e-6, "R");
  validateTranslation(T);
}

StereoRig
readStereoRig(const std::string& path, const std::string& extrinsics_path)
{
  const StereoRig rig = readAnyRig(load(path), extrinsics_path);
  try {
    rig.validate();
  }
  catch (const InvalidParameterException& error) {
    const bool is_extrinsic = error.what()[0] == 'T' && !extrinsics_path.empty();
    fail<BadInputException>(is_extrinsic ? extrinsics_path : path, ": ", error.what());
  }
  return rig;
}

} // namespace pcl_semantic
