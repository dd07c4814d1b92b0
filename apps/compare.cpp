// SPDX-License-Identifier: BSD-3-Clause
#include "messages.h"
#include "tool.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/files/image_file.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/io/label_comparison.h>

#include <filesystem>

namespace {

using namespace pcl_semantic;
namespace fs = std::filesystem;

const tool::Usage usage{
    "pcl_semantic_compare", "--image I --labels A B ... --output OUT [options]",
    "Draws label images of one frame below each other, and beside each where it\n"
    "differs from the one above: green where a change is right, red where it is\n"
    "wrong, in the colour of the new class where there is no ground truth. Given\n"
    "folders, draws one figure for each frame.",
    "pcl_semantic_synthesize /tmp/street && \\\n"
    "  pcl_semantic_map /tmp/street --labels /tmp/street/labels --output /tmp/map && "
    "\\\n"
    "  pcl_semantic_compare --image /tmp/street/image_2 \\\n"
    "    --labels /tmp/map/network_labels /tmp/map/labels --names \"2D network,map\" "
    "\\\n"
    "    --truth /tmp/street/gt --output /tmp/figures"};

struct Arguments {
  std::string image, names, truth, label_set, output;
  std::vector<std::string> labels;
  int width = 1920;
  bool small = false;
};

bool
isFolder(const std::string& path)
{
  std::error_code error;
  return fs::is_directory(path, error);
}

void
validate(const Arguments& arguments)
{
  tool::refuseIf(arguments.image.empty() || arguments.labels.empty() ||
                     arguments.output.empty(),
                 "--image, --labels or --output is missing");
  tool::refuseIf(arguments.width < 320 || arguments.width > 16384,
                 "--width is " + std::to_string(arguments.width) +
                     ", expected 320 to 16384");
  std::vector<std::string> inputs = arguments.labels;
  inputs.insert(inputs.end(), {arguments.image, arguments.truth, arguments.label_set});
  tool::refuseSameFiles(inputs, {arguments.output});
  for (const std::string& input : inputs)
    tool::refuseIf(!input.empty() && input != arguments.label_set &&
                       isFolder(input) != isFolder(arguments.image),
                   input + " and " + arguments.image +
                       ": expected two files or two folders");
  if (!isFolder(arguments.image))
    tool::requireOutput(arguments.output, ".png");
}

Arguments
parse(int argc, char** argv)
{
  Arguments arguments;
  tool::parseCommandLine(
      argc, argv, usage,
      {{"image", arguments.image, "image, or folder of them"},
       {"labels", tool::po::value(&arguments.labels)->multitoken(),
        "label images (8 bit, 0 = none) or folders of them, in the order of their "
        "making"},
       {"names", arguments.names,
        "what they are called, with commas between; default: their files"},
       {"truth", arguments.truth,
        "ground truth image or folder, 0 = not known; a folder need not have all "
        "frames"},
       {"label-set", arguments.label_set,
        "classes (YAML); default: the eleven of KITTI"},
       {"output,o", arguments.output, "figure (.png), or folder of figures"},
       {"small", arguments.small, "half the bytes, in fewer shades of colour"},
       {"width", tool::withDefault(arguments.width), "of a figure [px]"}});
  validate(arguments);
  return arguments;
}

std::vector<std::string>
namesOf(const Arguments& arguments)
{
  std::vector<std::string> names = tool::splitAtCommas(arguments.names);
  if (arguments.names.empty())
    for (const std::string& path : arguments.labels) {
      const fs::path whole = fs::path(path).lexically_normal();
      names.push_back((whole.has_filename() ? whole : whole.parent_path()).stem());
    }
  tool::refuseIf(names.size() != arguments.labels.size(),
                 "--names has " + std::to_string(names.size()) + " names for " +
                     std::to_string(arguments.labels.size()) + " --labels");
  return names;
}

/** \brief Makes one figure. \param[in] file name within the folders; empty: they are
 * files themselves */
void
drawFigure(const Arguments& arguments, const std::vector<std::string>& names,
           const LabelSet& label_set, const std::string& file)
{
  const std::string below = file.empty() ? "" : "/" + file;
  const cv::Mat image = readPng(arguments.image + below, ImageKind::grey_or_colour);
  std::vector<NamedLabels> labels;
  for (std::size_t i = 0; i < names.size(); ++i)
    labels.push_back(
        {names[i], readPng(arguments.labels[i] + below, ImageKind::labels)});
  cv::Mat truth;
  if (!arguments.truth.empty() && (file.empty() || fs::exists(arguments.truth + below)))
    truth = readPng(arguments.truth + below, ImageKind::labels);
  cv::Mat figure;
  try {
    figure = drawLabelComparison(image, labels, truth, label_set, arguments.width);
  }
  catch (const InvalidParameterException& error) { // the fault of the images
    badInput(arguments.image, below, ": ", error.what());
  }
  (arguments.small ? writeSmallPng : writePng)(arguments.output + below, figure);
}

int
compare(const Arguments& arguments)
{
  const std::vector<std::string> names = namesOf(arguments);
  const LabelSet label_set = tool::readLabelSetOrDefault(arguments.label_set);
  if (!isFolder(arguments.image)) {
    drawFigure(arguments, names, label_set, "");
    tool::printResults({{"figure", arguments.output}});
    return tool::exit_done;
  }
  const std::vector<FrameFile> frames =
      listFrameFiles(arguments.labels.front(), {".png"});
  if (frames.empty())
    badInput(arguments.labels.front(),
             ": holds no label images, expected 000000.png ...");
  makeOutputFolder(arguments.output);
  tool::ProgressBar progress("drawing", frames.size());
  for (const FrameFile& frame : frames) {
    drawFigure(arguments, names, label_set, fs::path(frame.path).filename());
    progress.step();
  }
  tool::printResults({{"figures", arguments.output}});
  return tool::exit_done;
}

} // namespace

int
main(int argc, char** argv)
{
  return tool::run(usage.name, [&] { return compare(parse(argc, argv)); });
}
