// SPDX-License-Identifier: BSD-3-Clause
#include "messages.h"
#include "parameter_options.h"
#include "tool.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/files/clique_file.h>
#include <pcl_semantic/files/cloud_file.h>
#include <pcl_semantic/files/label_set_file.h>
#include <pcl_semantic/filters/semantic_crf.h>
#include <pcl_semantic/pipeline/mapper_config.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <map>
#include <optional>
#include <sstream>

namespace {

using namespace pcl_semantic;
namespace po = tool::po;

struct Arguments {
  std::string input, output, label_set, label_mapping, config;
  CRFConfig parameters;

  Arguments()
  {
    parameters.clique_words = "none, field (its field clique), cubes[:SIZE] [m], slic "
                              "(organized clouds), supervoxel[:DISTANCE] [m], or a "
                              "file of lists of indices";
  }
};

const tool::Usage usage{
    "pcl_semantic_crf", "IN OUT.pcd [options]",
    "Makes the labels of a cloud consistent with a CRF. IN (.pcd, .ply, or a scan of\n"
    "KITTI, .bin with .label) has the fields x y z,\n"
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
      "label-mapping", po::value(&arguments.label_mapping),
      tool::label_mapping_help)("config", po::value(&arguments.config),
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
  const bool is_file = cliques != "field" && !namesCloudCliques(cliques);
  if (is_file && cliques.find_first_of("./") == std::string::npos &&
      !std::filesystem::exists(cliques))
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "cliques are '" << cliques
                                        << "', expected none, field, cubes[:SIZE], "
                                           "slic, supervoxel[:DISTANCE] or a file");
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

// The number of its classes, to which the labels have to belong.
int
sizeOfLabelSet(const Arguments& arguments, const LabelledCloud& input)
{
  const int classes = readLabelSet(arguments.label_set).size();
  for (std::size_t i = 0; i < input.cloud->size(); ++i)
    if ((*input.cloud)[i].label > std::uint32_t(classes))
      PCL_THROW_EXCEPTION(BadInputException,
                          arguments.input << ": label " << (*input.cloud)[i].label
                                          << " of point " << i << " is beyond the "
                                          << classes
                                          << " classes of --label-set; other numbers "
                                             "need --label-mapping");
  return classes;
}

void
setMeasurements(const Arguments& arguments, const LabelledCloud& input, Filter& crf)
{
  const int found = input.distributions.classes();
  int classes = found;
  if (!arguments.label_set.empty())
    classes = sizeOfLabelSet(arguments, input);
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

// A distribution that prefers no class says as little as none.
std::size_t
countWithoutPreference(const LabelledCloud& input)
{
  if (input.distributions.classes() == 0) // hard labels
    return std::size_t(std::count_if(
        input.cloud->begin(), input.cloud->end(),
        [](const pcl::PointXYZRGBL& point) { return point.label == kUnlabelled; }));
  std::size_t count = 0;
  const auto& matrix = input.distributions.matrix();
  for (Eigen::Index i = 0; i < matrix.cols(); ++i)
    count += matrix.col(i).maxCoeff() - matrix.col(i).minCoeff() < 1e-6f;
  return count;
}

// How many labels the CRF changed: of each class, if these are few.
class Changes {
public:
  explicit Changes(const pcl::PointCloud<pcl::PointXYZRGBL>& cloud)
  {
    for (const pcl::PointXYZRGBL& point : cloud)
      before_.push_back(point.label);
  }

  void
  count(const pcl::PointCloud<pcl::PointXYZRGBL>& cloud)
  {
    for (std::size_t i = 0; i < cloud.size(); ++i)
      if (cloud[i].label != before_[i]) {
        ++changed_;
        ++from_[before_[i]];
      }
  }

  std::size_t
  total() const
  {
    return changed_;
  }

  // "12 of building, 3 of road", or the numbers of the labels without names.
  std::string
  text(const Arguments& arguments) const
  {
    std::optional<LabelSet> names;
    if (!arguments.label_set.empty())
      names = readLabelSet(arguments.label_set);
    std::ostringstream text;
    for (const auto& [label, number] : from_)
      text << (text.tellp() > 0 ? ", " : "") << number << " of "
           << (names ? (*names)[Label(label)].name : std::to_string(label));
    return text.str();
  }

  bool
  areOfFewClasses() const
  {
    return !from_.empty() && from_.size() <= 30;
  }

private:
  std::vector<std::uint32_t> before_;
  std::map<std::uint32_t, std::size_t> from_;
  std::size_t changed_ = 0;
};

// Says why a result may not be what was wished.
void
warnOfResult(const Arguments& arguments, const LabelledCloud& input,
             std::size_t without_preference, const CRFReport& report,
             std::size_t changed)
{
  const SemanticCRFParameters& crf = arguments.parameters.parameters;
  const std::size_t points = input.cloud->size();
  if (points == 0)
    return;
  if (without_preference == points)
    tool::warn(arguments.input +
               ": no point has a label, or all classes are equally likely; there is "
               "nothing to make consistent");
  else if (changed == 0)
    tool::warn("no label changed; larger --smoothness-weight and --appearance-weight "
               "change more");
  if (!(report.spacing > 0.0))
    return;
  for (const double deviation : {crf.smoothness_deviation, crf.appearance_deviation})
    if (deviation != 0.0 &&
        (deviation < 0.5 * report.spacing || deviation > 50.0 * report.spacing)) {
      std::ostringstream text;
      text << arguments.input << ": points lie " << report.spacing
           << " apart (median of fourth neighbours), for which a deviation of "
           << deviation << " is too "
           << (deviation < report.spacing ? "small" : "large")
           << "; is the cloud in metres? Without --smoothness-deviation and "
              "--appearance-deviation they would be "
           << SemanticCRFParameters::automaticDeviation(report.spacing);
      return tool::warn(text.str());
    }
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
  Changes changes(*input.cloud);
  try {
    crf.filter(*input.cloud);
  }
  catch (const BadInputException& error) { // a cloud knows nothing of its file
    PCL_THROW_EXCEPTION(BadInputException, arguments.input << ": " << error.what());
  }
  changes.count(*input.cloud);
  const std::size_t without_preference = countWithoutPreference(input);
  input.distributions = crf.getLabelDistributions();
  const CRFReport& report = crf.getReport();
  warnOfResult(arguments, input, without_preference, report, changes.total());
  tool::Results results{{"points", input.cloud->size()}, {"changed", changes.total()}};
  if (changes.areOfFewClasses())
    results.push_back({"changed_of_classes", changes.text(arguments)});
  const tool::Results rest{{"without_place", crf.getSkippedPoints()},
                           {"without_measurement", report.unlabelled},
                           {"cliques", report.cliques},
                           {"cliques_without_points", report.skipped_cliques},
                           {"updates", std::size_t(report.updates)},
                           {"cloud", arguments.output}};
  results.insert(results.end(), rest.begin(), rest.end());
  return results;
}

int
refine(const Arguments& arguments)
{
  if (arguments.output.empty())
    tool::failUsage(usage, "expected IN OUT.pcd");
  const CRFConfig& config = arguments.parameters;
  tool::refuseSameFiles(
      {arguments.input, arguments.config, arguments.label_set, config.cliques},
      {arguments.output});
  if (!arguments.label_mapping.empty() && arguments.label_set.empty())
    tool::failUsage(usage, "--label-mapping needs --label-set");
  config.requireFittingCliques();
  tool::requireOutput(arguments.output, ".pcd");
  setNumberOfThreads(config.threads);
  std::optional<LabelMapping> mapping;
  if (!arguments.label_mapping.empty())
    mapping =
        readLabelMapping(arguments.label_mapping, readLabelSet(arguments.label_set));
  LabelledCloud cloud =
      readLabelledCloud(arguments.input, mapping ? &*mapping : nullptr);
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
