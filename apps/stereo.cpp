// SPDX-License-Identifier: BSD-3-Clause
#include "files/is_there.h"
#include "image_tool.h"
#include "messages.h"
#include "sequence_options.h"
#include "tool.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/dataset/image_pair_sequence.h>
#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/images/image_file.h>
#include <pcl_semantic/io/colour_cloud_file.h>
#include <pcl_semantic/stereo/disparity_engines.h>
#include <pcl_semantic/stereo/disparity_to_cloud.h>

#include <opencv2/core.hpp>

#include <cmath>
#include <filesystem>

using namespace pcl_semantic;
using namespace pcl_semantic::tool;

namespace {

namespace fs = std::filesystem;

const Usage usage{
    "pcl_semantic_stereo", "LEFT RIGHT CALIBRATION OUT [options]",
    R"(Computes the depth of a stereo pair (.png) and writes it as an organized coloured cloud
(.pcd) in the frame of the left camera. If LEFT, RIGHT and OUT are folders, their images
are paired in order.)",
    R"(pcl_semantic_synthesize /tmp/street && \
  pcl_semantic_stereo /tmp/street/image_2/000000.png /tmp/street/image_3/000000.png \
    /tmp/street/calib.txt /tmp/pair.pcd --disparity /tmp/disparity.png)"};

struct Options {
  std::string left, right, calibration, extrinsics, output, disparity;
  std::string engine = disparityEngines().front();
  int disparities = 128, threads = 0;
  double max_depth = 80.0, max_deviation = 0.7;
  bool strict = false;
};

Options
parse(int argc, char** argv)
{
  Options options;
  parseCommandLine(
      argc, argv, usage,
      {{"left", options.left, "left image, or folder of images"},
       {"right", options.right, "right image, or folder of images"},
       {"calibration", options.calibration,
        "calibration of the pair: KITTI's or Middlebury's calib.txt, or one of OpenCV, "
        "Kalibr, ROS or EuRoC (.yaml, .yml); the cloud is in the frame of the "
        "rectified "
        "left camera"},
       {"extrinsics", options.extrinsics,
        "file with R and T, if they are not in --calibration (.yaml)"},
       {"output", options.output, "output cloud (.pcd), or output folder"},
       {"disparity", options.disparity,
        "output image of the disparities, or folder (blue = far, red = near)"},
       {"strict", options.strict,
        "reject pairs that look blank, identical, swapped or unrelated instead of "
        "warning"},
       {"stereo", withDefault(options.engine), "stereo engine: sgm, elas or sgbm"},
       {"disparities", withDefault(options.disparities),
        "range of the disparity search, a multiple of 64 (elas, sgbm: 16) [px]"},
       {"max-depth", withDefault(options.max_depth),
        "maximum depth [m]; 0 = unlimited"},
       {"max-deviation", withDefault(options.max_deviation),
        "maximum standard deviation of a disparity [px]; the default keeps matched "
        "pixels, 0 keeps interpolated ones too"},
       {"threads", withDefault(options.threads),
        "number of threads; 0 = all processors"}},
      {"left", "right", "calibration", "output"});
  refuseIf(options.output.empty(), "expected LEFT RIGHT CALIBRATION OUT");
  for (const auto& [name, value] :
       {std::pair("--max-depth", options.max_depth),
        std::pair("--max-deviation", options.max_deviation)})
    refuseIf(!(value >= 0.0), name + (" is " + shown(value)) + ", expected 0 or more");
  return options;
}

// Paths of the outputs of a pair: a cloud and optionally an image.
struct Outputs {
  std::string cloud, picture;
};

std::vector<Outputs>
nameOutputs(const Options& options, const ImagePairSequence& pairs)
{
  if (!isFolder(options.left))
    return {{options.output, options.disparity}};
  std::vector<Outputs> outputs;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const std::string name = fs::path(pairs.leftPath(i)).stem().string();
    outputs.push_back(
        {options.output + "/" + name + ".pcd",
         options.disparity.empty() ? "" : options.disparity + "/" + name + ".png"});
  }
  makeOutputFolder(options.output);
  std::vector<std::string> clouds;
  for (const Outputs& each : outputs)
    clouds.push_back(each.cloud);
  warnOfOtherFiles(options.output, clouds);
  if (!options.disparity.empty())
    makeOutputFolder(options.disparity);
  return outputs;
}

void
requireKindsOfFiles(const Options& options)
{
  const bool folders = isFolder(options.left);
  refuseIf(folders != isFolder(options.right),
           "LEFT and RIGHT have to be two images, or two folders");
  for (const std::string& path : {options.left, options.right})
    if (!isThere(path))
      fail<BadInputException>(path, ": does not exist");
  if (!folders) {
    requireOutput(options.output, ".pcd");
    requireOutput(options.disparity, ".png");
  }
  refuseSameFiles(
      {options.left, options.right, options.calibration, options.extrinsics},
      {options.output, options.disparity});
}

// Returns the fraction of pixels with a depth.
double
processPair(const Options& options, const StereoFrame& frame,
            const StereoCamera& camera, DisparityEstimator& estimator,
            const Outputs& outputs)
{
  DisparityImage image = estimator.estimate(frame.left, frame.right);
  eraseUnsure(image, options.max_deviation);
  if (options.max_depth > 0.0)
    image.disparity.setTo(0.0, image.disparity <
                                   camera.fx * camera.baseline / options.max_depth);
  writeColourCloud(outputs.cloud,
                   *disparityToCloud(image.disparity, frame.left, camera));
  if (!outputs.picture.empty())
    writePng(outputs.picture, drawDisparity(image.disparity, options.disparities));
  return double(cv::countNonZero(image.disparity)) / double(image.disparity.total());
}

int
processPairs(const Options& options)
{
  requireKindsOfFiles(options);
  setNumberOfThreads(options.threads);
  const auto estimator = makeDisparityEstimator(options.engine, options.disparities);
  const ImagePairSequence pairs(
      {options.left, options.right, options.calibration, options.extrinsics, ""});
  warnOf(pairs.doubts());
  const std::vector<Outputs> outputs = nameOutputs(options, pairs);
  double fraction = 0.0;
  {
    PairWatch watch(options.strict, pairs.camera());
    const auto process = [&](std::size_t i) {
      const StereoFrame frame = pairs.frame(i);
      watch.look(frame, pairs.leftPath(i));
      fraction += processPair(options, frame, pairs.camera(), *estimator, outputs[i]);
    };
    forEachStep("stereo", pairs.size(), process, "pairs");
  }
  if (!(fraction > 0.0))
    warn("no pixel has a depth: are the images rectified, and of this calibration "
         "(metres, the size of these images)?");
  printResults({{"clouds", pairs.size()},
                {"width", std::size_t(pairs.camera().width)},
                {"height", std::size_t(pairs.camera().height)},
                {"valid_fraction", fraction / double(pairs.size())},
                {"output", options.output}});
  return exit_done;
}

} // namespace

int
main(int argc, char** argv)
{
  return runWithImages(usage.name, [&] { return processPairs(parse(argc, argv)); });
}
