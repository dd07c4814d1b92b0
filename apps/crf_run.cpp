// SPDX-License-Identifier: BSD-3-Clause
#include "crf_run.h"

#include "cloud_doubts.h"
#include "core/text_stream.h"
#include "files/is_there.h"
#include "tile_cliques.h"
#include "tool.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/clique_file.h>
#include <pcl_semantic/files/label_set_file.h>
#include <pcl_semantic/superpixels/clique_config.h>

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

namespace pcl_semantic::tool {

namespace {

using Labels = std::vector<std::uint32_t>;

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

Labels
labelsOf(const pcl::PointCloud<pcl::PointXYZRGBL>& cloud)
{
  Labels labels;
  for (const pcl::PointXYZRGBL& point : cloud)
    labels.push_back(point.label);
  return labels;
}

// Changed labels by old class: "12 of building, 3 of road", or numbers for labels
// without names. Empty if there are too many classes.
std::string
textOfChanges(const std::map<std::uint32_t, std::size_t>& changed,
              const std::optional<LabelSet>& names)
{
  if (changed.size() > 30)
    return {};
  TextStream text;
  for (const auto& [label, number] : changed)
    text << (text.tellp() > 0 ? ", " : "") << number << " of "
         << (names ? (*names)[Label(label)].name : std::to_string(label));
  return text.str();
}

int
classesOf(const CRFArguments& arguments, const CRFInput& input,
          const std::optional<LabelSet>& names)
{
  const int classes = names               ? names->size()
                      : input.classes > 0 ? input.classes
                                          : std::max(1, int(input.largest_label));
  if (names && input.largest_label > std::uint32_t(classes)) {
    const auto first = std::min_element(input.first_of_label.begin() + classes + 1,
                                        input.first_of_label.end());
    fail<BadInputException>(
        arguments.input, ": label ", first - input.first_of_label.begin(), " of point ",
        *first, " is beyond the ", classes,
        " classes of --label-set; other numbers need --label-mapping");
  }
  if (input.classes == 0 && !input.has_labels && input.points > 0)
    fail<BadInputException>(arguments.input, ": has no field 'label' or 'probability'",
                            textOfDoubts(input.doubts, arguments.input));
  if (input.classes > 0 && input.classes != classes)
    fail<BadInputException>(arguments.input, ": has probabilities of ", input.classes,
                            " classes, expected ", classes);
  std::vector<std::string> of_labels;
  if (arguments.states_confidence)
    of_labels.emplace_back("--label-confidence");
  if (!arguments.label_mapping.empty())
    of_labels.emplace_back("--label-mapping");
  if (input.classes > 0)
    refuseForProbabilities(arguments.input, of_labels);
  return classes;
}

} // namespace

bool
isCliqueFile(const std::string& cliques)
{
  return cliques != "none" && cliques != "field" && !namesCloudCliques(cliques);
}

void
requireCliques(const std::string& cliques)
{
  if (isCliqueFile(cliques) && cliques.find_first_of("./") == std::string::npos &&
      !isThere(cliques))
    fail<InvalidParameterException>(
        "cliques are '", cliques,
        "', expected none, field, planes[:EDGE], supervoxel[:DISTANCE], cubes[:EDGE], "
        "slic or a file");
}

CRFInput
inputOf(const LabelledCloud& cloud)
{
  CRFInput input;
  input.points = cloud.cloud->size();
  input.has_labels = cloud.has_labels;
  input.has_colour = cloud.has_colour;
  input.classes = cloud.distributions.classes();
  input.first_of_label.assign(256, SIZE_MAX);
  for (std::size_t i = 0; i < cloud.cloud->size(); ++i) {
    const std::uint32_t label = (*cloud.cloud)[i].label;
    input.largest_label = std::max(input.largest_label, label);
    std::size_t& first = input.first_of_label[std::min(label, 255u)];
    first = std::min(first, i);
  }
  input.without_preference = countWithoutPreference(cloud);
  input.doubts = cloud.table.doubts;
  return input;
}

CRFInput
inputOf(const CloudSurvey& survey)
{
  return {survey.sample.points,      survey.has_labels,
          survey.has_colour,         survey.classes,
          survey.largest_label,      survey.first_of_label,
          survey.without_preference, survey.doubts};
}

CRFRun::CRFRun(const CRFArguments& arguments, CRFInput input)
    : arguments_(arguments), input_(std::move(input))
{
  if (!arguments.label_set.empty())
    names_ = readLabelSet(arguments.label_set);
  classes_ = classesOf(arguments, input_, names_);
  crf_.setModel(arguments.parameters.model);
  crf_.setParameters(arguments.parameters.parameters);
  if (names_)
    crf_.setThinLabels(names_->thinLabels());
  crf_.setUseColour(input_.has_colour);
}

double
CRFRun::setWhole(const CloudSurvey& survey)
{
  has_tiles_ = true;
  without_place_ = survey.without_place;
  report_.unlabelled = survey.sample.unlabelled;
  const Eigen::VectorXd sums = survey.class_sums.head(classes_);
  Eigen::VectorXd frequencies = sums / std::max(sums.sum(), 1.0);
  if (survey.classes == 0 && classes_ > 1) {
    const double confidence = arguments_.parameters.label_confidence;
    const double other = (1.0 - confidence) / double(classes_ - 1);
    frequencies = (frequencies.array() * (confidence - other) + other).matrix();
  }
  crf_.setClassFrequencies(frequencies);
  return crf_.setWhole(survey.sample);
}

void
CRFRun::setMeasurements(LabelledCloud& cloud)
{
  if (input_.classes > 0)
    crf_.giveLabelDistributions(std::move(cloud.distributions));
  else
    crf_.setLabelConfidence(arguments_.parameters.label_confidence, classes_);
}

void
CRFRun::setCliques(const LabelledCloud& cloud)
{
  const std::string& cliques = arguments_.parameters.cliques;
  if (cliques == "none" || cloud.cloud->empty())
    return;
  if (cliques == "field" && cloud.table.find("clique") < 0)
    fail<BadInputException>(arguments_.input, ": has no field 'clique'");
  if (cliques == "field")
    crf_.setCliques(cloud.cliques);
  else if (isCliqueFile(cliques))
    crf_.setCliques(readCliques(cliques, cloud.cloud->size()));
  else {
    generator_ = makeCliqueGenerator(cliques);
    setMeanPositions(cloud, *generator_);
    crf_.setCliqueGenerator(generator_);
  }
}

// Made here instead of by the filter, so that they can be counted.
void
CRFRun::setTileCliques(const LabelledCloud& cloud, std::size_t own)
{
  if (!has_tiles_ || arguments_.parameters.cliques == "none")
    return;
  const std::vector<pcl::PointIndices> cliques =
      generator_ ? cliquesOf(cloud, *generator_) : cloud.cliques;
  const CliqueCounts counts = countCliques(cliques, own);
  report_.cliques += counts.of_tile;
  cut_cliques_ += counts.cut;
  crf_.setCliques(cliques);
}

void
CRFRun::addToReport(const CRFReport& report)
{
  report_.spacing = report.spacing;
  report_.extent = report.extent;
  report_.updates = report.updates;
  ++tiles_;
  if (has_tiles_)
    return; // the other figures would count the surroundings of tiles
  report_ = report;
  without_place_ = crf_.getSkippedPoints();
}

void
CRFRun::refine(LabelledCloud& cloud, std::size_t own)
{
  setCliques(cloud);
  if (!has_tiles_ && !(cloud.table.voxel_grid[0] > 0.0))
    crf_.setRemainders(remaindersOf(cloud));
  moveToVoxelCentres(cloud);
  setTileCliques(cloud, own);
  setMeasurements(cloud);
  crf_.setOrigin(cloud.origin);
  crf_.setInputCloud(cloud.cloud);
  const Labels before = labelsOf(*cloud.cloud);
  try {
    crf_.filter(*cloud.cloud);
  }
  catch (const BadInputException& error) { // the filter does not report the file
    fail<BadInputException>(arguments_.input, ": ", error.what());
  }
  for (std::size_t i = 0; i < own; ++i)
    if ((*cloud.cloud)[i].label != before[i])
      ++changed_[before[i]];
  cloud.distributions = crf_.takeLabelDistributions();
  setEntropies(cloud);
  addToReport(crf_.getReport());
}

void
CRFRun::warnOfResult(std::size_t changed) const
{
  const SemanticCRFParameters& crf = arguments_.parameters.parameters;
  if (input_.points == 0)
    return warn(arguments_.input + ": no point is left");
  if (input_.without_preference == input_.points)
    warn(arguments_.input +
         ": no point has a label, or all classes are equally likely; "
         "the CRF has no effect");
  else if (changed == 0)
    warn("no label changed; larger --smoothness-weight and --appearance-weight "
         "change more");
  if (!(report_.spacing > 0.0))
    return;
  const double widest = report_.extent > 0.0 ? report_.extent : 50.0 * report_.spacing;
  for (const double deviation : {crf.smoothness_deviation, crf.appearance_deviation})
    if (deviation != 0.0 && (deviation < 0.5 * report_.spacing || deviation > widest)) {
      SemanticCRFParameters defaults;
      defaults.sensor = crf.sensor;
      defaults = defaults.resolved(report_.spacing, input_.has_colour, report_.extent);
      TextStream text;
      text << arguments_.input << ": ";
      if (deviation > widest && report_.extent > 0.0)
        text << "half of the points lie within " << report_.extent << " of the middle";
      else
        text << "points lie " << report_.spacing
             << " apart (median of fourth neighbours)";
      text << ", so a deviation of " << deviation << " is too "
           << (deviation > widest ? "large" : "small")
           << "; is the cloud in metres? The defaults of --smoothness-deviation and "
              "--appearance-deviation are "
           << defaults.smoothness_deviation << " and " << defaults.appearance_deviation;
      return warn(text.str());
    }
}

void
CRFRun::report() const
{
  const std::size_t changed = std::accumulate(
      changed_.begin(), changed_.end(), std::size_t(0),
      [](std::size_t sum, const auto& entry) { return sum + entry.second; });
  warnOfResult(changed);
  Results results{{"points", input_.points}, {"changed", changed}};
  const std::string changes = textOfChanges(changed_, names_);
  if (!changes.empty())
    results.push_back({"changed_of_classes", changes});
  const Results rest{{"without_place", without_place_},
                     {"without_measurement", report_.unlabelled},
                     {has_tiles_ ? "parts_of_cliques" : "cliques", report_.cliques},
                     {"cliques_without_points", report_.skipped_cliques},
                     {"updates", std::size_t(report_.updates)}};
  results.insert(results.end(), rest.begin(), rest.end());
  if (has_tiles_) {
    results.push_back({"tiles", tiles_});
    results.push_back({"cliques_cut_by_tiles", cut_cliques_});
  }
  results.push_back({"cloud", arguments_.output});
  printResults(results);
}

} // namespace pcl_semantic::tool
