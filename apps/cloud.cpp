// SPDX-License-Identifier: BSD-3-Clause
#include "cloud_doubts.h"
#include "io/cloud_row_writer.h"
#include "large_cloud.h"
#include "messages.h"
#include "tool.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/no_return.h>
#include <pcl_semantic/files/cloud_file.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/files/label_set_file.h>
#include <pcl_semantic/filters/label_voxel_grid.h>

#include <charconv>
#include <numeric>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace pcl_semantic;
using namespace pcl_semantic::tool;

struct Arguments {
  std::string input, output, label_set, label_mapping, scan_columns;
  std::string crop, keep, drop, relabel;
  double thin = 0.0;
  double memory = 0.0; // [GB]
  bool colour = false;
};

const Usage usage{
    "pcl_semantic_cloud", "IN OUT.pcd [options]",
    R"(Prepares a labelled cloud for other programs: maps its labels, crops it, keeps
or drops classes, renames labels, thins it, colours it by class, in this order.
IN is a .pcd, a .ply, or a scan without a header (.bin as KITTI and nuScenes have
them, with .label). All other fields are kept.)",
    R"(pcl_semantic_synthesize /tmp/street && \
  pcl_semantic_map /tmp/street --labels /tmp/street/labels --output /tmp/map && \
  pcl_semantic_cloud /tmp/map/map.pcd /tmp/thin.pcd --thin 0.3 --drop car \
    --label-set data/label_sets/kitti11.yaml --colour)"};

Arguments
parse(int argc, char** argv)
{
  Arguments arguments;
  const po::variables_map values = parseCommandLine(
      argc, argv, usage,
      {{"input", arguments.input, "input cloud with labels"},
       {"output", arguments.output, "output cloud (.pcd)"},
       {"label-set", arguments.label_set,
        "label set (.yaml), for class names and colours"},
       {"label-mapping", arguments.label_mapping, kLabelMappingHelp},
       {"scan-columns", arguments.scan_columns, kScanColumnsHelp},
       {"crop", arguments.crop, "keep the points in a box x0,y0,z0,x1,y1,z1 [m]"},
       {"keep", arguments.keep,
        "keep the points of these classes: names (or unlabelled) or numbers, separated "
        "by commas"},
       {"drop", arguments.drop, "drop the points of these classes, as in --keep"},
       {"relabel", arguments.relabel,
        "new labels of classes, OLD=NEW, separated by commas: fence=pole,7=0"},
       {"thin", arguments.thin,
        "voxel size of thinning [m]: one point per voxel, with mean probabilities "
        "or the most frequent label"},
       {"memory", arguments.memory, kMemoryHelp},
       {"colour", arguments.colour, "write the colours of the classes as rgba"}},
      {"input", "output"});
  refuseIf(arguments.output.empty(), "expected IN OUT.pcd");
  refuseIf(arguments.label_set.empty() &&
               (arguments.colour || !arguments.label_mapping.empty()),
           "--colour and --label-mapping need --label-set");
  refuseIf(values.count("thin") > 0 && !(arguments.thin > 0.0),
           "--thin is " + shown(arguments.thin) + ", expected more than 0");
  return arguments;
}

class Editor {
public:
  explicit Editor(const Arguments& arguments) : arguments_(arguments)
  {
    if (!arguments.label_set.empty())
      label_set_ = readLabelSet(arguments.label_set);
    if (!arguments.label_mapping.empty())
      mapping_ = readLabelMapping(arguments.label_mapping, *label_set_);
    if (mapping_)
      watch_ = MappingWatch(arguments.label_mapping, *mapping_, "points");
    if (!arguments.crop.empty())
      box_ = boxOf(arguments.crop);
    keep_ = labelsOf("--keep", arguments.keep);
    drop_ = labelsOf("--drop", arguments.drop);
    readRelabelling();
  }

  const LabelMapping*
  mapping() const
  {
    return mapping_ ? &*mapping_ : nullptr;
  }

  /** \brief Prepares for parts of a cloud, whose doubts are known.
   * \param[in] zero_is_none see countNoReturns() */
  void
  setParts(bool zero_is_none)
  {
    has_parts_ = true;
    zero_is_none_ = zero_is_none;
    if (mapping_) // the survey has counted the unmapped numbers
      mapping_ = readLabelMapping(arguments_.label_mapping, *label_set_);
  }

