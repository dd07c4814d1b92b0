// SPDX-License-Identifier: BSD-3-Clause
#include "stereo_pair_reader.h"
#include "camera_file.h"
#include "core/fail.h"

#include <pcl_semantic/files/trajectory_file.h>
#include <pcl_semantic/images/image_file.h>

namespace pcl_semantic {

cv::Mat
readFrameImage(const std::string& path, int frame, cv::Size size)
{
  try {
    return readImage(path, size, " as the first image");
  }
  catch (const BadInputException& error) {
    fail<BadInputException>(error.what(), " (frame ", frame, ")");
  }
}

StereoFrame
readStereoPair(const StereoPairFiles& files, cv::Size size)
{
  StereoFrame frame;
  frame.number = files.frame;
  frame.left = readFrameImage(files.left, files.frame, size);
  frame.right = readFrameImage(files.right, files.frame, size);
  if (frame.right.type() != frame.left.type())
    fail<BadInputException>(files.right, ": has ", frame.right.channels(),
                            " channel(s), the left image has ", frame.left.channels(),
                            " (frame ", files.frame, ")");
  return frame;
}

KittiCalibration
readCalibrationOf(cv::Size size, const std::string& image, const std::string& path,
                  KittiCameras cameras)
{
  KittiCalibration calibration = readKittiCalibration(path, cameras);
  StereoCamera& camera = calibration.camera;
  requireStatedSize(camera.width, camera.height, "", path, size.width, size.height,
                    image);
  camera.width = size.width;
  camera.height = size.height;
  readFrom(path, [&] { camera.validate(); });
  // Outside, the calibration is for images of another size.
  if (!(camera.cx > 0.0 && camera.cx < camera.width && camera.cy > 0.0 &&
        camera.cy < camera.height))
    fail<BadInputException>(path, ": the principal point (", camera.cx, ", ", camera.cy,
                            ") is outside the images of ", camera.width, " x ",
                            camera.height, " pixels");
  return calibration;
}

std::vector<double>
readTimesOf(const std::string& path, std::size_t frames, const std::string& called)
{
  const std::vector<double> times = readTimes(path);
  if (times.size() < frames)
    fail<BadInputException>(path, ": has ", times.size(), " times for ", frames, " ",
                            called);
  return times;
}

} // namespace pcl_semantic
