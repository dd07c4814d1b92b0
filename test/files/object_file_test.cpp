// SPDX-License-Identifier: BSD-3-Clause
#include "support/temporary_folder.h"
#include "support/thrown_message.h"

#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/files/object_file.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>

namespace pcl_semantic {

namespace {

using Json = nlohmann::json;

const LabelSet two_classes({{"road", {1, 2, 3}, false, false},
                            {"car", {4, 5, 6}, false, false}});

// One object without a track, and two with tracks, one of unknown speed.
std::vector<ObjectSummary>
threeObjects()
{
  std::vector<ObjectSummary> objects;
  for (std::uint32_t id : {1u, 7u, 4294967295u}) {
    objects.push_back(summarizeObject({{0.1, -2.0, 1e5}, {4.3, 1.0 / 3.0, 1e5 + 1.5}}));
    objects.back().id = id;
    objects.back().label = Label(id == 7 ? 1 : 2);
  }
  objects[0].probabilities = {0.1f, 0.9f};
  objects[1].track = ObjectTrack{3, 9, 5, true, {0.7, -0.1, 0.0}, 7.1};
  objects[2].track = ObjectTrack{0, 0, 1, false, Eigen::Vector3d::Zero(), NAN};
  return objects;
}

void
expectEqual(const ObjectSummary& a, const ObjectSummary& b)
{
  EXPECT_EQ(a.id, b.id);
  EXPECT_EQ(a.label, b.label);
  EXPECT_EQ(a.probabilities, b.probabilities);
  EXPECT_EQ(a.points, b.points);
  EXPECT_EQ(a.centre, b.centre);
  EXPECT_EQ(a.box.min(), b.box.min());
  EXPECT_EQ(a.box.max(), b.box.max());
  EXPECT_EQ(a.yaw_box.centre, b.yaw_box.centre);
  EXPECT_EQ(a.yaw_box.size, b.yaw_box.size);
  EXPECT_EQ(a.yaw_box.yaw, b.yaw_box.yaw);
  ASSERT_EQ(a.track.has_value(), b.track.has_value());
  if (!a.track)
    return;
  EXPECT_EQ(a.track->first_frame, b.track->first_frame);
  EXPECT_EQ(a.track->last_frame, b.track->last_frame);
  EXPECT_EQ(a.track->frames, b.track->frames);
  EXPECT_EQ(a.track->moving, b.track->moving);
  EXPECT_EQ(a.track->motion, b.track->motion);
  EXPECT_TRUE(a.track->speed == b.track->speed ||
              (std::isnan(a.track->speed) && std::isnan(b.track->speed)));
}

} // namespace

TEST(ObjectFile, ComesBackUnchanged)
{
  const TemporaryFolder folder;
  const std::string path = folder.path("objects.json");
  const std::vector<ObjectSummary> objects = threeObjects();
  for (const LabelSet& label_set : {two_classes, LabelSet()}) {
    writeObjects(path, objects, label_set);
    const std::vector<ObjectSummary> read = readObjects(path, label_set);
    ASSERT_EQ(read.size(), objects.size());
    for (std::size_t i = 0; i < read.size(); ++i)
      expectEqual(read[i], objects[i]);
  }
  writeObjects(path, {}, two_classes);
  EXPECT_TRUE(readObjects(path, two_classes).empty());
}

TEST(ObjectFile, RefusesDamageInOneLine)
{
  const TemporaryFolder folder;
  const std::string path = folder.path("objects.json");
  writeObjects(path, threeObjects(), two_classes);
  const std::vector<std::uint8_t> bytes = readBytes(path);
  const Json whole = Json::parse(bytes.begin(), bytes.end());
  const auto expect = [&](const std::string& message, const std::string& text) {
    folder.write("objects.json", text);
    expectBadInput("objects.json: " + message, [&] { readObjects(path, two_classes); });
  };
  expect("byte 1 is no JSON", "");
  expect("a number is out of range", "[1e999]");
  expect("got a list of 0, expected an object", "[]");
  expect("has no objects", "{}");
  expect("objects: got 3, expected a list", "{\"objects\": 3}");
  expect("objects[0]: got null, expected an object", "{\"objects\": [null]}");

  const std::tuple<const char*, Json, const char*> damages[] = {
      {"/id", 0, "id: got 0, expected 1 to 4294967295"},
      {"/id", 4294967296, "id: got 4294967296, expected 1"},
      {"/id", 7, "id: got 7, which an earlier one has"},
      {"/id", 2.5, "id: got 2.5, expected"},
      {"/label", 3, "label: got 3, expected 1 to 2"},
      {"/label", -1, "label: got -1, expected 1 to 2"},
      {"/class", "road", "class: got \"road\", expected car, the name of label 2"},
      {"/class", 4, "class: got 4, expected a text"},
      {"/probabilities", {1.0}, "probabilities: got a list of 1, expected 2 numbers"},
      {"/probabilities", {2, 0.5}, "probabilities: got 2.0, expected 0 to 1"},
      {"/points", "many", "points: got \"many\", expected 0 to"},
      {"/centre", {1, 2}, "centre: got a list of 2, expected 3 numbers"},
      {"/centre/1", nullptr, "centre: got a list of 3, expected 3 numbers"},
      {"/box", 1, "box: got 1, expected an object"},
      {"/box/max", true, "box.max: got true, expected 3 numbers"},
      {"/yaw_box/size/2", -1, "yaw_box.size: got a list of 3, expected numbers of 0"},
      {"/yaw_box/yaw", "east", "yaw_box.yaw: got \"east\", expected a number"},
      {"/first_frame", -3, "first_frame: got -3, expected 0 to 2147483647"},
      {"/last_frame", 2147483648, "last_frame: got 2147483648, expected 0"},
      {"/frames", 0, "frames: got 0, expected 1 to"},
      {"/state", "gone", "state: got \"gone\", expected still or moving"},
      {"/motion", Json::object(), "motion: got an object, expected 3 numbers"},
      {"/speed", -0.5, "speed: got -0.5, expected 0 or more"},
      {"/speed", true, "speed: got true, expected a number"}};
  for (const auto& [key, value, message] : damages) {
    Json damaged = whole;
    damaged["objects"][2][Json::json_pointer(key)] = value;
    expect("objects[2]." + std::string(message), damaged.dump());
  }
  for (const char* const key : {"id", "label", "points", "centre", "box", "yaw_box",
                                "first_frame", "last_frame", "state", "motion"}) {
    Json damaged = whole;
    damaged["objects"][2].erase(key);
    expect("objects[2]: has no " + std::string(key), damaged.dump());
  }
  Json wordy = whole;
  wordy["objects"][1]["state"] = std::string(100, 'x');
  expect("objects[1].state: got \"" + std::string(59, 'x') + "..., expected",
         wordy.dump());
  Json more = whole; // for later versions
  more["objects"][0]["covariance"] = {1, 2};
  folder.write("objects.json", more.dump());
  EXPECT_EQ(readObjects(path, two_classes).size(), 3u);
  expectBadInput("none.json", [&] { readObjects(folder.path("none.json"), {}); });
}

} // namespace pcl_semantic
