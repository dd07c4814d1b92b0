// SPDX-License-Identifier: BSD-3-Clause
#include "messages.h"
#include "tool.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/dataset/synthetic_labels.h>
#include <pcl_semantic/dataset/synthetic_writer.h>
#include <pcl_semantic/files/input_file.h>

#include <cstdio>
#include <filesystem>

using namespace pcl_semantic;

namespace {

/** \brief Options of the program with their defaults. */
struct Options {
  std::string output;
  int frames = 40;
  std::string size = "620x188";
  std::string seed = "1";
  double label_noise = kSyntheticLabelNoise;
};

bool
parseOptions(int argc, char** argv, Options& options)
{
  namespace po = tool::po;
  po::options_description visible("Options");
  const auto add = [&visible](const char* name, auto& value, const char* text) {
    using T = std::decay_t<decltype(value)>;
    visible.add_options()(name, po::value<T>(&value)->default_value(value), text);
  };
  visible.add_options()("output", po::value<std::string>(&options.output)->required(),
                        "folder to write, also as the first argument");
  add("frames", options.frames, "number of frames, 0.85 m apart");
  add("size", options.size, "size of the images, WIDTHxHEIGHT [px]");
  add("seed", options.seed, "number of the street; the same seed gives the same bytes");
  add("label-noise", options.label_noise,
      "fraction of wrong labels, 0 (nearly perfect) to 1");
  po::positional_options_description positional;
  positional.add("output", 1);
  const tool::Usage usage{
      "pcl_semantic_synthesize",
      "OUT [--frames N] [--size WxH] [--seed S] [--label-noise P]",
      "Renders a procedural street into a folder laid out like a sequence of KITTI's\n"
      "odometry benchmark, with true disparity, true labels and label distributions "
      "as\n"
      "a network would give them.",
      "pcl_semantic_synthesize /tmp/street --seed 7"};
  po::variables_map values;
  return tool::parseCommandLine(argc, argv, usage, visible, positional, values);
}

cv::Size
parseSize(const std::string& text)
{
  int width = 0;
  int height = 0;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%5dx%5d%c", &width, &height, &rest) != 2)
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "--size " << text << ": expected WIDTHxHEIGHT, as in 620x188");
  return {width, height};
}

/** \brief Only digits: a stream would take -1 for 4294967295. */
std::uint32_t
parseSeed(const std::string& text)
{
  const bool digits = !text.empty() && text.size() <= 10 &&
                      text.find_first_not_of("0123456789") == std::string::npos;
  const std::uint64_t seed = digits ? std::stoull(text) : UINT64_MAX;
  if (seed > UINT32_MAX)
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "--seed " << text << ": expected a number from 0 to "
                                  << UINT32_MAX);
  return static_cast<std::uint32_t>(seed);
}

int
synthesize(int argc, char** argv)
{
  Options options;
  if (!parseOptions(argc, argv, options))
    return tool::exit_done;
  if (!(options.label_noise >= 0.0 && options.label_noise <= 1.0))
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "--label-noise " << options.label_noise << ": expected 0 to 1");
  const cv::Size size = parseSize(options.size);
  const std::uint32_t seed = parseSeed(options.seed);
  const SyntheticScene scene(seed, options.frames);
  const SyntheticRenderer renderer(scene, size.width, size.height);
  const std::string longer =
      options.output + "/image_2/" + frameFileName(options.frames, ".png");
  if (std::filesystem::exists(longer))
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        longer << ": is of a longer sequence, expected a new folder");
  const SyntheticWriter writer(options.output);
  tool::catchInterrupts();
  {
    tool::ProgressBar bar("rendering", options.frames);
    for (int frame = 0; frame < options.frames; ++frame) {
      const SyntheticView view = renderer.render(frame);
      writer.writeFrame(view, syntheticDistributions(view, seed, options.label_noise));
      if (tool::interrupted())
        return tool::exit_interrupted;
      bar.step();
    }
  }
  writer.writeSequence(scene, renderer.camera());
  tool::printResults({{"frames", std::size_t(options.frames)},
                      {"width", std::size_t(size.width)},
                      {"height", std::size_t(size.height)},
                      {"sequence", options.output}});
  return tool::exit_done;
}

} // namespace

int
main(int argc, char** argv)
{
  return tool::run("pcl_semantic_synthesize", [&] { return synthesize(argc, argv); });
}
