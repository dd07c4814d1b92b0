// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/dataset/live_rgbd.h>

#include "files/is_there.h"
#include "folder_camera.h"
#include "rgbd_reader.h"

#include <pcl_semantic/images/image_file.h>

#include <memory>
#include <optional>
#include <string>

namespace pcl_semantic {

namespace {

NewPairs
framesIn(const std::string& folder)
{
  return {folder + "/rgb", folder + "/depth"};
}

class LiveRgbd : public FolderCamera {
public:
  LiveRgbd(const RgbdFiles& files, const PinholeCamera& camera)
      : FolderCamera(framesIn(files.folder),
                     files.folder +
                         ": holds no whole pair of images in rgb and depth yet"),
        scale_{files.depth_scale}, first_(grabbed().left)
  {
    const cv::Mat image = readImage(first_);
    undistorter_.emplace(camera, image.cols, image.rows, first_);
    pair_.camera = undistorter_->camera();
    pair_.doubts = camera.doubts;
  }

  bool
  hasDepth() const override
  {
    return true;
  }

  SensorFrame
  retrieve() override
  {
    RgbdFrame frame = readRgbdFrame(grabbed().left, grabbed().right, *undistorter_,
                                    scale_, 0.0, first_);
    frame.number = grabbed().frame;
    frame.timestamp = time();
    return frame;
  }

private:
  DepthScale scale_;
  std::string first_; // path of the first image
  std::optional<Undistorter> undistorter_;
};

} // namespace

bool
holdsRgbdFrame(const std::string& folder)
{
  StereoPairFiles pair;
  return isFolder(folder + "/rgb") && isFolder(folder + "/depth") &&
         framesIn(folder).next(pair) > 0;
}

std::unique_ptr<LiveCamera>
openLiveRgbd(const RgbdFiles& files, const std::string& calibration)
{
  const PinholeCamera camera = pinholeCameraOf(calibration, files.intrinsics);
  DepthScale{files.depth_scale}.validate();
  return std::make_unique<LiveRgbd>(files, camera);
}

} // namespace pcl_semantic
