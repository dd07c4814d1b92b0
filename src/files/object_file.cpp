// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/files/object_file.h>

#include "core/fail.h"
#include "json_object.h"
#include "ply_lines.h"

#include <limits>

namespace pcl_semantic {

namespace {

using Json = nlohmann::ordered_json;

Json
toJson(const ObjectSummary& object, const LabelSet& label_set)
{
  Json json = entryOf(object.id, object.label, label_set);
  if (!object.probabilities.empty())
    json["probabilities"] = object.probabilities;
  json["points"] = object.points;
  json["centre"] = jsonOf(object.centre);
  json["box"] = {{"min", jsonOf(object.box.min())}, {"max", jsonOf(object.box.max())}};
  json["yaw_box"] = {{"centre", jsonOf(object.yaw_box.centre)},
                     {"size", jsonOf(object.yaw_box.size)},
                     {"yaw", object.yaw_box.yaw}};
  if (const auto& track = object.track) {
    json["first_frame"] = track->first_frame;
    json["last_frame"] = track->last_frame;
    json["frames"] = track->frames;
    json["state"] = track->moving ? "moving" : "still";
    json["motion"] = jsonOf(track->motion);
    if (track->speed >= 0.0) // false for NaN
      json["speed"] = track->speed;
  }
  return json;
}

ObjectTrack
trackFrom(const JsonObject& json)
{
  ObjectTrack track;
  track.first_frame = json.frame("first_frame");
  track.last_frame = json.frame("last_frame");
  track.frames = json.frame("frames", 1);
  const std::string state = json.text("state");
  if (state != "still" && state != "moving")
    json.refuse("state", json.at("state"), "still or moving");
  track.moving = state == "moving";
  track.motion = json.vector("motion");
  if (json.has("speed"))
    track.speed = json.notNegative("speed");
  return track;
}

YawBox
yawBoxFrom(const JsonObject& json)
{
  YawBox box;
  box.centre = json.vector("centre");
  box.size = json.vector("size");
  if (!(box.size.array() >= 0.0).all())
    json.refuse("size", json.at("size"), "numbers of 0 or more");
  box.yaw = json.number("yaw");
  return box;
}

ObjectSummary
objectFrom(const JsonObject& json, const LabelSet& label_set)
{
  ObjectSummary object;
  json.readEntry(object, 1u, label_set);
  if (json.has("probabilities"))
    for (const double each :
         json.numbers("probabilities", std::size_t(label_set.size()))) {
      if (!(each >= 0.0 && each < 1.001)) // rounded
        json.refuse("probabilities", each, "0 to 1");
      object.probabilities.push_back(float(each));
    }
  object.points =
      json.whole("points", std::size_t(0), std::numeric_limits<std::size_t>::max());
  object.centre = json.vector("centre");
  const JsonObject box = json.object("box");
  object.box = {box.vector("min"), box.vector("max")};
  object.yaw_box = yawBoxFrom(json.object("yaw_box"));
  if (json.has("frames"))
    object.track = trackFrom(json);
  return object;
}

} // namespace

void
writeObjects(const std::string& path, const std::vector<ObjectSummary>& objects,
             const LabelSet& label_set)
{
  Json list = Json::array();
  for (const ObjectSummary& object : objects)
    list.push_back(toJson(object, label_set));
  writeList(path, "objects", list);
}

std::vector<ObjectSummary>
readObjects(const std::string& path, const LabelSet& label_set)
{
  return readList<ObjectSummary>(path, "objects", [&](const JsonObject& json) {
    return objectFrom(json, label_set);
  });
}

void
writeBoxes(const std::string& path, const std::vector<ObjectSummary>& objects,
           const LabelSet& label_set)
{
  PlyLines lines;
  for (const ObjectSummary& object : objects) {
    const std::size_t first = lines.corners.size();
    for (const Eigen::Vector3d& corner : object.yaw_box.corners())
      lines.corners.push_back({corner, colourOf(object.label, label_set)});
    for (const auto& [from, to] : YawBox::edges)
      lines.edges.emplace_back(first + from, first + to);
  }
  writePlyLines(path, lines);
}

} // namespace pcl_semantic
