// SPDX-License-Identifier: BSD-3-Clause
#include "stereo_pair_reader.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/image_file.h>

namespace pcl_semantic {

namespace {

// A principal point outside the image is the calibration of images of another size.
void
checkCamera(const StereoCamera& camera, const std::string& path)
{
  try {
    camera.validate();
  }
  catch (const InvalidParameterException& error) {
    PCL_THROW_EXCEPTION(BadInputException, path << ": " << error.what());
  }
  if (!(camera.cx > 0.0 && camera.cx < camera.width && camera.cy > 0.0 &&
        camera.cy < camera.height))
    PCL_THROW_EXCEPTION(BadInputException,
                        path << ": the principal point (" << camera.cx << ", "
                             << camera.cy << ") is outside the images of "
                             << camera.width << " x " << camera.height << " pixels");
}

} // namespace

cv::Mat
readFrameImage(const std::string& path, int frame)
{
  try {
    return readImage(path);
  }
  catch (const BadInputException& error) {
    PCL_THROW_EXCEPTION(BadInputException, error.what() << " (frame " << frame << ")");
  }
}

StereoFrame
readStereoPair(const StereoPairFiles& files, cv::Size size, const std::string& as)
{
  StereoFrame frame;
  frame.number = files.frame;
  frame.left = readFrameImage(files.left, files.frame);
  frame.right = readFrameImage(files.right, files.frame);
  for (const auto& [image, path] :
       {std::pair(&frame.left, &files.left), std::pair(&frame.right, &files.right)}) {
    if (image->size() != size)
      PCL_THROW_EXCEPTION(BadInputException,
                          *path << ": has " << image->cols << " x " << image->rows
                                << " pixels, expected " << size.width << " x "
                                << size.height << " as " << as << " (frame "
                                << files.frame << ")");
    if (image->type() != frame.left.type())
      PCL_THROW_EXCEPTION(BadInputException, *path << ": has " << image->channels()
                                                   << " channel(s), the left image has "
                                                   << frame.left.channels()
                                                   << " (frame " << files.frame << ")");
  }
  return frame;
}

KittiCalibration
readCalibrationOf(cv::Size size, const std::string& path, KittiCameras cameras)
{
  KittiCalibration calibration = readKittiCalibration(path, cameras);
  calibration.camera.width = size.width;
  calibration.camera.height = size.height;
  checkCamera(calibration.camera, path);
  return calibration;
}

} // namespace pcl_semantic
