// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/dataset/pinhole_camera.h>

#include "camera_file.h"

#include "core/fail.h"
#include "core/split.h"

#include <pcl_semantic/core/parse_number.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <string_view>
#include <vector>

namespace pcl_semantic {

namespace {

// Adds doubts about values of a pair, which are unused for one camera.
void
doubtPair(CameraFile& file)
{
  if (file.R && !file.R->isIdentity(1e-6))
    file.doubts.push_back(
        file.path + (file.isRectified() ? ": has R but no distortion: its images count "
                                          "as rectified, so P is used instead of K"
                                        : ": R is not used: it rectifies a pair"));
  if (file.P && !file.P->col(3).isZero(0.0))
    file.doubts.push_back(file.path +
                          ": P is of a camera that is not the left one of its pair; "
                          "its offset is not used, poses are those of this camera");
}

} // namespace

void
PinholeCamera::validate() const
{
  if (!(fx > 0.0 && fy > 0.0 && std::isfinite(fx) && std::isfinite(fy) &&
        std::isfinite(cx) && std::isfinite(cy)))
    fail<InvalidParameterException>("camera: fx ", fx, ", fy ", fy, ", cx ", cx,
                                    ", cy ", cy,
                                    " px, expected positive focal lengths");
  if (width < 0 || height < 0 || (width == 0) != (height == 0))
    badParameter("camera: the image size is ", width, " x ", height, " pixels");
  const std::size_t coefficients = distortion.size();
  const std::initializer_list<std::size_t> counts = {0, 4, 5, 8, 12, 14};
  if (is_fisheye
          ? coefficients != 4
          : std::find(counts.begin(), counts.end(), coefficients) == counts.end())
    badParameter("camera: has ", coefficients, " distortion coefficients, expected ",
                 is_fisheye ? "4" : "0, 4, 5, 8, 12 or 14");
  for (const double coefficient : distortion)
    if (!std::isfinite(coefficient))
      badParameter("camera: a distortion coefficient is not finite");
}

StereoCamera
PinholeCamera::ofImage(int image_width, int image_height,
                       const std::string& image) const
{
  const std::string name = calibration.empty() ? "the camera" : calibration;
  requireStatedSize(width, height, stated_size, name, image_width, image_height, image);
  // Outside, the calibration is for images of another size.
  if (width == 0 && !(cx > 0.0 && cx < image_width && cy > 0.0 && cy < image_height))
    badInput(name, ": the principal point (", cx, ", ", cy,
             ") is outside the images of ", image_width, " x ", image_height,
             " pixels, the size of ", image);
  return {fx, fy, cx, cy, 1.0, image_width, image_height};
}

PinholeCamera
readPinholeCamera(const std::string& path)
{
  CameraFile file = readCameraFile(path);
  doubtPair(file);
  const Eigen::Matrix3d K =
      file.isRectified() ? Eigen::Matrix3d(file.P->leftCols<3>()) : file.K;
  PinholeCamera camera{K(0, 0),     K(1, 1),   K(0, 2),   K(1, 2),    file.width,
                       file.height, file.path, file.size, file.doubts};
  if (file.isDistorted()) {
    camera.distortion = file.D;
    camera.is_fisheye = file.is_fisheye;
    camera.doubts.push_back(
        file.distortion +
        (file.is_fisheye
             ? ": the images of this fisheye will be undistorted; if they are already, "
               "state "
               "the model plumb_bob with zeros, and P as K"
             : ": the images will be undistorted with these coefficients; if they are "
               "already (ROS' image_rect), state zeros, and P as K"));
  }
  readFrom(path, [&] { camera.validate(); });
  return camera;
}

PinholeCamera
pinholeCameraOf(const std::string& calibration, const std::string& intrinsics)
{
  if (calibration.empty() == intrinsics.empty())
    badParameter("expected --calibration or --intrinsics");
  if (!calibration.empty())
    return readPinholeCamera(calibration);
  std::vector<double> numbers;
  try {
    for (const std::string_view word : splitAt(',', intrinsics))
      numbers.push_back(parseNumber(std::string(word), "--intrinsics"));
  }
  catch (const BadInputException&) {
    numbers.clear();
  }
  if (numbers.size() != 4)
    badParameter("--intrinsics is '", intrinsics, "', expected fx,fy,cx,cy [px]");
  PinholeCamera camera{numbers[0], numbers[1], numbers[2], numbers[3]};
  camera.validate();
  return camera;
}

} // namespace pcl_semantic
