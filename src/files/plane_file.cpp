// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/files/plane_file.h>

#include "core/fail.h"
#include "json_object.h"
#include "ply_lines.h"

#include <cmath>
#include <limits>

namespace pcl_semantic {

namespace {

using Json = nlohmann::ordered_json;

Json
toJson(const PlaneRing& ring)
{
  Json json = Json::array();
  for (const Eigen::Vector3d& corner : ring)
    json.push_back(jsonOf(corner));
  return json;
}

Json
toJson(const PlanePolygon& polygon)
{
  Json holes = Json::array();
  for (const PlaneRing& hole : polygon.holes)
    holes.push_back(toJson(hole));
  return {{"outer", toJson(polygon.outer)}, {"holes", holes}};
}

Json
toJson(const PlaneSummary& plane, const LabelSet& label_set)
{
  Json json = entryOf(plane.id, plane.label, label_set);
  json["points"] = plane.points;
  json["normal"] = jsonOf(plane.normal);
  json["offset"] = plane.offset;
  json["area"] = plane.area;
  json["polygons"] = Json::array();
  for (const PlanePolygon& polygon : plane.polygons)
    json["polygons"].push_back(toJson(polygon));
  return json;
}

PlaneRing
ringFrom(const nlohmann::json& list, const std::string& place)
{
  if (!list.is_array() || list.size() < 3)
    badInput(place, ": got ", textOf(list), ", expected three or more corners");
  PlaneRing ring;
  for (std::size_t i = 0; i < list.size(); ++i)
    ring.emplace_back(
        numbersFrom(list[i], place + "[" + std::to_string(i) + "]", 3).data());
  return ring;
}

PlanePolygon
polygonFrom(const JsonObject& json)
{
  PlanePolygon polygon;
  polygon.outer = ringFrom(json.at("outer"), json.placeOf("outer"));
  json.forEach("holes", [&](const nlohmann::json& hole, const std::string& place) {
    polygon.holes.push_back(ringFrom(hole, place));
  });
  return polygon;
}

PlaneSummary
planeFrom(const JsonObject& json, const LabelSet& label_set)
{
  PlaneSummary plane;
  json.readEntry(plane, 0u, label_set);
  plane.points =
      json.whole("points", std::size_t(0), std::numeric_limits<std::size_t>::max());
  plane.normal = json.vector("normal");
  if (!(std::abs(plane.normal.norm() - 1.0) < 1e-3)) // rounded
    json.refuse("normal", json.at("normal"), "a vector of length 1");
  plane.offset = json.number("offset");
  plane.area = json.notNegative("area");
  json.forEach("polygons",
               [&](const nlohmann::json& polygon, const std::string& place) {
                 plane.polygons.push_back(polygonFrom(JsonObject(polygon, place)));
               });
  return plane;
}

void
addRing(const PlaneRing& ring, const LabelColour& colour, PlyLines& lines)
{
  const std::size_t first = lines.corners.size();
  for (std::size_t i = 0; i < ring.size(); ++i) {
    lines.corners.push_back({ring[i], colour});
    lines.edges.emplace_back(first + i, first + (i + 1) % ring.size());
  }
}

} // namespace

void
writePlanes(const std::string& path, const std::vector<PlaneSummary>& planes,
            const LabelSet& label_set)
{
  Json list = Json::array();
  for (const PlaneSummary& plane : planes)
    list.push_back(toJson(plane, label_set));
  writeList(path, "planes", list);
}

std::vector<PlaneSummary>
readPlanes(const std::string& path, const LabelSet& label_set)
{
  return readList<PlaneSummary>(path, "planes", [&](const JsonObject& json) {
    return planeFrom(json, label_set);
  });
}

void
writePolygons(const std::string& path, const std::vector<PlaneSummary>& planes,
              const LabelSet& label_set)
{
  PlyLines lines;
  for (const PlaneSummary& plane : planes)
    for (const PlanePolygon& polygon : plane.polygons) {
      addRing(polygon.outer, colourOf(plane.label, label_set), lines);
      for (const PlaneRing& hole : polygon.holes)
        addRing(hole, colourOf(plane.label, label_set), lines);
    }
  writePlyLines(path, lines);
}

} // namespace pcl_semantic
