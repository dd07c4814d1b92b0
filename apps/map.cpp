/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "parameter_options.h"
#include "tool.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/dataset/frame_range.h>
#include <pcl_semantic/dataset/kitti_sequence.h>
#include <pcl_semantic/files/data_folder.h>
#include <pcl_semantic/files/label_set_file.h>
#include <pcl_semantic/labelling/network_predictor.h>
#include <pcl_semantic/labelling/stored_predictor.h>
#include <pcl_semantic/odometry/trajectory_poses.h>
#include <pcl_semantic/pipeline/mapping_output.h>
#include <pcl_semantic/pipeline/semantic_mapper.h>

#include <filesystem>
#include <iostream>

namespace {

using namespace pcl_semantic;
namespace po = boost::program_options;

struct Arguments {
  std::string sequence, output, labels, label_set, network, model, poses, config;
  std::string frames = ":";
  bool print_config = false;
  MapperConfig parameters;
};

// Options of the tool itself; those of MapperConfig come from its own list.
po::options_description
describeOptions(Arguments& arguments)
{
  po::options_description options("Options");
  options.add_options()("sequence", po::value(&arguments.sequence),
                        "folder in KITTI's odometry layout")(
      "output", po::value(&arguments.output),
      "folder to write to; an earlier map in it is replaced")(
      "labels", po::value(&arguments.labels),
      "folder of stored label distributions: .bin, .npy or .png a frame")(
      "label-set", po::value(&arguments.label_set),
      "classes of --labels (default: label_sets/kitti11.yaml)")(
      "network", po::value(&arguments.network), "description of a network (.yaml)")(
      "model", po::value(&arguments.model), "the network itself (.onnx)")(
      "poses", po::value(&arguments.poses)->default_value("sequence"),
      "KITTI trajectory file, or 'sequence' for its own poses.txt")(
      "frames", po::value(&arguments.frames),
      "A:B, frames numbered A <= n < B")("config", po::value(&arguments.config),
                                         "parameters as YAML; options override it")(
      "print-config", po::bool_switch(&arguments.print_config),
      "print the effective parameters as YAML and end");
  return options;
}

bool
parseArguments(int argc, char** argv, Arguments& arguments)
{
  po::options_description options = describeOptions(arguments);
  tool::addParameters(parametersOf(arguments.parameters), options);
  po::variables_map values;
  const tool::Usage usage{
      "pcl_semantic_map",
      "SEQUENCE --output DIR (--labels DIR | --network FILE.yaml) [options]",
      "Maps a stereo sequence: writes a labelled voxel map, the classes as the camera\n"
      "sees them in it, pictures and a summary. Defaults of the parameters are shown.",
      "pcl_semantic_synthesize /tmp/street && \\\n"
      "  pcl_semantic_map /tmp/street --labels /tmp/street/labels --output /tmp/map"};
  po::positional_options_description positional;
  positional.add("sequence", 1);
  if (!tool::parseCommandLine(argc, argv, usage, options, positional, values))
    return false;
  readMapperConfig(arguments.config, arguments.parameters);
  tool::setParameters(values, parametersOf(arguments.parameters));
  arguments.parameters.validate();
  return true;
}

void
requireArguments(const Arguments& arguments)
{
  const auto fail = [](const char* message) {
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        message << " (see pcl_semantic_map --help)");
  };
  if (arguments.sequence.empty())
    fail("the SEQUENCE is missing");
  if (arguments.output.empty())
    fail("--output is missing");
  if (arguments.labels.empty() == arguments.network.empty())
    fail("expected either --labels or --network");
  if (!arguments.model.empty() && arguments.network.empty())
    fail("--model needs --network");
  if (!arguments.label_set.empty() && arguments.labels.empty())
    fail("--label-set is for --labels; the description of a network names its own");
  std::error_code error;
  if (std::filesystem::exists(arguments.output + "/calib.txt", error))
    fail("--output holds a sequence (calib.txt); maps need a folder of their own");
  if (std::filesystem::equivalent(arguments.labels, arguments.output + "/labels",
                                  error))
    fail("--labels is where --output puts its own labels");
}

struct Labelling {
  LabelSet label_set;
  std::unique_ptr<LabelPredictor> predictor;
};

Labelling
makeLabelling(const Arguments& arguments)
{
  if (!arguments.network.empty()) {
    const NetworkDescription network = readNetworkDescription(arguments.network);
    const LabelSet label_set = readLabelSet(network.label_set_path);
    return {label_set,
            std::make_unique<NetworkPredictor>(network, label_set, arguments.model)};
  }
  const LabelSet label_set =
      readLabelSet(arguments.label_set.empty() ? findDataFile("label_sets/kitti11.yaml")
                                               : arguments.label_set);
  return {label_set, std::make_unique<StoredPredictor>(
                         arguments.labels, label_set.size(),
                         float(arguments.parameters.label_confidence))};
}

std::unique_ptr<PoseSource>
makePoses(const Arguments& arguments, const KittiSequence& sequence)
{
  const std::string path =
      arguments.poses == "sequence" ? sequence.posesPath() : arguments.poses;
  if (path.empty())
    PCL_THROW_EXCEPTION(BadInputException,
                        arguments.sequence
                            << ": has no poses.txt; give a trajectory with --poses");
  return std::make_unique<TrajectoryPoses>(readKittiTrajectory(path),
                                           sequence.T_camera0_camera(), path);
}

int
mapSequence(const Arguments& arguments)
{
  requireArguments(arguments);
  setNumberOfThreads(arguments.parameters.threads);
  const KittiSequence sequence(arguments.sequence);
  const std::vector<std::size_t> frames =
      selectFrames(sequence, parseFrameRange(arguments.frames));
  if (frames.empty())
    PCL_THROW_EXCEPTION(BadInputException,
                        arguments.sequence << ": has no frame in " << arguments.frames);
  Labelling labelling = makeLabelling(arguments);
  std::unique_ptr<PoseSource> poses = makePoses(arguments, sequence);
  SemanticMapper mapper(sequence.camera(), labelling.label_set, arguments.parameters,
                        std::move(labelling.predictor), std::move(poses));
  MappingOutput output(arguments.output, sequence.camera(), labelling.label_set,
                       arguments.parameters, sequence.T_camera0_camera(),
                       {{"sequence", arguments.sequence},
                        {"frames", arguments.frames},
                        {"poses", arguments.poses},
                        {"labels", arguments.labels},
                        {"label_set", arguments.label_set},
                        {"network", arguments.network},
                        {"model", arguments.model}});
  tool::catchInterrupts();
  tool::ProgressBar progress("mapping", frames.size());
  for (const std::size_t i : frames) {
    output.writeFrame(mapper.process(sequence.frame(i)), mapper.map());
    progress.step();
    if (tool::interrupted())
      break;
  }
  mapper.finish();
  output.finish(mapper.map());
  std::cout << "map:      " << arguments.output << "/map.pcd\n"
            << "pictures: " << arguments.output << "/top_view.png, " << arguments.output
            << "/overlay\nfigures:  " << arguments.output << "/summary.json\n";
  return tool::interrupted() ? tool::exit_interrupted : tool::exit_done;
}

} // namespace

int
main(int argc, char** argv)
{
  return tool::run("pcl_semantic_map", [&] {
    Arguments arguments;
    if (!parseArguments(argc, argv, arguments))
      return int(tool::exit_done);
    if (arguments.print_config) {
      std::cout << printMapperConfig(arguments.parameters);
      return int(tool::exit_done);
    }
    return mapSequence(arguments);
  });
}
