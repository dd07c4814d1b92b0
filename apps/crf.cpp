// SPDX-License-Identifier: BSD-3-Clause
#include "cloud_doubts.h"
#include "crf_run.h"
#include "image_tool.h"
#include "io/cloud_row_writer.h"
#include "large_cloud.h"
#include "messages.h"
#include "tool.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/no_return.h>
#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/files/cloud_file.h>
#include <pcl_semantic/files/label_set_file.h>
#include <pcl_semantic/filters/crf_config.h>
#include <pcl_semantic/superpixels/clique_config.h>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>

namespace {

using namespace pcl_semantic;
using namespace pcl_semantic::tool;

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
     {"memory GB", "a larger binary .pcd is refined in tiles"},
     {"threads 0", "number of threads; 0 = all processors"},
     {"config FILE", "parameters (.yaml); --print-config writes them"}}};

CRFArguments
parse(int argc, char** argv)
{
  CRFArguments arguments;
  arguments.parameters.clique_words =
      "cliques: none, field = field 'clique' of IN, planes[:EDGE [m]], "
      "supervoxel[:SEED_DISTANCE [m]], cubes[:EDGE [m]], slic (organized clouds), "
      "several of them, separated by commas, the first with priority, or a file with "
      "the point indices of one clique per line";
  bool print_config = false;
  const po::variables_map values = parseCommandLine(
      argc, argv, usage,
      {{"input", arguments.input, "labelled input cloud"},
       {"output", arguments.output, "output cloud"},
       {"label-set", arguments.label_set,
        "label set (YAML), if the labels do not show the number of classes"},
       {"label-mapping", arguments.label_mapping, kLabelMappingHelp},
       {"scan-columns", arguments.scan_columns, kScanColumnsHelp},
       {"memory", arguments.memory, kMemoryHelp},
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

std::optional<LabelMapping>
mappingOf(const CRFArguments& arguments)
{
  if (arguments.label_mapping.empty())
    return std::nullopt;
  return readLabelMapping(arguments.label_mapping, readLabelSet(arguments.label_set));
}

// Measured with 11 classes and colour (doc/crf.md#large-clouds).
constexpr CloudNeeds kNeeds{1.1e9, 330.0};

// The tiles of a binary .pcd, which are refined one after the other.
int
refineTiles(const CRFArguments& arguments, const LabelMapping* mapping,
            std::size_t memory)
{
  const std::string& cliques = arguments.parameters.cliques;
  if (isCliqueFile(cliques) || namesCliques(cliques, "slic"))
    fail<InvalidParameterException>(
        "cliques from ", cliques,
        " need the whole cloud in memory: a larger --memory, "
        "or the field 'clique' and --cliques field");
  PcdReader reader(arguments.input);
  const CloudSurvey survey = surveyWithProgress(reader, mapping, true);
  CRFRun run(arguments, inputOf(survey));
  TileOptions options;
  options.reach = run.setWhole(survey);
  const double more_classes = double(std::max(run.classes() - 11, 0));
  options.most = pointsOfTile(
      {kNeeds.fixed + 30e6 * more_classes, kNeeds.per_point + 12.0 * more_classes},
      reader.header().point_step, memory);
  const auto tiles = divideWithProgress(reader, survey, options, arguments.output);
  note(std::to_string(tiles->size()) + " tiles of up to " +
       std::to_string(options.most) + " points with the " + shown(options.reach) +
       " m around them");
  CloudRowWriter writer(arguments.output, reader.size());
  const std::optional<LabelMapping> same = mappingOf(arguments); // counts apart
  forEachTileOf(*tiles, "refining", [&](CloudTile tile) {
    LabelledCloud cloud = labelledCloudOf(std::move(tile.table), arguments.input,
                                          same ? &*same : nullptr);
    run.refine(cloud, tile.numbers.size());
    writer.append(tableOf(cloud, arguments.output), tile.numbers);
  });
  writer.write(reader.header());
  run.report();
  return exit_done;
}

int
refine(const CRFArguments& arguments)
{
  refuseIf(arguments.output.empty(), "expected IN OUT.pcd");
  const CRFConfig& config = arguments.parameters;
  refuseSameFiles(
      {arguments.input, arguments.config, arguments.label_set, config.cliques},
      {arguments.output});
  refuseIf(!arguments.label_mapping.empty() && arguments.label_set.empty(),
           "--label-mapping needs --label-set");
  config.requireFittingCliques();
  requireCliques(config.cliques);
  requireOutput(arguments.output, ".pcd");
  setNumberOfThreads(config.threads);
  const std::size_t memory = memoryOf(arguments.memory);
  const std::optional<LabelMapping> mapping = mappingOf(arguments);
  MappingWatch watch;
  if (mapping)
    watch = MappingWatch(arguments.label_mapping, *mapping, "points");
  const ScanColumns columns = parseScanColumns(arguments.scan_columns);
  if (columns.empty() && needsTiles(arguments.input, kNeeds, memory))
    return refineTiles(arguments, mapping ? &*mapping : nullptr, memory);
  LabelledCloud cloud =
      readLabelledCloud(arguments.input, mapping ? &*mapping : nullptr, columns);
  const std::size_t no_returns = countNoReturns(*cloud.cloud);
  CRFRun run(arguments, inputOf(cloud));
  run.refine(cloud, cloud.cloud->size());
  warnOf(cloud.table.doubts);
  warnOfNoReturns(arguments.input, no_returns);
  writeLabelledCloud(arguments.output, cloud);
  run.report();
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
