/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "messages.h"
#include "pair_watch.h"
#include "progress_bar.h"
#include "sequence_options.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/files/distribution_file.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/files/label_set_file.h>
#include <pcl_semantic/labelling/network_predictor.h>

#include <filesystem>

using namespace pcl_semantic;

namespace {

namespace fs = std::filesystem;

const tool::Usage usage{
    "pcl_semantic_label",
    "(SEQUENCE | --left 'L*.png' --right 'R*.png' --calibration FILE.yaml)\n"
    "  --network FILE.yaml --output DIR [options]",
    "Runs a segmentation network over the left images and stores the class "
    "distributions\nof their pixels, once for many runs of pcl_semantic_map --labels.",
    "pcl_semantic_synthesize /tmp/street && \\\n"
    "  pcl_semantic_label /tmp/street --output /tmp/street_labels \\\n"
    "    --network data/networks/espnetv2_city_1280x480.yaml --model city.onnx"};

struct Options {
  tool::SequenceOptions sequence;
  std::string output, network, model;
  std::string frames = ":";
  std::string format = "float32";
  int threads = 0;
};

bool
parseOptions(int argc, char** argv, Options& options)
{
  namespace po = tool::po;
  po::options_description visible("Options");
  tool::addSequenceOptions(options.sequence, visible);
  visible.add_options()("output,o", po::value(&options.output), "folder to write to")(
      "network", po::value(&options.network), "description of the network (.yaml)")(
      "model", po::value(&options.model), "the network itself (.onnx)")(
      "frames", po::value(&options.frames), "A:B, frames numbered A <= n < B");
  tool::addOption(visible, "format", options.format,
                  "float32 or float16 (.npy, half the size), or ids: the most probable "
                  "class only (.png)");
  tool::addOption(visible, "threads", options.threads, "0 = all processors");
  po::positional_options_description positional;
  positional.add("sequence", 1);
  po::variables_map values;
  if (!tool::parseCommandLine(argc, argv, usage, visible, positional, values))
    return false;
  tool::requireSequence(options.sequence, usage.name);
  if (options.output.empty())
    tool::failUsage(usage, "--output is missing");
  if (options.network.empty())
    tool::failUsage(usage, "--network is missing");
  if (options.format != "float32" && options.format != "float16" &&
      options.format != "ids")
    tool::failUsage(usage, "--format is '" + options.format +
                               "', expected float32, float16 or ids");
  return true;
}

// Images and scans bear the names of what is written here, and a frame must not have
// two files of labels.
void
refuseOtherFiles(const Options& options, const std::string& extension)
{
  std::error_code error;
  const ImagePairFiles& files = options.sequence.files;
  std::vector<fs::path> images = {fs::path(files.left).parent_path(),
                                  fs::path(files.right).parent_path()};
  for (const char* name : {"image_0", "image_1", "image_2", "image_3"})
    images.push_back(fs::path(options.sequence.folder) / name);
  for (const fs::path& folder : images)
    if (fs::equivalent(folder, options.output, error))
      tool::failUsage(usage, "--output " + options.output + ": holds images");
  if (!fs::is_directory(options.output, error))
    return;
  for (const FrameFile& file : listFrameFiles(options.output, {".bin", ".npy", ".png"}))
    if (fs::path(file.path).extension() != extension)
      tool::failUsage(usage, "--output holds " + file.path + ", where only " +
                                 extension + " files would be written");
}

void
writeLabels(const Options& options, int frame, int width,
            const LabelDistributions& distributions)
{
  const std::string path = options.output + "/";
  if (options.format == "ids")
    writeLabelIds(path + frameFileName(frame, ".png"), distributions, width);
  else
    writeDistributions(path + frameFileName(frame, ".npy"), distributions, width,
                       options.format == "float16" ? NpyType::float16
                                                   : NpyType::float32);
}

int
labelSequence(const Options& options)
{
  refuseOtherFiles(options, options.format == "ids" ? ".png" : ".npy");
  setNumberOfThreads(options.threads);
  const NetworkDescription network = readNetworkDescription(options.network);
  const LabelSet label_set = readLabelSet(network.label_set_path);
  const auto sequence = tool::openSequence(options.sequence);
  const auto frames = tool::chooseFrames(options.sequence, *sequence, options.frames);
  NetworkPredictor predictor(network, label_set, options.model);
  makeOutputFolder(options.output);
  tool::catchInterrupts();
  {
    tool::PairWatch watch(usage.name, options.sequence.strict);
    tool::ProgressBar progress("labelling", frames.size());
    for (const std::size_t i : frames) {
      const StereoFrame frame = sequence->frame(i);
      watch.look(frame);
      writeLabels(options, frame.number, frame.left.cols, predictor.predict(frame));
      if (tool::interrupted())
        return tool::exit_interrupted;
      progress.step();
    }
  }
  tool::printResults({{"frames", frames.size()},
                      {"classes", std::size_t(label_set.size())},
                      {"label_set", network.label_set_path},
                      {"labels", options.output}});
  return tool::exit_done;
}

} // namespace

int
main(int argc, char** argv)
{
  return tool::run(usage.name, [&] {
    Options options;
    return parseOptions(argc, argv, options) ? labelSequence(options)
                                             : int(tool::exit_done);
  });
}
