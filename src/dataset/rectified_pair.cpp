// SPDX-License-Identifier: BSD-3-Clause
#include "stereo_pair_reader.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/dataset/rectified_pair.h>

#include <filesystem>

namespace pcl_semantic {

namespace {

// The rig with the size of the first image, which has to be its own if it has one.
StereoRig
readRigOf(const SizedFile& first, const CalibrationFiles& files)
{
  StereoRig rig = readStereoRig(files.calibration, files.extrinsics);
  if (rig.width > 0 && first.size != cv::Size(rig.width, rig.height))
    PCL_THROW_EXCEPTION(BadInputException,
                        first.path << ": has " << first.size.width << " x "
                                   << first.size.height << " pixels, but "
                                   << files.calibration << " is the calibration of "
                                   << rig.width << " x " << rig.height);
  rig.width = first.size.width;
  rig.height = first.size.height;
  return rig;
}

} // namespace

RectifiedPair
readRectifiedPair(const CalibrationFiles& files, const SizedFile& first,
                  KittiCameras cameras)
{
  if (std::filesystem::path(files.calibration).extension() == ".txt") {
    const KittiCalibration calibration =
        readCalibrationOf(first.size, files.calibration, cameras);
    return {calibration.camera, calibration.T_camera0_camera, std::nullopt};
  }
  const StereoRig rig = readRigOf(first, files);
  try {
    Rectifier rectifier(rig);
    return {rectifier.camera(), rectifier.T_left_rectified(), rectifier};
  }
  catch (const InvalidParameterException& error) {
    PCL_THROW_EXCEPTION(BadInputException, files.calibration << ": " << error.what());
  }
}

} // namespace pcl_semantic
