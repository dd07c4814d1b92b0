// SPDX-License-Identifier: BSD-3-Clause
#include "files/pcd_file.h"
#include "support/bad_case.h"
#include "support/mapped_street.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace pcl_semantic {

namespace {

// Two cars 2 m apart on a road, as an ascii cloud.
std::string
street(const TemporaryFolder& folder)
{
  std::string text;
  int points = 0;
  const auto add = [&](double x, double y, double z, int label) {
    text += std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(z) +
            " " + std::to_string(label) + "\n";
    ++points;
  };
  for (const double begin : {10.0, 16.0})
    for (double x = 0.0; x < 4.0; x += 0.25)
      for (double y = 0.0; y < 1.6; y += 0.25)
        add(begin + x, y, 1.0, 6);
  for (double x = 8.0; x < 22.0; x += 0.25)
    add(x, 0.5, 0.0, 3);
  const std::string size = std::to_string(points);
  return folder.write("street.pcd", "VERSION 0.7\nFIELDS x y z label\nSIZE 4 4 4 4\n"
                                    "TYPE F F F U\nCOUNT 1 1 1 1\nWIDTH " +
                                        size + "\nHEIGHT 1\nPOINTS " + size +
                                        "\nDATA ascii\n" + text);
}

const std::string label_set = " --label-set " + std::string(PCL_SEMANTIC_SOURCE_DIR) +
                              "/data/label_sets/kitti11.yaml";

} // namespace

TEST(ThingsTool, NumbersTwoCars)
{
  const TemporaryFolder folder;
  const std::string text = succeed(
      "things " + street(folder) + " " + folder.path("out.pcd") + label_set +
      " --objects " + folder.path("o.json") + " --boxes " + folder.path("boxes.ply"));
  EXPECT_TRUE(holds(text, "objects: 2\nmembers: 224\n")) << text;
  const PcdTable table = readPcd(folder.path("out.pcd"));
  const PcdColumn object(table, table.find("object"));
  EXPECT_EQ(object(0), 1.0);
  EXPECT_EQ(object(223), 2.0);
  EXPECT_EQ(object(224), 0.0) << "road";
  const auto objects = nlohmann::json::parse(bytesOf(folder.path("o.json")))["objects"];
  ASSERT_EQ(objects.size(), 2u);
  EXPECT_EQ(objects[1]["id"], 2);
  EXPECT_EQ(objects[1]["class"], "car");
  EXPECT_EQ(objects[1]["points"], 112);
  EXPECT_NEAR(objects[1]["yaw_box"]["size"][0].get<double>(), 3.75, 1e-5);
  EXPECT_NEAR(objects[1]["yaw_box"]["size"][1].get<double>(), 1.5, 1e-5);
  EXPECT_NEAR(objects[1]["yaw_box"]["yaw"].get<double>(), 0.0, 1e-5);
  EXPECT_NEAR(objects[1]["box"]["min"][0].get<double>(), 16.0, 1e-5);
  EXPECT_TRUE(holds(bytesOf(folder.path("boxes.ply")), "element vertex 16\n"));
  EXPECT_TRUE(holds(bytesOf(folder.path("boxes.ply")), "element edge 24\n"));
  EXPECT_TRUE(holds(succeed("things " + street(folder) + " " + folder.path("one.pcd") +
                            label_set + " --gap 2.5"),
                    "objects: 1\n"));
  EXPECT_TRUE(holds(succeed("things " + street(folder) + " " + folder.path("none.pcd") +
                            label_set + " --min-points 113"),
                    "objects: 0\n"));
}

TEST(ThingsTool, RefusesInOneLine)
{
  const TemporaryFolder folder;
  const std::string in = street(folder), out = " " + folder.path("no.pcd");
  expectFails("things " + in, 2, "expected IN OUT.pcd");
  expectFails("things " + in + out + " --gap 0", 2, "gap of objects: 0 m");
  expectFails("things " + in + out + " --min-points 0", 2, "--min-points is 0");
  expectFails(
      "things " + in + out + " --objects " + folder.path("o.json") + " --label-set " +
          folder.write("set.yaml", replaceAll(bytesOf(kitti11), ", thing: true", "")),
      3, "no class is marked thing, so there is no field object");
  expectFails("things " + in + out + " --label-set " +
                  folder.write("few.yaml", "classes:\n  - {name: car, colour: [1, 2, "
                                           "3], thing: true}\n"),
              3, "point 0 has label 6, expected 0 to 1");
  expectFails("things " + in + out + " --label-set " +
                  folder.write("gap.yaml", "classes:\n  - {name: car, colour: [1, 2, "
                                           "3], gap: 1}\n"),
              3, "is only for classes with thing: true");
  EXPECT_FALSE(std::filesystem::exists(folder.path("no.pcd")));
}

