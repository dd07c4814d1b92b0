// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/dataset/stereo_rig.h>

#include "camera_file.h"

#include "core/fail.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <tuple>

namespace pcl_semantic {

namespace {

constexpr double kFarthest = 10.0; // [m]; larger values are millimetres

void
requireRotation(const Eigen::Matrix3d& R, double tolerance)
{
  const double deviation = deviationOf(R);
  if (!(deviation <= tolerance) || R.determinant() < 0.0)
    badParameter("R: is no rotation (determinant ", R.determinant(),
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
  if (rig.is_fisheye && n != 4)
    fail<Invalid>("D", number, ": has ", n,
                  " numbers, expected the 4 of an equidistant fisheye");
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

// Sets the size stated in the file.
void
setSize(StereoRig& rig, const CameraFile& camera)
{
  rig.width = camera.width;
  rig.height = camera.height;
  rig.stated_size = camera.size;
}

// Two files, or two parts of one, with one camera each.
StereoRig
rigOf(const CameraFile& left, const CameraFile& right)
{
  StereoRig rig;
  setSize(rig, left);
  if (left.width == 0)
    setSize(rig, right);
  else if (right.width > 0 &&
           (right.width != left.width || right.height != left.height))
    badInput(right.path, ": the right images have ", right.size, " pixels, but ",
             left.path, " says ", left.size);
  if (left.is_fisheye != right.is_fisheye)
    badInput(right.path, ": one camera is a fisheye ('equidistant') and the other is "
                         "not, expected two of one kind");
  rig.is_fisheye = left.is_fisheye;
  rig.K1 = left.K;
  rig.K2 = right.K;
  rig.D1 = left.D;
  rig.D2 = right.D;
  rig.doubts = left.doubts;
  rig.doubts.insert(rig.doubts.end(), right.doubts.begin(), right.doubts.end());
  return rig;
}

void
setPose(StereoRig& rig, const Eigen::Isometry3d& T_right_left)
{
  rig.R = T_right_left.linear();
  rig.T = T_right_left.translation();
}

StereoRig
readOpenCvRig(const CalibrationSource& source, const CalibrationSource& extrinsics)
{
  StereoRig rig;
  std::tie(rig.width, rig.height) = readCameraSize(source);
  rig.is_fisheye =
      readsFisheye(source, {"plumb_bob", "rational_polynomial", "radtan", "none", ""});
  rig.K1 = source.square({"K1", "M1", "cameraMatrix1", "camera_matrix_1"});
  rig.D1 = source.numbers({"D1", "distCoeffs1", "dist_coeffs_1"});
  rig.K2 = source.square({"K2", "M2", "cameraMatrix2", "camera_matrix_2"});
  rig.D2 = source.numbers({"D2", "distCoeffs2", "dist_coeffs_2"});
  rig.R = nearestRotation(extrinsics.square({"R"}), extrinsics.where("R"), rig.doubts);
  rig.T = Eigen::Map<const Eigen::Vector3d>(extrinsics.numbers({"T"}, 3).data());
  return rig;
}

StereoRig
readKalibrRig(const CalibrationSource& source)
{
  if (!source.map.isMap("cam1"))
    badInput(source.path, ": has one camera, expected cam0 and cam1");
  const CalibrationSource second = source.inner("cam1");
  StereoRig rig = rigOf(readYamlCamera(source.inner("cam0")), readYamlCamera(second));
  const std::string key = "T_cn_cnm1", where = second.where(key);
  const auto rows = second.map.require<std::vector<std::vector<double>>>(key);
  if (rows.size() != 4 ||
      std::any_of(rows.begin(), rows.end(), [](auto& row) { return row.size() != 4; }))
    badInput(where, ": is no 4 x 4 matrix");
  for (int i = 0; i < 3; ++i) {
    const std::vector<double>& row = rows[std::size_t(i)];
    rig.R.row(i) << row[0], row[1], row[2];
    rig.T[i] = row[3];
  }
  if (rows[3] != std::vector<double>{0.0, 0.0, 0.0, 1.0})
    badInput(where, ": its last row is not 0 0 0 1");
  rig.R = nearestRotation(rig.R, where, rig.doubts);
  return rig;
}

// EuRoC has one file per camera, with the camera's pose in the body.
StereoRig
readEurocRig(const CameraFile& left, const CameraFile& right)
{
  StereoRig rig = rigOf(left, right);
  setPose(rig, right.T_body_camera->inverse() * *left.T_body_camera);
  return rig;
}

// Replaces the original camera by the camera of the rectified images.
void
rectify(CameraFile& camera)
{
  camera.K = camera.P->leftCols<3>();
  camera.R = Eigen::Matrix3d::Identity();
}

// The pose of a camera_info in the pair: the rectification is its rotation, the
// projection gives its offset to the right [m].
Eigen::Isometry3d
poseInPair(const CameraFile& camera)
{
  Eigen::Isometry3d T_pair_camera = Eigen::Isometry3d::Identity();
  T_pair_camera.linear() = *camera.R;
  T_pair_camera.translation().x() = -(*camera.P)(0, 3) / (*camera.P)(0, 0);
  return T_pair_camera;
}

StereoRig
readRosRig(CameraFile left, CameraFile right)
{
  for (const CameraFile& camera : {left, right}) {
    if (!camera.R || !camera.P)
      badInput(camera.path, ": states no 'R' or 'P', expected a camera_info with both");
    if (camera.distortion.empty())
      badInput(camera.path, ": states no distortion ('D'), expected its coefficients");
  }
  // Images with a rotation are not rectified yet, even without distortion.
  const auto isRectified = [](const CameraFile& camera) {
    return camera.R->isIdentity(1e-9) && !camera.isDistorted();
  };
  if (isRectified(left) && isRectified(right)) {
    rectify(left);
    rectify(right);
  }
  StereoRig rig = rigOf(left, right);
  setPose(rig, poseInPair(right).inverse() * poseInPair(left));
  return rig;
}

StereoRig
readMiddleburyRig(const std::string& path)
{
  const MiddleburyFile file = readMiddlebury(path);
  StereoRig rig = rigOf(file.left, file.right);
  rig.R.setIdentity();
  rig.T << -file.baseline, 0.0, 0.0;
  return rig;
}

StereoRig
readAnyRig(const std::string& path, const std::string& extrinsics_path)
{
  if (isMiddlebury(path))
    return readMiddleburyRig(path);
  const CalibrationSource source = CalibrationSource::load(path);
  if (source.map.isMap("cam0")) {
    if (!extrinsics_path.empty())
      badInput(source.path,
               ": is a camchain with extrinsics, expected no second file; omit ",
               extrinsics_path);
    return readKalibrRig(source);
  }
  if (!isYamlCamera(source))
    return readOpenCvRig(source, extrinsics_path.empty()
                                     ? source
                                     : CalibrationSource::load(extrinsics_path));
  const CameraFile left = readYamlCamera(source);
  const std::string kind = left.T_body_camera ? "sensor.yaml" : "camera_info";
  if (extrinsics_path.empty())
    badInput(source.path, ": is the ", kind,
             " of one camera; give that of the right one as extrinsics");
  const CameraFile right = readYamlCamera(CalibrationSource::load(extrinsics_path));
  if (left.T_body_camera && right.T_body_camera)
    return readEurocRig(left, right);
  return readRosRig(left, right);
}

} // namespace

void
StereoRig::validate() const
{
  if (width < 0 || height < 0 || (width == 0) != (height == 0))
    fail<InvalidParameterException>("image size: is ", width, " x ", height, " pixels");
  validateCamera(K1, D1, *this, "1");
  validateCamera(K2, D2, *this, "2");
  requireRotation(R, 1e-6);
  validateTranslation(T);
}

StereoRig
readStereoRig(const std::string& path, const std::string& extrinsics_path)
{
  const StereoRig rig = readAnyRig(path, extrinsics_path);
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
