// SPDX-License-Identifier: BSD-3-Clause
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

namespace {

const tool::Usage usage{
    "pcl_semantic_rgbd", "SEQUENCE OUT [options]",
    "Frames of an RGB-D camera as organized coloured clouds (.pcd) in the camera's\n"
    "frame, which pcl_semantic_label gives labels and pcl_semantic_map --clouds maps.\n"
    "SEQUENCE has the layout of TUM's benchmark (rgb.txt, depth.txt), or folders rgb\n"
    "and depth whose files have the same names; depth is registered to colour.",
    "pcl_semantic_synthesize /tmp/street && \\\n"
    "  pcl_semantic_map /tmp/street --labels /tmp/street/labels --output /tmp/map \\\n"
    "    --also depth && mkdir -p /tmp/rgbd && \\\n"
    "  ln -sfn /tmp/street/image_2 /tmp/rgbd/rgb && \\\n"
    "  ln -sfn /tmp/map/depth /tmp/rgbd/depth && \\\n"
    "  pcl_semantic_rgbd /tmp/rgbd /tmp/clouds --intrinsics 359,359,303,93 \\\n"
    "    --depth-scale 256"};

struct Options {
  std::string sequence, output, calibration, intrinsics;
  double depth_scale = 0.0, max_depth = 0.0;
};

bool
parseOptions(int argc, char** argv, Options& options)
{
  namespace po = tool::po;
  po::options_description visible("Options");
  visible.add_options()("sequence", po::value(&options.sequence), "RGB-D sequence")(
      "output", po::value(&options.output), "output folder")(
      "calibration", po::value(&options.calibration),
      "ROS camera_info or Kalibr's camchain (.yaml), of undistorted images")(
      "intrinsics", po::value(&options.intrinsics), "instead: fx,fy,cx,cy [px]");
  tool::addOption(visible, "depth-scale", options.depth_scale,
                  "number in a depth image that stands for a metre; 0 = 5000 in TUM's "
                  "layout, else 1000");
  tool::addOption(visible, "max-depth", options.max_depth,
                  "maximum depth [m]; 0 = unlimited");
  po::positional_options_description positional;
  positional.add("sequence", 1).add("output", 1);
  po::variables_map values;
  if (!tool::parseCommandLine(argc, argv, usage, visible, positional, values))
    return false;
  if (options.output.empty())
    tool::failUsage(usage, "expected SEQUENCE OUT");
  if (options.calibration.empty() == options.intrinsics.empty())
    tool::failUsage(usage, "expected --calibration or --intrinsics");
  if (!(options.max_depth >= 0.0))
    tool::failUsage(usage, "--max-depth is less than 0");
  return true;
}

PinholeCamera
cameraOf(const Options& options)
{
  if (!options.calibration.empty())
    return readPinholeCamera(options.calibration);
  std::string text = options.intrinsics;
  std::replace(text.begin(), text.end(), ',', ' ');
  std::vector<double> numbers;
  try {
    numbers = parseNumbers(text, "--intrinsics");
  }
  catch (const BadInputException& error) {
    tool::failUsage(usage, error.what());
  }
  if (numbers.size() != 4)
    tool::failUsage(usage, "--intrinsics: expected fx,fy,cx,cy");
  return {numbers[0], numbers[1], numbers[2], numbers[3]};
}

int
convert(const Options& options)
{
  const RgbdSequence sequence(options.sequence, cameraOf(options), options.depth_scale);
  makeOutputFolder(options.output);
  std::vector<std::string> clouds;
  for (std::size_t i = 0; i < sequence.size(); ++i)
    clouds.push_back(options.output + "/" + sequence.name(i) + ".pcd");
  tool::warnOfOtherFiles(options.output, clouds);
  tool::catchInterrupts();
  tool::ProgressBar progress("converting", sequence.size());
  double valid = 0.0;
  for (std::size_t i = 0; i < sequence.size(); ++i) {
    const CloudFrame frame = sequence.frame(i, options.max_depth);
    writeColourCloud(clouds[i], *frame.cloud);
    valid += double(std::count_if(frame.cloud->begin(), frame.cloud->end(),
                                  [](const auto& point) { return point.z > 0.0f; })) /
             double(frame.cloud->size());
    if (tool::interrupted())
      return tool::exit_interrupted;
    progress.step();
  }
  if (!(valid > 0.0))
    tool::warn("no pixel has a depth within --max-depth; does --depth-scale fit?");
  tool::printResults({{"clouds", sequence.size()},
                      {"valid_fraction", valid / double(sequence.size())},
                      {"output", options.output}});
  return tool::exit_done;
}

} // namespace

int
main(int argc, char** argv)
{
  return tool::run(usage.name, [&] {
    Options options;
    return parseOptions(argc, argv, options) ? convert(options) : int(tool::exit_done);
  });
}
