// SPDX-License-Identifier: BSD-3-Clause
#include "cloud_doubts.h"
#include "core/text_stream.h"
#include "files/is_there.h"
#include "image_tool.h"
#include "messages.h"
#include "tool.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/no_return.h>
#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/files/clique_file.h>
#include <pcl_semantic/files/cloud_file.h>
#include <pcl_semantic/files/label_set_file.h>
#include <pcl_semantic/filters/crf_config.h>
#include <pcl_semantic/filters/semantic_crf.h>
#include <pcl_semantic/superpixels/clique_config.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>

namespace {

using namespace pcl_semantic;
using namespace pcl_semantic::tool;

struct Arguments {
  std::string input, output, label_set, label_mapping, scan_columns, config;
  bool states_confidence = false; ///< the user set the labels' confidence
  CRFConfig parameters;

  Arguments()
  {
    parameters.clique_words =
        "cliques: none, field = field 'clique' of IN, planes[:EDGE [m]], "
        "supervoxel[:SEED_DISTANCE [m]], cubes[:EDGE [m]], slic (organized clouds), "
        "several of them, separated by commas, the first with priority, or a file with "
        "the point indices of one clique per line";
  }
};

const Usage usage{
    "pcl_semantic_crf",
    "IN OUT.pcd [options]",
    R"(Makes the labels of a cloud consistent with a CRF. IN (.pcd, .ply, or a scan
without a header, .bin as KITTI and nuScenes have them, with .label) has the fields
x y z, probability (one a class) or label (0 = unlabelled), and, for kernels of
colour, rgb or rgba. OUT.pcd is the same with label and probability rewritten.)",
    R"(pcl_semantic_synthesize /tmp/street && \
  pcl_semantic_map /tmp/street --labels /tmp/street/labels --crf none \
    --output /tmp/raw_map && \
  pcl_semantic_crf /tmp/raw_map/map.pcd /tmp/refined.pcd --crf-sensor stereo \
    --crf hierarchical --cliques planes)",
    {{"label-set FILE",
      "label set (.yaml), if labels do not show the number of classes"},
     {"label-mapping FILE", "mapping from numbers in IN to classes of the label set"},
     {"cliques WORDS",
      "planes, supervoxel[:DISTANCE], cubes[:EDGE], slic, field or a file"},
     {"crf dense", "CRF model: unary, dense, pn-potts or hierarchical"},
     {"crf-sensor WORD", "sensor of the points: stereo, rgbd or lidar"},
     {"crf-iterations N", "number of mean-field updates"},
     {"smoothness-weight 3", "weight of the smoothness kernel"},
     {"appearance-weight 8", "weight of the appearance kernel"},
     {"clique-weight 2", "cost of a member whose label differs from its clique's"},
     {"label-confidence 0.8", "probability of the class of a label"},
     {"threads 0", "number of threads; 0 = all processors"},
     {"config FILE", "parameters (.yaml); --print-config writes them"}}};

Arguments
parse(int argc, char** argv)
{
  Arguments arguments;
  bool print_config = false;
  const po::variables_map values = parseCommandLine(
      argc, argv, usage,
      {{"input", arguments.input, "labelled input cloud"},
       {"output", arguments.output, "output cloud"},
       {"label-set", arguments.label_set,
        "label set (YAML), if the labels do not show the number of classes"},
       {"label-mapping", arguments.label_mapping, kLabelMappingHelp},
       {"scan-columns", arguments.scan_columns, kScanColumnsHelp},
       {"config", arguments.config, "parameter file (.yaml); options override it"},
       {"print-config", print_config,
        "print the effective parameters as YAML and exit"}},
      {"input", "output"}, parametersOf(arguments.parameters));
  setCRFConfig(values, arguments.config, print_config, arguments.parameters);
  refuseUnread(values, {{arguments.label_set.empty(),
                         "without --label-set, which says what classes are thin",
                         {"crf-keep-thin"}}});
  arguments.states_confidence = values.count("label-confidence") > 0;
  return arguments;
}

using Filter = SemanticCRF<pcl::PointXYZRGBL>;

