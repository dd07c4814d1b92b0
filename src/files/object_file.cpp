// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/files/object_file.h>

#include "core/text_stream.h"

#include <pcl_semantic/files/atomic_file.h>

#include <nlohmann/json.hpp>

#include <array>
#include <utility>

namespace pcl_semantic {

namespace {

using Json = nlohmann::ordered_json;

Json
toJson(const Eigen::Vector3d& vector)
{
  return {vector.x(), vector.y(), vector.z()};
}

Json
toJson(const ObjectSummary& object, const LabelSet& label_set)
{
  Json json = {{"id", object.id}, {"label", int(object.label)}};
  if (label_set.size() > 0)
    json["class"] = label_set[object.label].name;
  if (!object.probabilities.empty())
    json["probabilities"] = object.probabilities;
  json["points"] = object.points;
  json["centre"] = toJson(object.centre);
  json["box"] = {{"min", toJson(object.box.min())}, {"max", toJson(object.box.max())}};
  json["yaw_box"] = {{"centre", toJson(object.yaw_box.centre)},
                     {"size", toJson(object.yaw_box.size)},
                     {"yaw", object.yaw_box.yaw}};
  if (const auto& track = object.track) {
    json["first_frame"] = track->first_frame;
    json["last_frame"] = track->last_frame;
    json["frames"] = track->frames;
    json["state"] = track->moving ? "moving" : "still";
    json["motion"] = toJson(track->motion);
    if (track->speed >= 0.0) // false for NaN
      json["speed"] = track->speed;
  }
  return json;
}

constexpr std::array<std::pair<int, int>, 12> kEdges{{{0, 1},
                                                      {1, 2},
                                                      {2, 3},
                                                      {3, 0},
                                                      {4, 5},
                                                      {5, 6},
                                                      {6, 7},
                                                      {7, 4},
                                                      {0, 4},
                                                      {1, 5},
                                                      {2, 6},
                                                      {3, 7}}};

} // namespace

void
writeObjects(const std::string& path, const std::vector<ObjectSummary>& objects,
             const LabelSet& label_set)
{
  Json list = Json::array();
  for (const ObjectSummary& object : objects)
    list.push_back(toJson(object, label_set));
  writeTextFile(path, Json{{"objects", list}}.dump(1) + "\n");
}

void
writeBoxes(const std::string& path, const std::vector<ObjectSummary>& objects,
           const LabelSet& label_set)
{
  TextStream text;
  text << "ply\nformat ascii 1.0\nelement vertex " << 8 * objects.size()
       << "\nproperty double x\nproperty double y\nproperty double z\nproperty uchar "
          "red\nproperty uchar green\nproperty uchar blue\nelement edge "
       << kEdges.size() * objects.size()
       << "\nproperty int vertex1\nproperty int vertex2\nend_header\n";
  text.precision(9);
  for (const ObjectSummary& object : objects) {
    std::array<std::uint8_t, 3> colour{255, 255, 255};
    if (label_set.size() > 0)
      colour = label_set[object.label].colour;
    for (const Eigen::Vector3d& corner : object.yaw_box.corners())
      text << corner.x() << " " << corner.y() << " " << corner.z() << " "
           << int(colour[0]) << " " << int(colour[1]) << " " << int(colour[2]) << "\n";
  }
  for (std::size_t i = 0; i < objects.size(); ++i)
    for (const auto& [from, to] : kEdges)
      text << 8 * i + std::size_t(from) << " " << 8 * i + std::size_t(to) << "\n";
  writeTextFile(path, text.str());
}

} // namespace pcl_semantic
