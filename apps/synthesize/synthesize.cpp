// SPDX-License-Identifier: BSD-3-Clause
#include "image_tool.h"
#include "labels.h"
#include "messages.h"
#include "tool.h"
#include "writer.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/input_file.h>

#include <cstdio>
#include <filesystem>

using namespace pcl_semantic;
using namespace pcl_semantic::tool;

namespace {

const Usage usage{
    "pcl_semantic_synthesize",
    "OUT [--frames N] [--size WxH] [--seed S] [--traffic N] [options]",
    R"(Renders a procedural street into a folder laid out like a sequence of KITTI's
odometry benchmark, with true disparity, true labels and label distributions as
a network would give them.)",
    "pcl_semantic_synthesize /tmp/street --seed 7"};

struct Options {
  std::string output;
  int frames = 40;
  std::string size = "620x188";
  std::string seed = "1";
  int traffic = 0;
  double label_noise = kSyntheticLabelNoise;
};

Options
parse(int argc, char** argv)
{
  Options options;
  parseCommandLine(
      argc, argv, usage,
      {{"output", required(options.output),
        "output folder, also as the first argument"},
       {"frames", withDefault(options.frames), "number of frames, 0.85 m apart"},
       {"size", withDefault(options.size), "size of the images, WIDTHxHEIGHT [px]"},
       {"seed", withDefault(options.seed),
        "random seed of the street; equal seeds give equal bytes"},
       {"traffic", withDefault(options.traffic),
        "number of driving cars, alternately ahead of the camera in its lane and "
        "oncoming"},
       {"label-noise", withDefault(options.label_noise),
        "fraction of wrong labels, 0 (nearly perfect) to 1"}},
      {"output"});
  return options;
}

cv::Size
parseSize(const std::string& text)
{
  int width = 0;
  int height = 0;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%5dx%5d%c", &width, &height, &rest) != 2)
    fail<InvalidParameterException>("--size ", text,
                                    ": expected WIDTHxHEIGHT, as in 620x188");
  return {width, height};
}

/** \brief Accepts only digits: a stream would read -1 as 4294967295. */
std::uint32_t
parseSeed(const std::string& text)
{
  const bool digits = !text.empty() && text.size() <= 10 &&
                      text.find_first_not_of("0123456789") == std::string::npos;
  const std::uint64_t seed = digits ? std::stoull(text) : UINT64_MAX;
  if (seed > UINT32_MAX)
    fail<InvalidParameterException>("--seed ", text, ": expected a number from 0 to ",
                                    UINT32_MAX);
  return static_cast<std::uint32_t>(seed);
}

int
synthesize(const Options& options)
{
  if (!(options.label_noise >= 0.0 && options.label_noise <= 1.0))
    fail<InvalidParameterException>("--label-noise ", options.label_noise,
                                    ": expected 0 to 1");
  const cv::Size size = parseSize(options.size);
  const std::uint32_t seed = parseSeed(options.seed);
  const SyntheticScene scene(seed, options.frames, makeTraffic(options.traffic));
  const SyntheticRenderer renderer(scene, size.width, size.height);
  const std::string longer =
      options.output + "/image_2/" + frameFileName(options.frames, ".png");
  std::error_code error; // a later write reports the error
  if (std::filesystem::exists(longer, error))
    fail<InvalidParameterException>(longer,
                                    ": is of a longer sequence, expected a new folder");
  const SyntheticWriter writer(options.output);
  forEachStep("rendering", std::size_t(options.frames), [&](std::size_t frame) {
    const SyntheticView view = renderer.render(int(frame));
    writer.writeFrame(view, syntheticDistributions(view, seed, options.label_noise));
  });
  writer.writeSequence(scene, renderer.camera());
  printResults({{"frames", std::size_t(options.frames)},
                {"width", std::size_t(size.width)},
                {"height", std::size_t(size.height)},
                {"sequence", options.output}});
  return exit_done;
}

} // namespace

int
main(int argc, char** argv)
{
  return runWithImages(usage.name, [&] { return synthesize(parse(argc, argv)); });
}
