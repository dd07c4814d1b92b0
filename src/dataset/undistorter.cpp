// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/dataset/undistorter.h>

#include "core/fail.h"
#include "lens_maps.h"

#include <pcl_semantic/files/input_file.h>

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

namespace pcl_semantic {

namespace {

cv::Mat
undistortedMatrix(const LensModel& lens, const cv::Size& size)
{
  if (!lens.is_fisheye)
    return cv::getOptimalNewCameraMatrix(lens.K, lens.D, size, 0.0);
  cv::Mat K;
  cv::fisheye::estimateNewCameraMatrixForUndistortRectify(
      lens.K, lens.D, size, cv::Mat::eye(3, 3, CV_64F), K, 0.0);
  return K;
}

// The nearest pixels: the maps have whole pixels, rounded down, and 1/32 px.
cv::Mat2s
nearestOf(const LensMaps& maps)
{
  cv::Mat2s nearest = maps.whole.clone();
  for (int y = 0; y < nearest.rows; ++y)
    for (int x = 0; x < nearest.cols; ++x) {
      const int fraction = maps.fraction(y, x);
      nearest(y, x) += cv::Vec2s(short(fraction % 32 / 16), short(fraction / 32 / 16));
    }
  return nearest;
}

} // namespace

Undistorter::Undistorter(const PinholeCamera& camera, int width, int height,
                         const std::string& image)
    : camera_(camera.ofImage(width, height, image))
{
  if (!camera.isDistorted())
    return;
  const cv::Size size(width, height);
  const LensModel lens{
      (cv::Mat1d(3, 3) << camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1),
      cv::Mat(camera.distortion, true), camera.is_fisheye};
  const std::string advice = "check K and D";
  readFrom(camera.calibration, [&] {
    try {
      const cv::Mat1d K = undistortedMatrix(lens, size);
      requireFocalLength(K(0, 0), camera.fx, advice);
      camera_ = {K(0, 0), K(1, 1), K(0, 2), K(1, 2), 1.0, width, height};
      camera_.validate();
      const LensMaps maps = lensMapsOf(lens, cv::Mat::eye(3, 3, CV_64F), K, size);
      requireUsable(maps, "the image can be undistorted; " + advice);
      whole_ = maps.whole;
      fraction_ = maps.fraction;
      nearest_ = nearestOf(maps);
    }
    catch (const cv::Exception& error) { // its message has several lines
      badParameter("the image cannot be undistorted: ", error.err);
    }
  });
}

cv::Mat
Undistorter::undistort(const cv::Mat& image) const
{
  requireSize(image);
  if (!isDistorted())
    return image;
  cv::Mat undistorted;
  cv::remap(image, undistorted, whole_, fraction_, cv::INTER_LINEAR);
  return undistorted;
}

cv::Mat
Undistorter::undistortNearest(const cv::Mat& image) const
{
  requireSize(image);
  if (!isDistorted())
    return image;
  cv::Mat undistorted;
  cv::remap(image, undistorted, nearest_, cv::Mat(), cv::INTER_NEAREST);
  return undistorted;
}

void
Undistorter::requireSize(const cv::Mat& image) const
{
  if (image.size() != cv::Size(camera_.width, camera_.height))
    badParameter("image has ", image.cols, " x ", image.rows, " pixels, expected ",
                 camera_.width, " x ", camera_.height, " as the camera");
}

} // namespace pcl_semantic
