// SPDX-License-Identifier: BSD-3-Clause
#include "label_arguments.h"

namespace pcl_semantic::tool {

const Usage label_usage{
    "pcl_semantic_label",
    "(SEQUENCE | --left 'L*.png' --right 'R*.png' --calibration FILE.yaml)\n"
    "  --network FILE.yaml --output DIR [options]\n"
    "or --clouds (DIR | CLOUD.pcd) (--network FILE.yaml | --labels (DIR | FILE))\n"
    "  --output (DIR | OUT.pcd) [options]",
    "Runs a segmentation network over the left images and stores the class "
    "distributions\nof their pixels, once for many runs of pcl_semantic_map --labels; "
    "or "
    "gives organized\nclouds of a camera the labels of their pixels, from a network or "
    "stored ones.",
    "pcl_semantic_synthesize /tmp/street && \\\n"
    "  pcl_semantic_stereo /tmp/street/image_2 /tmp/street/image_3 "
    "/tmp/street/calib.txt \\\n"
    "    /tmp/street_clouds && \\\n"
    "  pcl_semantic_label --clouds /tmp/street_clouds --labels /tmp/street/labels \\\n"
    "    --output /tmp/street_labelled"};

namespace {

po::options_description
describeOptions(LabelArguments& arguments)
{
  po::options_description visible("Options");
  addSequenceOptions(arguments.sequence, visible);
  visible.add_options()(
      "clouds", po::value(&arguments.clouds),
      "instead of SEQUENCE: organized clouds, one a frame, as pcl_semantic_stereo "
      "writes them: one .pcd, a folder or a pattern in quotes")(
      "output,o", po::value(&arguments.output),
      "folder to write to; of one cloud: the cloud to write (.pcd)")(
      "network", po::value(&arguments.network), "description of the network (.yaml)")(
      "model", po::value(&arguments.model), "the network itself (.onnx)")(
      "labels", po::value(&arguments.labels),
      "of --clouds: folder of stored label distributions (.bin, .npy or .png a frame), "
      "or the file of one cloud")("label-set", po::value(&arguments.label_set),
                                  "classes of --labels (default: "
                                  "label_sets/kitti11.yaml)")(
      "frames", po::value(&arguments.frames), "A:B, frames numbered A <= n < B");
  addOption(visible, "format", arguments.format,
            "of SEQUENCE: float32 or float16 (.npy, half the size), or ids: the most "
            "probable class only (.png)");
  addOption(visible, "label-confidence", arguments.label_confidence,
            "probability of the class that a stored .png states");
  addOption(visible, "threads", arguments.threads, "0 = all processors");
  return visible;
}

void
requireSequenceAndNetwork(const LabelArguments& arguments)
{
  requireSequence(arguments.sequence, label_usage.name);
  if (!arguments.labels.empty() || !arguments.label_set.empty())
    failUsage(label_usage, "--labels and --label-set are for --clouds");
  if (arguments.output.empty())
    failUsage(label_usage, "--output is missing");
  if (arguments.network.empty())
    failUsage(label_usage, "--network is missing");
  if (arguments.format != "float32" && arguments.format != "float16" &&
      arguments.format != "ids")
    failUsage(label_usage, "--format is '" + arguments.format +
                               "', expected float32, float16 or ids");
}

void
requireClouds(const LabelArguments& arguments, bool has_format)
{
  if (!arguments.sequence.folder.empty() || arguments.sequence.hasFiles() ||
      arguments.sequence.strict)
    failUsage(label_usage, "--clouds and a SEQUENCE, or options of one, exclude each "
                           "other");
  if (arguments.output.empty())
    failUsage(label_usage, "--output is missing");
  if (arguments.labels.empty() == arguments.network.empty())
    failUsage(label_usage, "expected either --labels or --network");
  if (!arguments.model.empty() && arguments.network.empty())
    failUsage(label_usage, "--model needs --network");
  if (!arguments.label_set.empty() && arguments.labels.empty())
    failUsage(label_usage, "--label-set is for --labels; the description of a network "
                           "names its own");
  if (has_format)
    failUsage(label_usage, "--format is for a SEQUENCE: clouds are written as .pcd");
}

} // namespace

bool
parseLabelArguments(int argc, char** argv, LabelArguments& arguments)
{
  const po::options_description visible = describeOptions(arguments);
  po::positional_options_description positional;
  positional.add("sequence", 1);
  po::variables_map values;
  if (!parseCommandLine(argc, argv, label_usage, visible, positional, values))
    return false;
  if (arguments.clouds.empty())
    requireSequenceAndNetwork(arguments);
  else
    requireClouds(arguments, !values["format"].defaulted());
  return true;
}

} // namespace pcl_semantic::tool