  PcdTable
  edit(PcdTable table)
  {
    const std::array<double, 7> viewpoint = table.viewpoint;
    LabelledCloud cloud =
        labelledCloudOf(std::move(table), arguments_.input, mapping());
    if (mapping_ && cloud.has_labels && cloud.table.find("label") < 0)
      refuseForProbabilities(arguments_.input, {"--label-mapping"});
    const pcl::Indices kept = keptPoints(cloud);
    if (!has_parts_) {
      warnOf(cloud.table.doubts);
      warnOfNoReturns(arguments_.input, countNoReturns(*cloud.cloud));
    }
    for (pcl::PointXYZRGBL& point : *cloud.cloud)
      point.label = relabelled_[point.label];
    table = cloud.table;
    if (cloud.has_labels)
      table = withLabels(cloud);
    if (kept.size() < cloud.cloud->size() || arguments_.thin > 0.0)
      table = filtered(table, kept);
    if (arguments_.colour)
      setColours(table);
    table.viewpoint = viewpoint;
    return table;
  }

private:
  Label
  labelOf(const std::string& option, const std::string& word) const
  {
    int number = -1;
    const auto [rest, error] =
        std::from_chars(word.data(), word.data() + word.size(), number);
    const int largest = label_set_ ? label_set_->size() : 255;
    if (error == std::errc() && rest == word.data() + word.size() && number >= 0 &&
        number <= largest)
      return Label(number);
    const Label label = label_set_ ? label_set_->find(word) : kUnlabelled;
    if (label == kUnlabelled && word != "unlabelled")
      fail<InvalidParameterException>(
          option, ": ", inQuotes(word), " is no class",
          (label_set_ ? " of the label set" : "; names need --label-set"));
    return label;
  }

  std::set<std::uint32_t>
  labelsOf(const std::string& option, const std::string& text) const
  {
    std::set<std::uint32_t> labels;
    for (const std::string& word : splitAtCommas(text))
      labels.insert(labelOf(option, word));
    return labels;
  }

  void
  readRelabelling()
  {
    std::iota(relabelled_.begin(), relabelled_.end(), 0u);
    for (const std::string& word : splitAtCommas(arguments_.relabel)) {
      const std::size_t middle = word.find('=');
      if (middle == std::string::npos)
        fail<InvalidParameterException>("--relabel: ", inQuotes(word),
                                        ", expected OLD=NEW");
      relabelled_[labelOf("--relabel", word.substr(0, middle))] =
          labelOf("--relabel", word.substr(middle + 1));
    }
  }

  static Eigen::AlignedBox3d
  boxOf(const std::string& text)
  {
    const std::vector<double> numbers = parseNumbersOf("--crop", text);
    if (numbers.size() == 6 && numbers[0] < numbers[3] && numbers[1] < numbers[4] &&
        numbers[2] < numbers[5])
      return {Eigen::Vector3d(numbers[0], numbers[1], numbers[2]),
              Eigen::Vector3d(numbers[3], numbers[4], numbers[5])};
    fail<InvalidParameterException>(
        "--crop: expected x0,y0,z0,x1,y1,z1, the smaller ones first");
  }

  pcl::Indices
  keptPoints(const LabelledCloud& cloud) const
  {
    for (const auto& [option, is_given] :
         {std::pair("--keep", !keep_.empty()), std::pair("--drop", !drop_.empty()),
          std::pair("--thin", arguments_.thin > 0.0),
          std::pair("--colour", arguments_.colour)})
      if (is_given && !cloud.has_labels && !cloud.cloud->empty())
        fail<BadInputException>(
            arguments_.input, ": has no field 'label' or 'probability', which ", option,
            " needs", textOfDoubts(cloud.table.doubts, arguments_.input));
    const PlaceTest test(*cloud.cloud);
    const CloudPositions positions(cloud);
    const auto has_place = [&](const pcl::PointXYZRGBL& point) {
      return test(point) && !(zero_is_none_ && isAtZero(point));
    };
    pcl::Indices kept;
    for (std::size_t i = 0; i < cloud.cloud->size(); ++i) {
      const pcl::PointXYZRGBL& point = (*cloud.cloud)[i];
      if ((!box_ || has_place(point)) && (!box_ || box_->contains(positions(i))) &&
          (keep_.empty() || keep_.count(point.label) > 0) &&
          drop_.count(point.label) == 0)
        kept.push_back(pcl::index_t(i));
    }
    return kept;
  }

  static PcdTable
  rowsOf(const PcdTable& table, const pcl::Indices& kept)
  {
    PcdTable rows;
    rows.fields = table.fields;
    rows.width = pcl::uindex_t(kept.size());
    rows.height = 1;
    rows.point_step = table.point_step;
    const std::size_t size = table.point_step;
    rows.data.reserve(kept.size() * size);
    for (const pcl::index_t i : kept) {
      const auto row = table.data.begin() + std::ptrdiff_t(std::size_t(i) * size);
      rows.data.insert(rows.data.end(), row, row + std::ptrdiff_t(size));
    }
    return rows;
  }

