// SPDX-License-Identifier: BSD-3-Clause
#include "map_extras.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/dataset/kitti_sequence.h>
#include <pcl_semantic/files/input_file.h>

#include <filesystem>
#include <sstream>

namespace pcl_semantic::tool {

namespace {

void
addScans(const MapArguments& arguments, const FrameSequence* sequence,
         const std::vector<std::size_t>& frames, ExtraOptions& extra)
{
  const auto* const kitti = dynamic_cast<const KittiSequence*>(sequence);
  if (!kitti)
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "--also scans needs a SEQUENCE with laser scans (velodyne)");
  extra.scans = kitti->folder() + "/velodyne";
  extra.T_camera_scanner =
      kitti->T_camera0_camera().inverse() * kitti->T_camera0_velodyne();
  for (const std::size_t i : frames) {
    const std::string scan =
        extra.scans + "/" + frameFileName(kitti->frameNumber(i), ".bin");
    if (!std::filesystem::exists(scan))
      PCL_THROW_EXCEPTION(BadInputException,
                          scan << ": is missing; --also scans needs one a frame");
  }
  extra.within = arguments.scan_within;
}

} // namespace

ExtraOptions
makeExtras(const MapArguments& arguments, const FrameSequence* sequence,
           const std::vector<std::size_t>& frames)
{
  if (!(arguments.scan_within >= 0.0 && arguments.scan_within <= 2.0))
    PCL_THROW_EXCEPTION(InvalidParameterException, "--scan-within is "
                                                       << arguments.scan_within
                                                       << ", expected 0 to 2");
  ExtraOptions extra;
  std::istringstream words(arguments.also);
  for (std::string word; std::getline(words, word, ',');)
    if (word == "measured")
      extra.measured = true;
    else if (word == "depth")
      extra.depth = true;
    else if (word == "scans")
      addScans(arguments, sequence, frames, extra);
    else
      PCL_THROW_EXCEPTION(InvalidParameterException,
                          "--also: '" << word
                                      << "', expected measured, depth or scans");
  return extra;
}

} // namespace pcl_semantic::tool
