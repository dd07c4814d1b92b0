// SPDX-License-Identifier: BSD-3-Clause
#include "image_tool.h"
#include "messages.h"
#include "tool.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/dataset/rgbd_sequence.h>
#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/io/colour_cloud_file.h>

#include <algorithm>
#include <filesystem>

using namespace pcl_semantic;
using namespace pcl_semantic::tool;

namespace {

const Usage usage{
    "pcl_semantic_rgbd", "SEQUENCE OUT [options]",
    R"(Converts the frames of an RGB-D camera to organized coloured clouds (.pcd) in the camera
frame. pcl_semantic_label labels these clouds and pcl_semantic_map --clouds maps them.
SEQUENCE has folders rgb (or color) and depth whose files have the same names, or
the layout of TUM (rgb.txt, depth.txt) or 7-Scenes; depth is registered to colour.)",
    R"(pcl_semantic_synthesize /tmp/street && \
  pcl_semantic_map /tmp/street --labels /tmp/street/labels --output /tmp/map \
    --also depth && mkdir -p /tmp/rgbd && \
  ln -sfn /tmp/street/image_2 /tmp/rgbd/rgb && \
  ln -sfn /tmp/map/depth /tmp/rgbd/depth && \
  pcl_semantic_rgbd /tmp/rgbd /tmp/clouds --intrinsics 359,359,303,93 \
    --depth-scale 256)"};

struct Options {
  RgbdFiles sequence;
  std::string output, calibration;
  double max_depth = 0.0;
};

Options
parse(int argc, char** argv)
{
  Options options;
  parseCommandLine(
      argc, argv, usage,
      {{"sequence", options.sequence.folder, "folder of the RGB-D sequence"},
       {"output", options.output, "output folder"},
       {"calibration", options.calibration,
        "camera and its lens: ROS camera_info, OpenCV, Kalibr's camchain or EuRoC's "
        "sensor.yaml (.yaml), KITTI's or Middlebury's calib.txt"},
       {"intrinsics", options.sequence.intrinsics,
        "intrinsics fx,fy,cx,cy instead of --calibration [px]"},
       {"depth-scale", withDefault(options.sequence.depth_scale),
        "value of 1 m in the depth images; 0 = 5000 in TUM's layout, 1 for float "
        "images, "
        "else 1000"},
       {"depth-within", withDefault(options.sequence.depth_within),
        "maximum difference between the times of a colour image and its depth image in "
        "TUM's layout [s]"},
       {"max-depth", withDefault(options.max_depth),
        "maximum depth [m]; 0 = unlimited"}},
      {"sequence", "output"});
  refuseIf(options.output.empty(), "expected SEQUENCE OUT");
  const std::string& intrinsics = options.sequence.intrinsics;
  refuseIf(options.calibration.empty() == intrinsics.empty(),
           "expected --calibration or --intrinsics");
  if (!intrinsics.empty())
    asUsage([&] { pinholeCameraOf("", intrinsics); });
  refuseIf(!(options.max_depth >= 0.0), "--max-depth is less than 0");
  return options;
}

int
convert(const Options& options)
{
  const RgbdSequence sequence(options.sequence, options.calibration);
  warnOf(sequence.doubts());
  makeOutputFolder(options.output);
  std::vector<std::string> clouds;
  for (std::size_t i = 0; i < sequence.size(); ++i)
    clouds.push_back(options.output + "/" + sequence.name(i) + ".pcd");
  warnOfOtherFiles(options.output, clouds);
  double valid = 0.0;
  std::size_t unmeasured = 0;
  forEachStep("converting", sequence.size(), [&](std::size_t i) {
    const RgbdFrame frame = sequence.frame(i, options.max_depth);
    unmeasured += frame.unmeasured;
    writeColourCloud(clouds[i], *frame.cloud);
    valid += double(std::count_if(frame.cloud->begin(), frame.cloud->end(),
                                  [](const auto& point) { return point.z > 0.0f; })) /
             double(frame.cloud->size());
  });
  const bool has_depths = unmeasured < sequence.size() *
                                           std::size_t(sequence.camera().width) *
                                           std::size_t(sequence.camera().height);
  if (!has_depths)
    warn(options.sequence.folder +
         ": no depth image has a measurement: all are 0 or 65535");
  else if (!(valid > 0.0))
    warn("no pixel has a depth within --max-depth; does --depth-scale fit?");
  printResults({{"clouds", sequence.size()},
                {"valid_fraction", valid / double(sequence.size())},
                {"pixels_without_depth", unmeasured},
                {"output", options.output}});
  return exit_done;
}

} // namespace

int
main(int argc, char** argv)
{
  return runWithImages(usage.name, [&] { return convert(parse(argc, argv)); });
}
