// SPDX-License-Identifier: BSD-3-Clause
#include "cloud_doubts.h"
#include "messages.h"
#include "tool.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/no_return.h>
#include <pcl_semantic/files/cloud_file.h>
#include <pcl_semantic/files/label_set_file.h>
#include <pcl_semantic/files/object_file.h>
#include <pcl_semantic/things/object_extraction.h>
#include <pcl_semantic/things/object_summary.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace {

using namespace pcl_semantic;
using namespace pcl_semantic::tool;

const Usage usage{
    "pcl_semantic_things",
    "IN OUT.pcd [options]",
    R"(Finds the objects of a labelled cloud: groups of points of one class with gaps of
at most --gap. OUT.pcd is IN with the field object (0 = none). Classes marked thing
in the label set have objects; without a label set, all classes do.)",
    R"(pcl_semantic_synthesize /tmp/street && \
  pcl_semantic_map /tmp/street --labels /tmp/street/labels --output /tmp/map && \
  pcl_semantic_things /tmp/map/map.pcd /tmp/things.pcd \
    --label-set data/label_sets/kitti11.yaml --objects /tmp/objects.json)",
    {{"label-set FILE", "label set (.yaml), which marks things"},
     {"gap 0.7", "maximum distance between neighbouring points of an object [m]"},
     {"min-points 20", "minimum number of points of an object"},
     {"objects FILE", "output list of objects (.json)"},
     {"boxes FILE", "output boxes as lines (.ply)"}}};

struct Arguments {
  std::string input, output, objects, boxes, label_set, label_mapping, scan_columns;
  double gap = ObjectExtractionBase::default_gap;
  int min_points = 20;
};

Arguments
parse(int argc, char** argv)
{
  Arguments arguments;
  parseCommandLine(
      argc, argv, usage,
      {{"input", arguments.input, "input cloud with labels"},
       {"output", arguments.output, "output cloud (.pcd)"},
       {"label-set", arguments.label_set, "label set (.yaml), which marks things"},
       {"label-mapping", arguments.label_mapping, kLabelMappingHelp},
       {"scan-columns", arguments.scan_columns, kScanColumnsHelp},
       {"gap", withDefault(arguments.gap),
        "maximum distance between neighbouring points of an object [m], for classes "
        "without a gap in the label set"},
       {"min-points", withDefault(arguments.min_points),
        "minimum number of points of an object"},
       {"objects", arguments.objects, "output list of objects (.json)"},
       {"boxes", arguments.boxes,
        "output boxes as lines, one colour per class (.ply)"}},
      {"input", "output"});
  refuseIf(arguments.output.empty(), "expected IN OUT.pcd");
  refuseIf(arguments.label_set.empty() && !arguments.label_mapping.empty(),
           "--label-mapping needs --label-set");
  refuseIf(arguments.min_points < 1,
           "--min-points is " + shown(arguments.min_points) + ", expected 1 or more");
  requireOutput(arguments.output, ".pcd");
  requireOutput(arguments.objects, ".json");
  requireOutput(arguments.boxes, ".ply");
  refuseSameFiles({arguments.input, arguments.label_set, arguments.label_mapping},
                  {arguments.output, arguments.objects, arguments.boxes});
  return arguments;
}

LabelledCloud
readCloud(const Arguments& arguments, const LabelSet& label_set)
{
  std::optional<LabelMapping> mapping;
  MappingWatch watch;
  if (!arguments.label_mapping.empty()) {
    mapping = readLabelMapping(arguments.label_mapping, label_set);
    watch = MappingWatch(arguments.label_mapping, *mapping, "points");
  }
  LabelledCloud cloud =
      readLabelledCloud(arguments.input, mapping ? &*mapping : nullptr,
                        parseScanColumns(arguments.scan_columns));
  if (mapping && cloud.has_labels && cloud.table.find("label") < 0)
    refuseForProbabilities(arguments.input, {"--label-mapping"});
  if (!cloud.has_labels && !cloud.cloud->empty())
    fail<BadInputException>(arguments.input, ": has no labels",
                            textOfDoubts(cloud.table.doubts, arguments.input));
  for (std::size_t i = 0; i < cloud.cloud->size() && label_set.size() > 0; ++i)
    if (const auto label = (*cloud.cloud)[i].label; label > unsigned(label_set.size()))
      fail<BadInputException>(arguments.input, ": point ", i, " has label ", label,
                              ", expected 0 to ", label_set.size());
  warnOf(cloud.table.doubts);
  warnOfNoReturns(arguments.input, countNoReturns(*cloud.cloud));
  if (cloud.cloud->empty())
    warn(arguments.input + ": no point is left");
  return cloud;
}

std::vector<ObjectSummary>
summarize(const std::vector<pcl::PointIndices>& objects, const LabelledCloud& cloud)
{
  const CloudPositions positions(cloud);
  std::vector<ObjectSummary> summaries;
  for (const pcl::PointIndices& object : objects) {
    summaries.push_back(
        summarizeObject(object.indices, std::cref(positions), cloud.distributions));
    ObjectSummary& summary = summaries.back();
    summary.id = std::uint32_t(summaries.size());
    summary.label = Label((*cloud.cloud)[std::size_t(object.indices.front())].label);
  }
  return summaries;
}

int
extract(const Arguments& arguments)
{
  LabelSet label_set;
  if (!arguments.label_set.empty())
    label_set = readLabelSet(arguments.label_set);
  ObjectExtraction<pcl::PointXYZRGBL> extraction;
  extraction.setGap(arguments.gap);
  extraction.setMinClusterSize(std::size_t(arguments.min_points));
  if (label_set.size() > 0)
    try {
      extraction.setLabelSet(label_set);
    }
    catch (const InvalidParameterException& error) {
      fail<BadInputException>(arguments.label_set, ": ", error.what());
    }
  LabelledCloud cloud = readCloud(arguments, label_set);
  std::vector<pcl::PointIndices> objects;
  try {
    extraction.setInputCloud(cloud.cloud);
    extraction.extract(objects);
  }
  catch (const BadInputException& error) { // the extraction does not know the file
    fail<BadInputException>(arguments.input, ": ", error.what());
  }
  std::vector<std::uint32_t> numbers(cloud.cloud->size(), 0);
  std::size_t members = 0;
  for (std::uint32_t o = 0; o < objects.size(); ++o)
    for (const pcl::index_t i : objects[o].indices) {
      numbers[std::size_t(i)] = o + 1;
      ++members;
    }
  const std::vector<ObjectSummary> summaries = summarize(objects, cloud);
  if (!arguments.objects.empty())
    writeObjects(arguments.objects, summaries, label_set);
  if (!arguments.boxes.empty())
    writeBoxes(arguments.boxes, summaries, label_set);
  PcdTable table = cloud.table;
  table.setColumn("object", numbers);
  writeCloudTable(arguments.output, table);
  printResults({{"objects", objects.size()},
                {"members", members},
                {"points", cloud.cloud->size()},
                {"cloud", arguments.output}});
  return exit_done;
}

} // namespace

int
main(int argc, char** argv)
{
  return run(usage.name, [&] { return extract(parse(argc, argv)); });
}
