// SPDX-License-Identifier: BSD-3-Clause
#include "label_arguments.h"
#include "messages.h"
#include "pair_watch.h"
#include "progress_bar.h"

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

using tool::LabelArguments;

// Images and scans bear the names of what is written here, and a frame must not have
// two files of labels.
void
refuseOtherFiles(const LabelArguments& options, const std::string& extension)
{
  std::error_code error;
  const ImagePairFiles& files = options.sequence.files;
  std::vector<fs::path> images = {fs::path(files.left).parent_path(),
                                  fs::path(files.right).parent_path()};
  for (const char* name : {"image_0", "image_1", "image_2", "image_3"})
    images.push_back(fs::path(options.sequence.folder) / name);
  for (const fs::path& folder : images)
    if (fs::equivalent(folder, options.output, error))
      tool::failUsage(tool::label_usage,
                      "--output " + options.output + ": holds images");
  if (!fs::is_directory(options.output, error))
    return;
  for (const FrameFile& file : listFrameFiles(options.output, {".bin", ".npy", ".png"}))
    if (fs::path(file.path).extension() != extension)
      tool::failUsage(tool::label_usage, "--output holds " + file.path +
                                             ", where only " + extension +
                                             " files would be written");
}

void
writeLabels(const LabelArguments& options, int frame, int width,
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
labelSequence(const LabelArguments& options)
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
    tool::PairWatch watch(tool::label_usage.name, options.sequence.strict);
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
  return tool::run(tool::label_usage.name, [&] {
    LabelArguments arguments;
    if (!tool::parseLabelArguments(argc, argv, arguments))
      return int(tool::exit_done);
    return arguments.clouds.empty() ? labelSequence(arguments)
                                    : tool::labelClouds(arguments);
  });
}
