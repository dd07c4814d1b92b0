// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/dataset/live_folder.h>

#include "core/fail.h"
#include "files/is_there.h"
#include "folder_camera.h"

#include <string>
#include <utility>

namespace pcl_semantic {

namespace {

// KITTI's colour pair if it exists, else its grey pair.
std::pair<std::string, std::string>
foldersIn(const std::string& folder)
{
  if (isFolder(folder + "/image_2"))
    return {folder + "/image_2", folder + "/image_3"};
  return {folder + "/image_0", folder + "/image_1"};
}

NewPairs
pairsIn(const std::string& folder)
{
  auto [left, right] = foldersIn(folder);
  return {std::move(left), std::move(right)};
}

class LiveFolder : public FolderCamera {
public:
  explicit LiveFolder(const std::string& folder)
      : FolderCamera(pairsIn(folder), folder + ": holds no whole pair of images yet")
  {
    const cv::Mat first = readFrameImage(grabbed().left, grabbed().frame);
    const KittiCalibration calibration = readCalibrationOf(
        first.size(), grabbed().left, folder + "/calib.txt",
        first.channels() == 1 ? KittiCameras::grey : KittiCameras::colour);
    pair_.camera = calibration.camera;
    pair_.T_camera0_camera = calibration.T_camera0_camera;
  }

  SensorFrame
  retrieve() override
  {
    StereoFrame frame = readStereoPair(grabbed(), {camera().width, camera().height});
    frame.timestamp = time();
    return frame;
  }
};

} // namespace

bool
holdsPair(const std::string& folder)
{
  const auto [left, right] = foldersIn(folder);
  StereoPairFiles pair;
  return isFolder(left) && isFolder(right) && isThere(folder + "/calib.txt") &&
         NewPairs(left, right).next(pair) > 0;
}

std::unique_ptr<LiveCamera>
openLiveFolder(const std::string& folder)
{
  if (!isFolder(folder))
    fail<BadInputException>(folder, ": is no folder, expected one in KITTI's layout "
                                    "that another program fills");
  return std::make_unique<LiveFolder>(folder);
}

} // namespace pcl_semantic
