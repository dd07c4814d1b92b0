// SPDX-License-Identifier: BSD-3-Clause
#include "clique_frame.h"
#include "messages.h"
#include "parameter_options.h"
#include "tool.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/io/colour_cloud_file.h>
#include <pcl_semantic/io/labelled_cloud_file.h>
#include <pcl_semantic/pipeline/mapper_config.h>

#include <pcl/common/io.h>

namespace {

using namespace pcl_semantic;
namespace po = tool::po;

struct Arguments {
  std::string input, output, method, coloured;
  tool::CliqueFrame frame;
  CliqueParameters parameters;
  int threads = 0;
};

const tool::Usage usage{
    "pcl_semantic_cliques", "IN.pcd OUT.pcd --method METHOD [options]",
    "Groups the points of a cloud that are likely to have one label. OUT.pcd is "
    "IN.pcd\n"
    "with the field clique (0 = none), which pcl_semantic_crf --cliques field takes.\n"
    "Methods: cubes[:SIZE], supervoxel[:SEEDS' DISTANCE], superpixel[:NUMBER] (of a\n"
    "frame, seen in a map), slic[:NUMBER] (of IN.pcd, an organized cloud).",
    "pcl_semantic_synthesize /tmp/street && \\\n"
    "  pcl_semantic_map /tmp/street --labels /tmp/street/labels --crf none \\\n"
    "    --output /tmp/raw_map && \\\n"
    "  pcl_semantic_stereo /tmp/street/image_2/000000.png "
    "/tmp/street/image_3/000000.png \\\n"
    "    /tmp/street/calib.txt /tmp/frame.pcd && \\\n"
    "  pcl_semantic_cliques /tmp/raw_map/map.pcd /tmp/cliques.pcd --method superpixel "
    "\\\n"
    "    --frame /tmp/frame.pcd --pose /tmp/raw_map/trajectory.txt:0 \\\n"
    "    --coloured /tmp/coloured.pcd && \\\n"
    "  pcl_semantic_crf /tmp/cliques.pcd /tmp/grouped.pcd --crf hierarchical \\\n"
    "    --cliques field"};

// All but those that need several frames.
ConfigParameters
parametersOf(Arguments& arguments)
{
  ConfigParameters parameters;
  for (ConfigParameter& parameter : parametersOf(arguments.parameters))
    if (parameter.name != "superpixel_keep")
      parameters.push_back(std::move(parameter));
  return parameters;
}

void
requireFittingOptions(const Arguments& arguments)
{
  const tool::CliqueFrame& frame = arguments.frame;
  if (arguments.output.empty())
    tool::failUsage(usage, "expected IN.pcd OUT.pcd");
  if (arguments.method.empty())
    tool::failUsage(usage, "--method is missing");
  const bool superpixels = arguments.method.rfind("superpixel", 0) == 0;
  if (superpixels && frame.path.empty())
    tool::failUsage(usage, "--method superpixel needs --frame");
  if (!superpixels && (!frame.path.empty() || !frame.pose.empty()))
    tool::failUsage(usage, "--frame and --pose are for --method superpixel");
  if (!frame.calibration.empty() && frame.pose.find(':') == std::string::npos)
    tool::failUsage(usage, "--calibration is for --pose FILE:N");
  tool::requireExtension(arguments.output, ".pcd");
  tool::requireExtension(arguments.coloured, ".pcd");
  tool::refuseSameFiles({arguments.input, frame.path, frame.calibration,
                         frame.pose.substr(0, frame.pose.rfind(':'))},
                        {arguments.output, arguments.coloured});
}

bool
parse(int argc, char** argv, Arguments& arguments)
{
  tool::CliqueFrame& frame = arguments.frame;
  po::options_description options("Options");
  options.add_options()("input", po::value(&arguments.input), "the cloud")(
      "output", po::value(&arguments.output),
      "the cloud to write")("method", po::value(&arguments.method), "see above")(
      "frame", po::value(&frame.path),
      "organized cloud in the camera's frame (.pcd), as of pcl_semantic_stereo")(
      "pose", po::value(&frame.pose),
      "of the frame: 'x y z qx qy qz qw' in the world, or FILE:N, row N of a KITTI "
      "trajectory (default: the VIEWPOINT of --frame, in the axes of IN.pcd)")(
      "calibration", po::value(&frame.calibration),
      "KITTI's calib.txt, if the pose is camera 0's and the frame camera 2's")(
      "coloured", po::value(&arguments.coloured),
      "also writes the points in a colour for each clique, for pcl_viewer (.pcd)");
  ConfigParameters parameters = {
      {"voxel_size", "of the map, for superpixels [m]", &frame.voxel_size},
      {"map_origin", "X,Y,Z, map_origin of the map's summary [m]", &frame.map_origin}};
  for (ConfigParameter& parameter : parametersOf(arguments))
    parameters.push_back(std::move(parameter));
  parameters.push_back({"threads", "0 = all processors", &arguments.threads});
  tool::addParameters(parameters, options);
  po::positional_options_description positional;
  positional.add("input", 1).add("output", 1);
  po::variables_map values;
  if (!tool::parseCommandLine(argc, argv, usage, options, positional, values))
    return false;
  tool::setParameters(values, parameters);
  arguments.parameters.validate();
  requireFittingOptions(arguments);
  return true;
}

// Neighbouring numbers get colours that differ; points in no clique are dark.
void
colourCliques(const std::vector<pcl::PointIndices>& cliques,
              CliqueGenerator::Cloud& cloud)
{
  for (pcl::PointXYZRGB& point : cloud)
    point.r = point.g = point.b = 40;
  std::uint32_t turn = 0;
  for (const pcl::PointIndices& clique : cliques) {
    turn += 0x9E3779B9u; // golden section of a circle
    const double hue = double(turn) / 4294967296.0 * 6.0;
    for (const pcl::index_t i : clique.indices) {
      const auto channel = [&](double offset) {
        const double place = std::fmod(hue + offset, 6.0);
        const double light = std::clamp(std::abs(place - 3.0) - 1.0, 0.0, 1.0);
        return std::uint8_t(60.0 + 195.0 * light);
      };
      pcl::PointXYZRGB& point = cloud[std::size_t(i)];
      point.r = channel(0.0);
      point.g = channel(4.0);
      point.b = channel(2.0);
    }
  }
}

int
group(const Arguments& arguments)
{
  const auto generator = makeCliqueGenerator(arguments.method, arguments.parameters);
  setNumberOfThreads(arguments.threads);
  LabelledCloud read = readLabelledCloud(arguments.input);
  if (generator->usesColour() && !read.has_colour)
    PCL_THROW_EXCEPTION(BadInputException,
                        arguments.input << ": this method needs rgb or rgba");
  CliqueGenerator::Cloud cloud;
  pcl::copyPointCloud(*read.cloud, cloud);
  if (auto* const superpixels = dynamic_cast<SuperpixelCliques*>(generator.get()))
    tool::setFrame(arguments.frame, arguments.input, cloud, *superpixels);
  try {
    read.cliques = generator->generate(cloud);
  }
  catch (const BadInputException& error) { // a generator knows nothing of files
    PCL_THROW_EXCEPTION(BadInputException, arguments.input << ": " << error.what());
  }
  std::size_t members = 0;
  for (const pcl::PointIndices& clique : read.cliques)
    members += clique.indices.size();
  if (members == 0 && !arguments.frame.path.empty() && !cloud.empty())
    PCL_THROW_EXCEPTION(BadInputException,
                        arguments.frame.path
                            << ": sees no voxel of " << arguments.input
                            << ": are --pose, --map-origin and --voxel-size its own?");
  if (!arguments.coloured.empty()) {
    colourCliques(read.cliques, cloud);
    writeColourCloud(arguments.coloured, cloud);
  }
  writeCliques(arguments.output, read);
  tool::printResults({{"cliques", read.cliques.size()},
                      {"members", members},
                      {"points", cloud.size()},
                      {"cloud", arguments.output}});
  return tool::exit_done;
}

} // namespace

int
main(int argc, char** argv)
{
  return tool::run(usage.name, [&] {
    Arguments arguments;
    return parse(argc, argv, arguments) ? group(arguments) : int(tool::exit_done);
  });
}