void
setCliques(const std::string& cliques, const Arguments& arguments,
           const LabelledCloud& input, Filter& crf)
{
  if (cliques == "none" || input.cloud->empty())
    return;
  const bool is_file = cliques != "field" && !namesCloudCliques(cliques);
  if (is_file && cliques.find_first_of("./") == std::string::npos && !isThere(cliques))
    fail<InvalidParameterException>(
        "cliques are '", cliques,
        "', expected none, field, planes[:EDGE], supervoxel[:DISTANCE], cubes[:EDGE], "
        "slic or a file");
  if (cliques == "field" && input.table.find("clique") < 0)
    fail<BadInputException>(arguments.input, ": has no field 'clique'");
  if (cliques == "field")
    crf.setCliques(input.cliques);
  else if (namesCloudCliques(cliques)) {
    // The CRF moves voxels to their centres.
    const auto means = std::make_shared<CliqueGenerator::Cloud>();
    pcl::copyPointCloud(*input.cloud, *means);
    const CliqueGenerator::Ptr generator = makeCliqueGenerator(cliques);
    generator->setMeanPositions(means, input.table.voxel_grid[0]);
    crf.setCliqueGenerator(generator);
  }
  else
    crf.setCliques(readCliques(cliques, input.cloud->size()));
}

// Number of classes of the label set that the labels must belong to.
int
sizeOfLabelSet(const Arguments& arguments, const LabelledCloud& input)
{
  const int classes = readLabelSet(arguments.label_set).size();
  for (std::size_t i = 0; i < input.cloud->size(); ++i)
    if ((*input.cloud)[i].label > std::uint32_t(classes))
      fail<BadInputException>(
          arguments.input, ": label ", (*input.cloud)[i].label, " of point ", i,
          " is beyond the ", classes,
          " classes of --label-set; other numbers need --label-mapping");
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
  if (found == 0 && !input.has_labels && !input.cloud->empty())
    fail<BadInputException>(arguments.input, ": has no field 'label' or 'probability'",
                            textOfDoubts(input.table.doubts, arguments.input));
  if (found > 0 && found != classes)
    fail<BadInputException>(arguments.input, ": has probabilities of ", found,
                            " classes, expected ", classes);
  std::vector<std::string> of_labels;
  if (arguments.states_confidence)
    of_labels.emplace_back("--label-confidence");
  if (!arguments.label_mapping.empty())
    of_labels.emplace_back("--label-mapping");
  if (found > 0)
    refuseForProbabilities(arguments.input, of_labels);
  if (found > 0)
    crf.setLabelDistributions(input.distributions);
  else
    crf.setLabelConfidence(arguments.parameters.label_confidence, std::max(1, classes));
}

// A map contains the entropy of each voxel.
void
setEntropies(LabelledCloud& cloud)
{
  if (cloud.table.find("entropy") < 0)
    return;
  std::vector<float> entropies(cloud.cloud->size());
  for (std::size_t i = 0; i < entropies.size(); ++i)
    entropies[i] = cloud.distributions.entropy(Eigen::Index(i));
  cloud.table.setColumn("entropy", entropies);
}

// Counts points without preference: uniform distributions are as uninformative as none.
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

using Labels = std::vector<std::uint32_t>;

Labels
labelsOf(const pcl::PointCloud<pcl::PointXYZRGBL>& cloud)
{
  Labels labels;
  for (const pcl::PointXYZRGBL& point : cloud)
    labels.push_back(point.label);
  return labels;
}

// Counts changed labels by old class: "12 of building, 3 of road", or numbers for
// labels without names. Empty if there are too many classes.
std::string
textOfChanges(const Labels& before, const Labels& now, const std::string& label_set)
{
  std::map<std::uint32_t, std::size_t> changed;
  for (std::size_t i = 0; i < now.size(); ++i)
    if (now[i] != before[i])
      ++changed[before[i]];
  if (changed.size() > 30)
    return {};
  std::optional<LabelSet> names;
  if (!label_set.empty())
    names = readLabelSet(label_set);
  TextStream text;
  for (const auto& [label, number] : changed)
    text << (text.tellp() > 0 ? ", " : "") << number << " of "
         << (names ? (*names)[Label(label)].name : std::to_string(label));
  return text.str();
}

