// SPDX-License-Identifier: BSD-3-Clause
#include "image_tool.h"
#include "labels.h"
#include "messages.h"
#include "room_writer.h"
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
    "OUT [--scene street|room] [--frames N] [--size WxH] [options]",
    R"(Renders a procedural street into a folder laid out like a sequence of KITTI's
odometry benchmark, or a furnished room as an RGB-D sequence, with exact poses,
true labels and label distributions as a network would give them.)",
    "pcl_semantic_synthesize /tmp/street --seed 7"};

struct Options {
  std::string output;
  std::string scene = "street";
  int frames = 40;
  std::string size;
  std::string seed = "1";
  int traffic = 0;
  double label_noise = kSyntheticLabelNoise;
  double depth_noise = 1.0;
  std::string lens = "pinhole";

  bool
  isFisheye() const
  {
    return lens == "fisheye";
  }
};

Options
parse(int argc, char** argv)
{
  Options options;
  const auto given = parseCommandLine(
      argc, argv, usage,
      {{"output", required(options.output),
        "output folder, also as the first argument"},
       {"scene", withDefault(options.scene),
        "street (a stereo pair drives) or room (an RGB-D camera makes one turn)"},
       {"frames", withDefault(options.frames),
        "number of frames: 0.85 m apart in a street, equal parts of the turn in a "
        "room"},
       {"size", options.size,
        "size of the images, WIDTHxHEIGHT [px] (default: 620x188, room: 320x240)"},
       {"seed", withDefault(options.seed),
        "random seed of the scene; equal seeds give equal bytes"},
       {"traffic", withDefault(options.traffic),
        "number of driving cars in a street, alternately ahead of the camera in its "
        "lane and oncoming"},
       {"label-noise", withDefault(options.label_noise),
        "fraction of wrong labels, 0 (nearly perfect) to 1"},
       {"depth-noise", withDefault(options.depth_noise),
        "noise of the depths in a room, in multiples of a Kinect's; 0 = exact"},
       {"lens", withDefault(options.lens),
        "pinhole or fisheye (equidistant; without labels, which are those of rectified "
        "images)"}},
      {"output"});
  const bool room = options.scene == "room";
  if (!room && options.scene != "street")
    fail<InvalidParameterException>("--scene is '", options.scene,
                                    "', expected street or room");
  if (!options.isFisheye() && options.lens != "pinhole")
    fail<InvalidParameterException>("--lens is '", options.lens,
                                    "', expected pinhole or fisheye");
  if (options.isFisheye() && !given["label-noise"].defaulted())
    fail<InvalidParameterException>("--label-noise has no effect with --lens fisheye");
  for (const auto& [option, scene] :
       {std::pair("traffic", "street"), std::pair("depth-noise", "room")})
    if (options.scene != scene && !given[option].defaulted())
      fail<InvalidParameterException>("--", option, " is of a ", scene,
                                      ", but the scene is a ", options.scene);
  if (options.size.empty())
    options.size = room ? "320x240" : "620x188";
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

synthetic::Lens
lensOf(const Options& options)
{
  return options.isFisheye() ? synthetic::Lens::fisheye : synthetic::Lens::pinhole;
}

/** \brief Refuses a folder with more frames, which would be read as this sequence's,
 * and one of the other scene, which shares some files. */
void
checkFolder(const Options& options)
{
  const bool is_room = options.scene == "room";
  const std::string longer = options.output + (is_room ? "/rgb/" : "/image_2/") +
                             frameFileName(options.frames, ".png");
  const std::string other = options.output + (is_room ? "/image_2" : "/rgb");
  std::error_code error; // a later write reports the error
  if (std::filesystem::exists(longer, error))
    fail<InvalidParameterException>(longer,
                                    ": is of a longer sequence, expected a new folder");
  // Truth is written for pinhole cameras alone.
  const auto isThere = [&](const char* name) {
    return std::filesystem::exists(options.output + name, error);
  };
  const bool is_other_lens =
      options.isFisheye()
          ? isThere("/gt")
          : (isThere("/camchain.yaml") || isThere("/camera.yaml")) && !isThere("/gt");
  if (is_other_lens)
    fail<InvalidParameterException>(options.output,
                                    ": is of another lens, expected a new folder");
  if (std::filesystem::exists(other, error))
    fail<InvalidParameterException>(other,
                                    ": is of another scene, expected a new folder");
}

void
synthesizeStreet(const Options& options, const cv::Size& size, std::uint32_t seed)
{
  const SyntheticScene scene(seed, options.frames, makeTraffic(options.traffic));
  const synthetic::Lens lens = lensOf(options);
  const SyntheticRenderer renderer(scene, size.width, size.height, lens);
  checkFolder(options);
  const SyntheticWriter writer(options.output, lens);
  forEachStep("rendering", std::size_t(options.frames), [&](std::size_t frame) {
    const SyntheticView view = renderer.render(int(frame));
    if (options.isFisheye())
      return writer.writeImages(view);
    writer.writeFrame(view, syntheticDistributions(view, seed, options.label_noise));
  });
  writer.writeSequence(scene, renderer.camera());
}

void
synthesizeRoom(const Options& options, const cv::Size& size, std::uint32_t seed)
{
  if (!(options.depth_noise >= 0.0 && options.depth_noise <= 100.0))
    fail<InvalidParameterException>("--depth-noise ", options.depth_noise,
                                    ": expected 0 to 100");
  const SyntheticRoom room(seed, options.frames);
  const synthetic::Lens lens = lensOf(options);
  const RoomRenderer renderer(room, size.width, size.height, lens);
  checkFolder(options);
  const RoomWriter writer(options.output, lens);
  forEachStep("rendering", std::size_t(options.frames), [&](std::size_t frame) {
    const RoomView view = renderer.render(int(frame));
    const cv::Mat depth = measuredDepth(view, seed, options.depth_noise);
    if (options.isFisheye())
      return writer.writeImages(view, depth);
    writer.writeFrame(view, depth,
                      syntheticDistributions(view, seed, options.label_noise));
  });
  writer.writeSequence(room, renderer.camera());
}

int
synthesize(const Options& options)
{
  if (!(options.label_noise >= 0.0 && options.label_noise <= 1.0))
    fail<InvalidParameterException>("--label-noise ", options.label_noise,
                                    ": expected 0 to 1");
  const cv::Size size = parseSize(options.size);
  const std::uint32_t seed = parseSeed(options.seed);
  if (options.scene == "room")
    synthesizeRoom(options, size, seed);
  else
    synthesizeStreet(options, size, seed);
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
