// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/files/object_file.h>

#include "core/fail.h"
#include "core/text_stream.h"

#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/files/input_file.h>

#include <nlohmann/json.hpp>

#include <array>
#include <cstdint>
#include <limits>
#include <set>
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

// An object of a JSON file. Messages name the file and the key.
class JsonObject {
public:
  // \param[in] place file and key of the object
  JsonObject(const nlohmann::json& json, std::string place)
      : json_(json), place_(std::move(place))
  {
    if (!json.is_object())
      badInput(place_, ": got ", textOf(json), ", expected an object");
  }

  bool
  has(const char* key) const
  {
    return json_.contains(key);
  }

  const nlohmann::json&
  at(const char* key) const
  {
    if (!has(key))
      badInput(place_, ": has no ", key);
    return json_[key];
  }

  JsonObject
  object(const char* key) const
  {
    return {at(key), place_ + "." + key};
  }

  template <typename Number>
  Number
  whole(const char* key, Number least, Number most) const
  {
    const nlohmann::json& value = at(key);
    if (!value.is_number_unsigned() || value.get<std::uint64_t>() < least ||
        value.get<std::uint64_t>() > most)
      refuse(key, value, least, " to ", most);
    return Number(value.get<std::uint64_t>());
  }

  int
  frame(const char* key, unsigned least = 0) const
  {
    return int(whole(key, least, unsigned(std::numeric_limits<int>::max())));
  }

  double
  number(const char* key) const
  {
    if (!at(key).is_number())
      refuse(key, at(key), "a number");
    return at(key).get<double>();
  }

  double
  notNegative(const char* key) const
  {
    if (number(key) < 0.0)
      refuse(key, at(key), "0 or more");
    return number(key);
  }

  // \param[in] count of numbers; 0 = any
  std::vector<double>
  numbers(const char* key, std::size_t count) const
  {
    const nlohmann::json& list = at(key);
    bool is_good = list.is_array() && (count == 0 || list.size() == count);
    for (std::size_t i = 0; is_good && i < list.size(); ++i)
      is_good = list[i].is_number();
    if (!is_good && count > 0)
      refuse(key, list, count, " numbers");
    if (!is_good)
      refuse(key, list, "numbers");
    return list.get<std::vector<double>>();
  }

  Eigen::Vector3d
  vector(const char* key) const
  {
    return Eigen::Vector3d(numbers(key, 3).data());
  }

  std::string
  text(const char* key) const
  {
    if (!at(key).is_string())
      refuse(key, at(key), "a text");
    return at(key).get<std::string>();
  }

  template <typename... Parts>
  [[noreturn]] void
  refuse(const char* key, const nlohmann::json& value, const Parts&... expected) const
  {
    badInput(place_, ".", key, ": got ", textOf(value), ", expected ", expected...);
  }

private:
  static std::string
  textOf(const nlohmann::json& value)
  {
    if (value.is_array())
      return "a list of " + std::to_string(value.size());
    if (value.is_object())
      return "an object";
    constexpr std::size_t most = 60; // letters
    const std::string text = value.dump();
    return text.size() > most ? text.substr(0, most) + "..." : text;
  }

  const nlohmann::json& json_;
  std::string place_;
};

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
  const unsigned classes = label_set.size() > 0 ? unsigned(label_set.size()) : 255;
  ObjectSummary object;
  object.id = json.whole("id", 1u, std::numeric_limits<std::uint32_t>::max());
  object.label = Label(json.whole("label", 1u, classes));
  if (label_set.size() > 0 && json.has("class") &&
      json.text("class") != label_set[object.label].name)
    json.refuse("class", json.at("class"), label_set[object.label].name,
                ", the name of label ", int(object.label), " in the label set");
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

nlohmann::json
readJson(const std::string& path)
{
  const std::vector<std::uint8_t> bytes = readBytes(path);
  try {
    return nlohmann::json::parse(bytes.begin(), bytes.end());
  }
  catch (const nlohmann::json::parse_error& error) {
    badInput(path, ": byte ", error.byte, " is no JSON");
  }
  catch (const nlohmann::json::exception&) {
    badInput(path, ": a number is out of range");
  }
}

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

std::vector<ObjectSummary>
readObjects(const std::string& path, const LabelSet& label_set)
{
  const nlohmann::json json = readJson(path);
  const nlohmann::json& list = JsonObject(json, path).at("objects");
  if (!list.is_array())
    badInput(path, ": objects is no list");
  std::vector<ObjectSummary> objects;
  std::set<std::uint32_t> numbers;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const std::string place = path + ": objects[" + std::to_string(i) + "]";
    objects.push_back(objectFrom(JsonObject(list[i], place), label_set));
    if (!numbers.insert(objects.back().id).second)
      badInput(place, ".id: got ", objects.back().id, ", which an earlier object has");
  }
  return objects;
}

void
writeBoxes(const std::string& path, const std::vector<ObjectSummary>& objects,
           const LabelSet& label_set)
{
  TextStream text;
  text << "ply\nformat ascii 1.0\nelement vertex " << 8 * objects.size()
       << "\nproperty double x\nproperty double y\nproperty double z\nproperty uchar "
          "red\nproperty uchar green\nproperty uchar blue\nelement edge "
       << YawBox::edges.size() * objects.size()
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
    for (const auto& [from, to] : YawBox::edges)
      text << 8 * i + from << " " << 8 * i + to << "\n";
  writeTextFile(path, text.str());
}

} // namespace pcl_semantic
