// SPDX-License-Identifier: BSD-3-Clause
#include "messages.h"
#include "parameter_options.h"
#include "tool.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/files/clique_file.h>
#include <pcl_semantic/files/label_set_file.h>
#include <pcl_semantic/filters/semantic_crf.h>
#include <pcl_semantic/io/labelled_cloud_file.h>
#include <pcl_semantic/pipeline/mapper_config.h>

#include <algorithm>
#include <cstring>
#include <iostream>
#include <sstream>

namespace {

using namespace pcl_semantic;
namespace po = tool::po;

struct Arguments {
  std::string input, output, label_set, config;
  CRFConfig parameters;

  Arguments()
  {
    parameters.clique_words = "none, field (its field clique), cubes[:SIZE] [m], slic "
                              "(organized clouds), supervoxel[:DISTANCE] [m], or a "
                              "file of lists of indices";
  }
};

const tool::Usage usage{
    "pcl_semantic_crf", "IN.pcd OUT.pcd [options]",
    "Makes the labels of a cloud consistent with a CRF. IN.pcd has the fields x y z,\n"
    "probability (one a class) or label (0 = unlabelled), and, for kernels of colour,\n"
    "rgb or rgba. OUT.pcd is the same with label and probability rewritten.",
    "pcl_semantic_synthesize /tmp/street && \\\n"
    "  pcl_semantic_map /tmp/street --labels /tmp/street/labels --crf none \\\n"
    "    --output /tmp/raw_map && \\\n"
    "  pcl_semantic_crf /tmp/raw_map/map.pcd /tmp/refined.pcd --crf hierarchical \\\n"
    "    --cliques cubes:1"};

bool
parse(int argc, char** argv, Arguments& arguments)
{
  bool print_config = false;
  po::options_description options("Options");
  options.add_options()("input", po::value(&arguments.input), "labelled input cloud")(
      "output", po::value(&arguments.output), "output cloud")(
      "label-set", po::value(&arguments.label_set),
      "label set (YAML), if the labels do not show the number of classes")(
      "config", po::value(&arguments.config),
      "parameter file (.yaml); options override it")(
      "print-config", po::bool_switch(&print_config),
      "print the effective parameters as YAML and exit");
  tool::addParameters(parametersOf(arguments.parameters), options);
  po::positional_options_description positional;
  positional.add("input", 1).add("output", 1);
  po::variables_map values;
  if (!tool::parseCommandLine(argc, argv, usage, options, positional, values))
    return false;
  readCRFConfig(arguments.config, arguments.parameters);
  tool::setParameters(values, parametersOf(arguments.parameters));
  arguments.parameters.validate();
  if (print_config)
    std::cout << printParameters(parametersOf(arguments.parameters));
  return !print_config;
}

using Filter = SemanticCRF<pcl::PointXYZRGBL>;

void
setCliques(const std::string& cliques, const Arguments& arguments,
           const LabelledCloud& input, Filter& crf)
{
  if (cliques == "none")
    return;
  if (cliques == "field" && input.table.find("clique") < 0)
    PCL_THROW_EXCEPTION(BadInputException,
                        arguments.input << ": has no field 'clique'");
  if (cliques == "field")
    crf.setCliques(input.cliques);
  else if (namesCloudCliques(cliques))
    crf.setCliqueGenerator(makeCliqueGenerator(cliques));
  else
    crf.setCliques(readCliques(cliques, input.cloud->size()));
}

void
setMeasurements(const Arguments& arguments, const LabelledCloud& input, Filter& crf)
{
  const int found = input.distributions.classes();
  int classes = found;
  if (!arguments.label_set.empty())
    classes = readLabelSet(arguments.label_set).size();
  else if (found == 0)
    for (const pcl::PointXYZRGBL& point : *input.cloud)
      classes = std::max({classes, 1, int(point.label)});
  if (found == 0 && !input.has_labels)
    PCL_THROW_EXCEPTION(BadInputException,
                        arguments.input << ": has no field 'label' or 'probability'");
  if (found > 0 && found != classes)
    PCL_THROW_EXCEPTION(BadInputException, arguments.input
                                               << ": has probabilities of " << found
                                               << " classes, expected " << classes);
  if (found > 0)
    crf.setLabelDistributions(input.distributions);
  else
    crf.setLabelConfidence(arguments.parameters.label_confidence, std::max(1, classes));
}

// A map says how certain it is of each voxel.
void
setEntropies(LabelledCloud& cloud)
{
  if (cloud.table.find("entropy") < 0)
    return;
  std::vector<std::uint8_t> bytes(cloud.cloud->size() * sizeof(float));
  for (std::size_t i = 0; i < cloud.cloud->size(); ++i) {
    const float entropy = cloud.distributions.entropy(Eigen::Index(i));
    std::memcpy(&bytes[i * sizeof(float)], &entropy, sizeof(float));
  }
  cloud.table.setColumn({"entropy", 'F', 4, 1}, bytes);
}

// Runs the filter over the cloud, and says what became of it.
tool::Results
filter(const Arguments& arguments, LabelledCloud& input)
{
  Filter crf;
  crf.setModel(arguments.parameters.model);
  crf.setParameters(arguments.parameters.parameters);
  setCliques(arguments.parameters.cliques, arguments, input, crf);
  setMeasurements(arguments, input, crf);
  crf.setUseColour(input.has_colour);
  crf.setInputCloud(input.cloud);
  try {
    crf.filter(*input.cloud);
  }
  catch (const BadInputException& error) { // a cloud knows nothing of its file
    PCL_THROW_EXCEPTION(BadInputException, arguments.input << ": " << error.what());
  }
  input.distributions = crf.getLabelDistributions();
  const CRFReport& report = crf.getReport();
  return {{"points", input.cloud->size()},
          {"without_place", crf.getSkippedPoints()},
          {"without_measurement", report.unlabelled},
          {"cliques", report.cliques},
          {"cliques_without_points", report.skipped_cliques},
          {"updates", std::size_t(report.updates)},
          {"cloud", arguments.output}};
}

int
refine(const Arguments& arguments)
{
  if (arguments.output.empty())
    tool::failUsage(usage, "expected IN.pcd OUT.pcd");
  const CRFConfig& config = arguments.parameters;
  tool::refuseSameFiles(
      {arguments.input, arguments.config, arguments.label_set, config.cliques},
      {arguments.output});
  config.requireFittingCliques();
  setNumberOfThreads(config.threads);
  LabelledCloud cloud = readLabelledCloud(arguments.input);
  const tool::Results report = filter(arguments, cloud);
  setEntropies(cloud);
  writeLabelledCloud(arguments.output, cloud);
  tool::printResults(report);
  return tool::exit_done;
}

} // namespace

int
main(int argc, char** argv)
{
  return tool::run(usage.name, [&] {
    Arguments arguments;
    return parse(argc, argv, arguments) ? refine(arguments) : int(tool::exit_done);
  });
}
