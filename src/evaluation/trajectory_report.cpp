// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/evaluation/trajectory_report.h>

#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdio>

namespace pcl_semantic {

namespace {

using Json = nlohmann::ordered_json;

template <typename... Values>
std::string
formatted(const char* format, Values... values)
{
  char line[160];
  std::snprintf(line, sizeof line, format, values...);
  return line;
}

double
percent(const SegmentErrors& each)
{
  return 100.0 * each.translation;
}

double
degrees(const SegmentErrors& each)
{
  return each.rotation * 180.0 / M_PI;
}

std::string
lineOf(const char* name, const AbsoluteErrors& errors)
{
  return formatted("%-16s mean %.4f m, rms %.4f m, largest %.4f m, last %.4f m\n", name,
                   errors.mean, errors.rms, errors.largest, errors.last);
}

Json
jsonOf(const AbsoluteErrors& errors)
{
  return {{"mean", errors.mean},
          {"rms", errors.rms},
          {"largest", errors.largest},
          {"last", errors.last}};
}

} // namespace

std::string
trajectoryTable(const TrajectoryErrors& errors)
{
  std::string text =
      formatted("%zu poses, %.1f m\n\n%8s %9s %14s %16s\n", errors.poses, errors.length,
                "length", "pieces", "translation %", "rotation deg/m");
  for (const SegmentErrors& each : errors.pieces) {
    const std::string name =
        each.length > 0.0 ? formatted("%g m", each.length) : std::string("all");
    if (each.segments > 0)
      text += formatted("%8s %9zu %14.4f %16.5f\n", name.c_str(), each.segments,
                        percent(each), degrees(each));
    else
      text += formatted("%8s %9zu %14s %16s\n", name.c_str(), each.segments, "-", "-");
  }
  return text + "\n" + lineOf("from the start:", errors.from_start) +
         lineOf("aligned:", errors.aligned);
}

std::string
trajectoryJson(const TrajectoryErrors& errors)
{
  Json json = {{"poses", errors.poses}, {"length", errors.length}};
  json["pieces"] = Json::array();
  for (const SegmentErrors& each : errors.pieces) {
    Json piece = {{"length", each.length > 0.0 ? Json(each.length) : Json("all")},
                  {"pieces", each.segments}};
    piece["translation_percent"] = percent(each); // NaN becomes null
    piece["rotation_degrees_per_metre"] = degrees(each);
    json["pieces"].push_back(piece);
  }
  json["from_start"] = jsonOf(errors.from_start);
  json["aligned"] = jsonOf(errors.aligned);
  return json.dump(2) + "\n";
}

} // namespace pcl_semantic
