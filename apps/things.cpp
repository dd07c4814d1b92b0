// SPDX-License-Identifier: BSD-3-Clause
#include "cloud_doubts.h"
#include "messages.h"
#include "tool.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/no_return.h>
#include <pcl_semantic/files/cloud_file.h>
#include <pcl_semantic/files/label_set_file.h>
#include <pcl_semantic/files/object_file.h>
#include <pcl_semantic/files/plane_file.h>
#include <pcl_semantic/things/object_extraction.h>
#include <pcl_semantic/things/object_summary.h>
#include <pcl_semantic/things/plane_summary.h>

#include <algorithm>
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
    R"(Finds the objects and planes of a labelled cloud. OUT.pcd is IN with the fields
object and plane (0 = none). An object is a group of points of one class with gaps
of at most --gap. Classes marked thing in the label set have objects; without a
label set, all classes do. A plane may have points of several classes.)",
    R"(pcl_semantic_synthesize /tmp/street && \
  pcl_semantic_map /tmp/street --labels /tmp/street/labels --output /tmp/map && \
  pcl_semantic_things /tmp/map/map.pcd /tmp/things.pcd \
    --label-set data/label_sets/kitti11.yaml --objects /tmp/objects.json \
    --planes /tmp/planes.json)",
    {{"label-set FILE", "label set (.yaml), which marks things"},
     {"gap 0.7", "maximum distance between neighbouring points of an object [m]"},
     {"min-points 20", "minimum number of points of an object"},
     {"objects FILE", "output list of objects (.json)"},
     {"boxes FILE", "output boxes as lines (.ply)"},
     {"plane-area N", "minimum area of a plane [m^2]"},
     {"planes FILE", "output list of planes (.json)"},
     {"polygons FILE", "output outlines of planes as lines (.ply)"}}};

struct Arguments {
  std::string input, output, objects, boxes, planes, polygons;
  std::string label_set, label_mapping, scan_columns;
  double gap = ObjectExtractionBase::default_gap;
  int min_points = 20;
  PlaneParameters plane;
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
       {"boxes", arguments.boxes, "output boxes as lines, one colour per class (.ply)"},
       {"plane-radius", withDefault(arguments.plane.radius),
        "radius of the surroundings of a point, for its normal [m]; 0 = three times "
        "the spacing of the points, at least 0.15; the rest is searched with twice "
        "the radius"},
       {"plane-distance", withDefault(arguments.plane.distance),
        "maximum distance of a point from its plane [m]; 0 = 0.4 times the radius"},
       {"plane-area", withDefault(arguments.plane.min_area),
        "minimum area of a plane [m^2]; 0 = five times the square of the radius"},
       {"planes", arguments.planes, "output list of planes (.json)"},
       {"polygons", arguments.polygons,
        "output outlines of planes as lines, one colour per class (.ply)"}},
      {"input", "output"});
  refuseIf(arguments.output.empty(), "expected IN OUT.pcd");
  refuseIf(arguments.label_set.empty() && !arguments.label_mapping.empty(),
           "--label-mapping needs --label-set");
  refuseIf(arguments.min_points < 1,
           "--min-points is " + shown(arguments.min_points) + ", expected 1 or more");
  requireOutput(arguments.output, ".pcd");
  requireOutput(arguments.objects, ".json");
  requireOutput(arguments.boxes, ".ply");
  requireOutput(arguments.planes, ".json");
  requireOutput(arguments.polygons, ".ply");
  arguments.plane.validate();
  refuseSameFiles({arguments.input, arguments.label_set, arguments.label_mapping},
                  {arguments.output, arguments.objects, arguments.boxes,
                   arguments.planes, arguments.polygons});
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
  const bool wants_planes = !arguments.planes.empty() || !arguments.polygons.empty();
  if (!cloud.has_labels && wants_planes && arguments.objects.empty() &&
      arguments.boxes.empty())
    for (pcl::PointXYZRGBL& point : *cloud.cloud) // planes need no labels
      point.label = kUnlabelled;
  else if (!cloud.has_labels && !cloud.cloud->empty())
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
  const bool has_objects = label_set.size() == 0 || label_set.hasThings();
  const std::string no_things =
      arguments.label_set + ": no class is marked thing, so there is no field object";
  if (!has_objects && !(arguments.objects.empty() && arguments.boxes.empty()))
    fail<BadInputException>(no_things);
  if (!has_objects)
    warn(no_things);
  else if (label_set.size() > 0)
    extraction.setLabelSet(label_set);
  LabelledCloud cloud = readCloud(arguments, label_set);
  std::vector<pcl::PointIndices> objects;
  CloudPlanes planes;
  try {
    extraction.setInputCloud(cloud.cloud);
    if (has_objects)
      extraction.extract(objects);
    planes = findPlanes(cloud.cloud, cloud.table.voxel_grid[0], cloud.origin,
                        arguments.plane);
  }
  catch (const BadInputException& error) { // the extraction does not know the file
    fail<BadInputException>(arguments.input, ": ", error.what());
  }
  std::vector<std::uint32_t> numbers(cloud.cloud->size(), 0);
  for (std::uint32_t o = 0; o < objects.size(); ++o)
    for (const pcl::index_t i : objects[o].indices)
      numbers[std::size_t(i)] = o + 1;
  const auto membersOf = [](const std::vector<std::uint32_t>& each) {
    return each.size() - std::size_t(std::count(each.begin(), each.end(), 0u));
  };
  const std::vector<ObjectSummary> summaries = summarize(objects, cloud);
  if (!arguments.objects.empty())
    writeObjects(arguments.objects, summaries, label_set);
  if (!arguments.boxes.empty())
    writeBoxes(arguments.boxes, summaries, label_set);
  if (!arguments.planes.empty())
    writePlanes(arguments.planes, planes.planes, label_set);
  if (!arguments.polygons.empty())
    writePolygons(arguments.polygons, planes.planes, label_set);
  PcdTable table = cloud.table;
  if (has_objects)
    table.setColumn("object", numbers);
  table.setColumn("plane", planes.numbers);
  writeCloudTable(arguments.output, table);
  printResults({{"objects", objects.size()},
                {"members", membersOf(numbers)},
                {"planes", planes.planes.size()},
                {"members_of_planes", membersOf(planes.numbers)},
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