  // Drops probabilities, which are of the old classes.
  PcdTable
  withLabels(LabelledCloud& cloud)
  {
    if (!arguments_.relabel.empty()) {
      if (cloud.distributions.classes() > 0) {
        if (!std::exchange(has_told_, true))
          warn(arguments_.input + ": the output has no probabilities, because they do "
                                  "not fit the new labels");
        cloud.table.removeColumns("probability");
      }
      cloud.distributions = LabelDistributions();
    }
    return tableOf(cloud, arguments_.input);
  }

  PcdTable
  filtered(const PcdTable& table, const pcl::Indices& kept) const
  {
    if (arguments_.thin <= 0.0 || kept.empty())
      return rowsOf(table, kept);
    LabelVoxelGrid grid;
    grid.setLeafSize(arguments_.thin);
    grid.setInputCloud(pcl::make_shared<PcdTable>(table));
    grid.setIndices(pcl::make_shared<pcl::Indices>(kept));
    PcdTable rest;
    grid.filter(rest);
    return rest;
  }

  void
  setColours(PcdTable& table) const
  {
    std::vector<std::uint32_t> colours;
    table.removeColumns("rgb");
    if (table.points() == 0)
      return table.setColumn("rgba", colours);
    const PcdColumn labels(table, table.find("label"));
    for (std::size_t i = 0; i < table.points(); ++i) {
      const double label = labels(i);
      if (label > label_set_->size())
        fail<BadInputException>(arguments_.input, ": label ", label, " is beyond the ",
                                label_set_->size(), " classes of --label-set");
      const auto& colour = (*label_set_)[Label(label)].colour;
      colours.push_back(0xFF000000u | std::uint32_t(colour[0]) << 16 |
                        std::uint32_t(colour[1]) << 8 | colour[2]);
    }
    table.setColumn("rgba", colours);
  }

  const Arguments& arguments_;
  std::optional<LabelSet> label_set_;
  std::optional<LabelMapping> mapping_;
  MappingWatch watch_;
  std::optional<Eigen::AlignedBox3d> box_;
  std::set<std::uint32_t> keep_, drop_;
  std::array<std::uint32_t, 256> relabelled_{};
  bool has_parts_ = false, zero_is_none_ = false;
  bool has_told_ = false; // that there are no probabilities
};

// An estimate: points, table and probabilities of 11 classes.
constexpr CloudNeeds kNeeds{0.0, 300.0};

int
finish(const Arguments& arguments, std::size_t before, std::size_t points)
{
  if (points == 0)
    warn("no point is left");
  printResults(
      {{"points_before", before}, {"points", points}, {"cloud", arguments.output}});
  return exit_done;
}

// Edits a binary .pcd in parts: blocks of the file, or tiles that do not cut the voxels
// of thinning.
int
prepareParts(const Arguments& arguments, Editor& editor, std::size_t memory)
{
  PcdReader reader(arguments.input);
  const CloudSurvey survey = surveyWithProgress(reader, editor.mapping(), false);
  editor.setParts(survey.no_returns > 0);
  CloudRowWriter writer(arguments.output, reader.size());
  std::vector<std::uint64_t> numbers;
  std::uint64_t points = 0;
  const auto edit = [&](PcdTable part) {
    const PcdTable edited = editor.edit(std::move(part));
    numbers.resize(edited.points());
    std::iota(numbers.begin(), numbers.end(), points);
    points += numbers.size();
    writer.append(edited, numbers);
  };
  if (arguments.thin > 0.0) {
    TileOptions options;
    options.voxel_size = arguments.thin;
    options.most = pointsOfTile(kNeeds, reader.header().point_step, memory);
    forEachTileOf(*divideWithProgress(reader, survey, options, arguments.output),
                  "thinning", [&](CloudTile tile) { edit(std::move(tile.table)); });
  }
  else
    forEachBlock(reader, [&](std::size_t, PcdTable block) { edit(std::move(block)); });
  PcdTable header = reader.header();
  if (points < reader.size() || arguments.thin > 0.0) {
    header.width = pcl::uindex_t(points);
    header.height = 1;
    header.voxel_grid = {};
  }
  writer.write(header);
  return finish(arguments, reader.size(), points);
}

int
prepare(const Arguments& arguments)
{
  refuseSameFiles({arguments.input, arguments.label_set, arguments.label_mapping},
                  {arguments.output});
  requireOutput(arguments.output, ".pcd");
  Editor editor(arguments);
  const std::size_t memory = memoryOf(arguments.memory);
  const ScanColumns columns = parseScanColumns(arguments.scan_columns);
  if (columns.empty() && needsTiles(arguments.input, kNeeds, memory))
    return prepareParts(arguments, editor, memory);
  PcdTable table = readCloudTable(arguments.input, columns);
  const std::size_t before = table.points();
  table = editor.edit(std::move(table));
  writeCloudTable(arguments.output, table);
  return finish(arguments, before, table.points());
}

} // namespace

int
main(int argc, char** argv)
{
  return run(usage.name, [&] { return prepare(parse(argc, argv)); });
}