// Warns of results that the user may not expect.
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
    warn(arguments.input + ": no point has a label, or all classes are equally likely; "
                           "the CRF has no effect");
  else if (changed == 0)
    warn("no label changed; larger --smoothness-weight and --appearance-weight "
         "change more");
  if (!(report.spacing > 0.0))
    return;
  const double widest = report.extent > 0.0 ? report.extent : 50.0 * report.spacing;
  for (const double deviation : {crf.smoothness_deviation, crf.appearance_deviation})
    if (deviation != 0.0 && (deviation < 0.5 * report.spacing || deviation > widest)) {
      SemanticCRFParameters defaults;
      defaults.sensor = crf.sensor;
      defaults = defaults.resolved(report.spacing, input.has_colour, report.extent);
      TextStream text;
      text << arguments.input << ": ";
      if (deviation > widest && report.extent > 0.0)
        text << "half of the points lie within " << report.extent << " of the middle";
      else
        text << "points lie " << report.spacing
             << " apart (median of fourth neighbours)";
      text << ", so a deviation of " << deviation << " is too "
           << (deviation > widest ? "large" : "small")
           << "; is the cloud in metres? The defaults of --smoothness-deviation and "
              "--appearance-deviation are "
           << defaults.smoothness_deviation << " and " << defaults.appearance_deviation;
      return warn(text.str());
    }
}

// Runs the filter over the cloud and returns its results.
Results
filter(const Arguments& arguments, LabelledCloud& input)
{
  Filter crf;
  crf.setModel(arguments.parameters.model);
  crf.setParameters(arguments.parameters.parameters);
  if (!arguments.label_set.empty())
    crf.setThinLabels(readLabelSet(arguments.label_set).thinLabels());
  setCliques(arguments.parameters.cliques, arguments, input, crf);
  moveToVoxelCentres(input);
  setMeasurements(arguments, input, crf);
  crf.setUseColour(input.has_colour);
  crf.setOrigin(input.origin);
  crf.setInputCloud(input.cloud);
  const Labels before = labelsOf(*input.cloud);
  try {
    crf.filter(*input.cloud);
  }
  catch (const BadInputException& error) { // the filter does not report the file
    fail<BadInputException>(arguments.input, ": ", error.what());
  }
  const Labels now = labelsOf(*input.cloud);
  std::size_t changed = 0;
  for (std::size_t i = 0; i < now.size(); ++i)
    changed += now[i] != before[i];
  const std::size_t without_preference = countWithoutPreference(input);
  input.distributions = crf.getLabelDistributions();
  const CRFReport& report = crf.getReport();
  warnOfResult(arguments, input, without_preference, report, changed);
  Results results{{"points", input.cloud->size()}, {"changed", changed}};
  const std::string changes = textOfChanges(before, now, arguments.label_set);
  if (!changes.empty())
    results.push_back({"changed_of_classes", changes});
  const Results rest{{"without_place", crf.getSkippedPoints()},
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
  refuseIf(arguments.output.empty(), "expected IN OUT.pcd");
  const CRFConfig& config = arguments.parameters;
  refuseSameFiles(
      {arguments.input, arguments.config, arguments.label_set, config.cliques},
      {arguments.output});
  refuseIf(!arguments.label_mapping.empty() && arguments.label_set.empty(),
           "--label-mapping needs --label-set");
  config.requireFittingCliques();
  requireOutput(arguments.output, ".pcd");
  setNumberOfThreads(config.threads);
  std::optional<LabelMapping> mapping;
  MappingWatch watch;
  if (!arguments.label_mapping.empty()) {
    mapping =
        readLabelMapping(arguments.label_mapping, readLabelSet(arguments.label_set));
    watch = MappingWatch(arguments.label_mapping, *mapping, "points");
  }
  LabelledCloud cloud =
      readLabelledCloud(arguments.input, mapping ? &*mapping : nullptr,
                        parseScanColumns(arguments.scan_columns));
  const std::size_t no_returns = countNoReturns(*cloud.cloud);
  const Results report = filter(arguments, cloud);
  warnOf(cloud.table.doubts);
  warnOfNoReturns(arguments.input, no_returns);
  setEntropies(cloud);
  if (cloud.cloud->empty())
    warn(arguments.input + ": no point is left");
  writeLabelledCloud(arguments.output, cloud);
  printResults(report);
  return exit_done;
}

} // namespace

int
main(int argc, char** argv)
{
  return runWithImages(usage.name, [&] {
    keepFreedMemory();
    return refine(parse(argc, argv));
  });
}