TEST(ThingsOfAMap, AreInAllOutputs)
{
  const TemporaryFolder folder;
  const std::string street = folder.path("street"), map = folder.path("map");
  copyStreet(street);
  addScan(street);
  succeed(
      mapOf(street) + " --output " + map +
      " --things --voxel-size 0.25 --object-min-voxels 5 --also scans --frames 0:1");
  const auto objects = readJson(map + "/objects.json")["objects"];
  ASSERT_GT(objects.size(), 0u);
  EXPECT_EQ(readJson(map + "/summary.json")["objects"], objects.size());
  EXPECT_TRUE(holds(bytesOf(map + "/boxes.ply"),
                    "element edge " + std::to_string(12 * objects.size()) + "\n"));
  const PcdTable table = readPcd(map + "/map.pcd");
  const PcdColumn object(table, table.find("object"));
  std::map<std::uint32_t, std::size_t> points;
  for (std::size_t i = 0; i < table.width; ++i)
    ++points[std::uint32_t(object(i))];
  for (const auto& each : objects) {
    EXPECT_EQ(points[each["id"]], each["points"].get<std::size_t>());
    EXPECT_EQ(each["first_frame"], 0);
    EXPECT_EQ(each["frames"], 1);
    EXPECT_EQ(each["state"], "still");
  }
  EXPECT_EQ(points.size() - points.count(0), objects.size());
  EXPECT_EQ(bytesOf(map + "/scan_labels/000000.label").size(), 8u);
}

TEST(PlanesOfAMap, AreThoseOfItsCloudAndOfItsArchive)
{
  const TemporaryFolder folder;
  const std::string map = folder.path("map"), archive = folder.path("a.map");
  succeed(mapOf(tinyStreet()) + " --output " + map + " --archive " + archive);
  const auto planes = readJson(map + "/planes.json")["planes"];
  ASSERT_GT(planes.size(), 0u);
  succeed("things " + map + "/map.pcd " + folder.path("t.pcd") + " --planes " +
          folder.path("t.json") + " --label-set " + map + "/label_set.yaml");
  EXPECT_EQ(readJson(folder.path("t.json"))["planes"], planes);
  const PcdTable table = readPcd(folder.path("t.pcd"));
  const PcdColumn column(table, table.find("plane"));
  std::map<std::uint32_t, std::size_t> points;
  for (std::size_t i = 0; i < table.width; ++i)
    ++points[std::uint32_t(column(i))];
  for (const auto& each : planes)
    EXPECT_EQ(points[each["id"]], each["points"].get<std::size_t>());
  succeed("archive export " + archive + " " + folder.path("e.pcd") + " --planes " +
          folder.path("e.json") + " --polygons " + folder.path("e.ply"));
  EXPECT_EQ(readJson(folder.path("e.json"))["planes"], planes);
  EXPECT_EQ(bytesOf(folder.path("e.ply")), bytesOf(map + "/planes.ply"));
  EXPECT_EQ(bytesOf(folder.path("e.pcd")), bytesOf(map + "/map.pcd"));
  const PcdTable of_map = readPcd(map + "/map.pcd");
  const PcdColumn numbers(of_map, of_map.find("plane"));
  for (std::size_t i = 0; i < of_map.width; ++i)
    ASSERT_EQ(numbers(i), column(i)) << i;
  succeed(mapOf(tinyStreet()) + " --no-things --output " + folder.path("none"));
  EXPECT_FALSE(std::filesystem::exists(folder.path("none/planes.json")));
}

TEST(ThingsOfAMap, NeedAClassMarkedThing)
{
  const TemporaryFolder folder;
  const std::string set =
      folder.write("set.yaml", replaceAll(bytesOf(kitti11), ", thing: true", ""));
  expectFails(mapOf(tinyStreet()) + " --things --label-set " + set + " --output " +
                  folder.path("map"),
              2, "--things has no effect with a label set without things");
  succeed(mapOf(tinyStreet()) + " --label-set " + set + " --output " +
          folder.path("map"));
  EXPECT_FALSE(std::filesystem::exists(folder.path("map/objects.json")));
  const auto planes = readJson(folder.path("map/planes.json"))["planes"];
  EXPECT_GT(planes.size(), 0u);
  succeed("things " + folder.path("map/map.pcd") + " " + folder.path("t.pcd") +
          " --planes " + folder.path("t.json") + " --label-set " + set);
  EXPECT_EQ(readJson(folder.path("t.json"))["planes"], planes);
}

} // namespace pcl_semantic
