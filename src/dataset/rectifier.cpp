// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/dataset/rectifier.h>

#include "camera_file.h"
#include "core/fail.h"
#include "lens_maps.h"
#include "stereo_pair_reader.h"

#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <filesystem>

namespace pcl_semantic {

namespace {

// A rig in OpenCV's types, and the result of stereoRectify.
struct Rectification {
  cv::Mat K1, K2, D1, D2, R, T;
  cv::Mat R1, R2, P1, P2;

  explicit Rectification(const StereoRig& rig)
      : D1(cv::Mat(rig.D1).clone()), D2(cv::Mat(rig.D2).clone())
  {
    cv::eigen2cv(rig.K1, K1);
    cv::eigen2cv(rig.K2, K2);
    cv::eigen2cv(rig.R, R);
    cv::eigen2cv(rig.T, T);
    const cv::Size size(rig.width, rig.height);
    cv::Mat Q;
    if (rig.is_fisheye)
      cv::fisheye::stereoRectify(K1, D1, K2, D2, size, R, T, R1, R2, P1, P2, Q,
                                 cv::CALIB_ZERO_DISPARITY);
    else
      cv::stereoRectify(K1, D1, K2, D2, size, R, T, R1, R2, P1, P2, Q,
                        cv::CALIB_ZERO_DISPARITY, 0.0);
  }
};

bool
isRectified(const StereoRig& rig)
{
  const auto isZero = [](const std::vector<double>& D) {
    return std::all_of(D.begin(), D.end(), [](double d) { return d == 0.0; });
  };
  return !rig.is_fisheye && isZero(rig.D1) && isZero(rig.D2) && rig.K1 == rig.K2 &&
         rig.R.isIdentity(1e-9) && rig.T.y() == 0.0 && rig.T.z() == 0.0;
}

StereoCamera
cameraOf(const StereoRig& rig, const Rectification& result)
{
  const cv::Mat1d P1 = result.P1, P2 = result.P2;
  const StereoCamera camera{
      P1(0, 0),  P1(1, 1),  P1(0, 2), P1(1, 2), -P2(0, 3) / P1(0, 0),
      rig.width, rig.height};
  requireFocalLength(camera.fx, rig.K1(0, 0), "check K, D, R and T");
  camera.validate();
  return camera;
}

} // namespace

Rectifier::Rectifier(const StereoRig& rig)
{
  rig.validate();
  if (rig.width == 0)
    fail<InvalidParameterException>(
        "image size: is not known, expected that of the rig's images");
  if (isRectified(rig)) {
    camera_ = {rig.K1(0, 0), rig.K1(1, 1), rig.K1(0, 2), rig.K1(1, 2),
               -rig.T.x(),   rig.width,    rig.height};
    return;
  }
  try {
    const Rectification result(rig);
    camera_ = cameraOf(rig, result);
    Eigen::Matrix3d R1;
    cv::cv2eigen(result.R1, R1);
    T_left_rectified_.linear() = R1.transpose();
    const cv::Size size(rig.width, rig.height);
    const auto mapsOf = [&](const cv::Mat& K, const cv::Mat& D, const cv::Mat& R,
                            const cv::Mat& P, const std::string& name) {
      const LensMaps maps = lensMapsOf({K, D, rig.is_fisheye}, R, P, size);
      requireUsable(maps,
                    "the " + name + " image can be rectified; check K, D, R and T");
      return Maps{maps.whole, maps.fraction};
    };
    maps_[0] = mapsOf(result.K1, result.D1, result.R1, result.P1, "left");
    maps_[1] = mapsOf(result.K2, result.D2, result.R2, result.P2, "right");
  }
  catch (const cv::Exception& error) { // its message has several lines
    fail<InvalidParameterException>("the rig cannot be rectified: ", error.err);
  }
}

cv::Mat
Rectifier::rectify(const cv::Mat& image, StereoSide side) const
{
  if (image.cols != camera_.width || image.rows != camera_.height)
    fail<InvalidParameterException>("image has ", image.cols, " x ", image.rows,
                                    " pixels, expected ", camera_.width, " x ",
                                    camera_.height, " as the rig");
  const Maps& maps = maps_[std::size_t(side)];
  if (maps.whole.empty())
    return image.clone();
  cv::Mat rectified;
  cv::remap(image, rectified, maps.whole, maps.fraction, cv::INTER_LINEAR,
            cv::BORDER_CONSTANT);
  return rectified;
}

void
RectifiedPair::rectify(StereoFrame& frame) const
{
  if (!rectifier)
    return;
  frame.left = rectifier->rectify(frame.left, StereoSide::left);
  frame.right = rectifier->rectify(frame.right, StereoSide::right);
}

RectifiedPair
readRectifiedPair(const CalibrationFiles& files, const SizedFile& first,
                  KittiCameras cameras)
{
  if (std::filesystem::path(files.calibration).extension() == ".txt" &&
      !isMiddlebury(files.calibration)) {
    if (!files.extrinsics.empty())
      fail<InvalidParameterException>("extrinsics (", files.extrinsics,
                                      ") have no effect on ", files.calibration,
                                      ", which has them");
    const KittiCalibration calibration =
        readCalibrationOf(first.size, first.path, files.calibration, cameras);
    return {calibration.camera, calibration.T_camera0_camera, std::nullopt, {}};
  }
  StereoRig rig = readStereoRig(files.calibration, files.extrinsics);
  requireStatedSize(rig.width, rig.height, rig.stated_size, files.calibration,
                    first.size.width, first.size.height, first.path);
  rig.width = first.size.width;
  rig.height = first.size.height;
  const Rectifier rectifier =
      readFrom(files.calibration, [&] { return Rectifier(rig); });
  return {rectifier.camera(), rectifier.T_left_rectified(), rectifier, rig.doubts};
}

} // namespace pcl_semantic
