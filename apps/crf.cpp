/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "labelled_table.h"
#include "parameter_options.h"
#include "tool.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/files/clique_file.h>
#include <pcl_semantic/files/label_set_file.h>
#include <pcl_semantic/files/pcd_file.h>
#include <pcl_semantic/filters/semantic_crf.h>
#include <pcl_semantic/pipeline/crf_config.h>

#include <pcl/common/io.h>

#include <iostream>
#include <sstream>

namespace {

using namespace pcl_semantic;
namespace po = tool::po;

struct Arguments {
  std::string input, output, label_set, config;
  bool print_config = false;
  CRFConfig parameters;

  Arguments()
  {
    parameters.clique_words = "none, field (its field clique), cubes:SIZE [m], slic "
                              "(organized clouds), or a file of lists of indices";
  }
};

const tool::Usage usage{
    "pcl_semantic_crf", "IN.pcd OUT.pcd [options]",
    "Makes the labels of a cloud consistent with a CRF. IN.pcd has the fields x y z "
    "and\n"
    "probability (one a class) or label (0 = unlabelled); with rgb or rgba, colours\n"
    "count too. OUT.pcd is the same with label and probability rewritten.",
    "pcl_semantic_synthesize /tmp/street && \\\n"
    "  pcl_semantic_map /tmp/street --labels /tmp/street/labels --crf none \\\n"
    "    --output /tmp/raw_map && \\\n"
    "  pcl_semantic_crf /tmp/raw_map/map.pcd /tmp/refined.pcd --model hierarchical \\\n"
    "    --cliques cubes:1"};

bool
parse(int argc, char** argv, Arguments& arguments)
{
  po::options_description options("Options");
  options.add_options()("input", po::value(&arguments.input), "the labelled cloud")(
      "output", po::value(&arguments.output), "the cloud to write")(
      "label-set", po::value(&arguments.label_set),
      "classes (YAML), if labels alone do not show how many there are")(
      "config", po::value(&arguments.config),
      "parameters as YAML; options override it")(
      "print-config", po::bool_switch(&arguments.print_config),
      "print the effective parameters as YAML and end");
  tool::addParameters(parametersOf(arguments.parameters), options);
  po::positional_options_description positional;
  positional.add("input", 1).add("output", 1);
  po::variables_map values;
  if (!tool::parseCommandLine(argc, argv, usage, options, positional, values))
    return false;
  readCRFConfig(arguments.config, arguments.parameters);
  tool::setParameters(values, parametersOf(arguments.parameters));
  arguments.parameters.validate();
  return true;
}

template <typename PointT>
void
setCliques(const std::string& cliques, const tool::LabelledTable& input,
           SemanticCRF<PointT>& crf)
{
  if (cliques == "none")
    return;
  if (cliques == "field")
    crf.setCliques(input.cliques());
  else if (cliques == "slic" || cliques.find(':') != std::string::npos)
    crf.setCliqueGenerator(makeCliqueGenerator(cliques));
  else
    crf.setCliques(readCliques(cliques, input.table.points));
}

// Runs the filter over points with colour or without, and says what became of it.
template <typename PointT>
std::string
filter(const CRFConfig& config, int classes, tool::LabelledTable& input)
{
  const auto fields = input.cloud();
  const auto cloud = std::make_shared<pcl::PointCloud<PointT>>();
  pcl::copyPointCloud(*fields, *cloud);
  SemanticCRF<PointT> crf;
  crf.setModel(config.model);
  crf.setParameters(config.parameters);
  setCliques(config.cliques, input, crf);
  crf.setInputCloud(cloud);
  crf.setLabelDistributions(input.distributions(classes, config.label_confidence));
  crf.filter(*cloud);
  for (std::size_t i = 0; i < cloud->size(); ++i)
    (*fields)[i].label = (*cloud)[i].label;
  input.setResult(*fields, crf.getLabelDistributions());
  const LabelRefiner::Report& report = crf.getReport();
  std::ostringstream text;
  text << "points: " << cloud->size() << ", of which " << crf.getSkippedPoints()
       << " without a place, " << report.unlabelled
       << " without a measurement\ncliques: " << report.cliques
       << "\nupdates: " << report.updates << "\n";
  return text.str();
}

int
refine(const Arguments& arguments)
{
  if (arguments.output.empty())
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "expected IN.pcd OUT.pcd (see " << usage.name << " --help)");
  const CRFConfig& config = arguments.parameters;
  tool::refuseSameFiles(
      {arguments.input, arguments.config, arguments.label_set, config.cliques},
      {arguments.output});
  config.requireFittingCliques();
  setNumberOfThreads(config.threads);
  const int classes =
      arguments.label_set.empty() ? 0 : readLabelSet(arguments.label_set).size();
  tool::LabelledTable input(arguments.input);
  const std::string report = input.hasColour()
                                 ? filter<pcl::PointXYZRGBL>(config, classes, input)
                                 : filter<pcl::PointXYZL>(config, classes, input);
  writePcd(arguments.output, input.table);
  std::cout << report;
  return tool::exit_done;
}

} // namespace

int
main(int argc, char** argv)
{
  return tool::run(usage.name, [&] {
    Arguments arguments;
    if (!parse(argc, argv, arguments))
      return int(tool::exit_done);
    if (arguments.print_config) {
      std::cout << printParameters(parametersOf(arguments.parameters));
      return int(tool::exit_done);
    }
    return refine(arguments);
  });
}
