// SPDX-License-Identifier: BSD-3-Clause
#include "support/bad_case.h"
#include "support/mapped_street.h"
#include "support/tiny_street.h"

#include <gtest/gtest.h>

namespace pcl_semantic {

namespace {

const std::string knots = "knots:\n  height: [0, 0.5, 2]\n";
const std::string classes =
    "classes:\n  road:\n    bias: 0.4\n    height: [1, -1, -2]\n"
    "  sidewalk:\n    height: [0.5, 0.5, -1]\n"
    "  building:\n    height: [-1, 0, 1]\n"
    "  vegetation:\n    bias: -0.5\n";

} // namespace

TEST(CalibratedMap, AppliesTheCalibrationBeforeFusion)
{
  const TemporaryFolder folder;
  const std::string street = tinyStreet();
  mapStreet(street, folder.path("plain"), "--crf none");
  folder.write("c.yaml",
               "sharpness: 0.5\nground: [road, sidewalk]\n" + knots + classes);
  mapStreet(street, folder.path("calibrated"),
            "--crf none --label-calibration " + folder.path("c.yaml"));
  EXPECT_NE(bytesOf(folder.path("plain/labels_at_depth/000002.png")),
            bytesOf(folder.path("calibrated/labels_at_depth/000002.png")));
  const auto summary = readJson(folder.path("calibrated/summary.json"));
  EXPECT_EQ(summary["inputs"]["label_calibration"], folder.path("c.yaml"));
  EXPECT_FALSE(summary.contains("domain_shift"));
  // The identity changes nothing.
  folder.write("same.yaml", "sharpness: 1\nground: []\nknots: {}\nclasses: {}\n");
  mapStreet(street, folder.path("same"),
            "--crf none --label-calibration " + folder.path("same.yaml"));
  EXPECT_EQ(bytesOf(folder.path("plain/map.pcd")),
            bytesOf(folder.path("same/map.pcd")));
}

// Its training data were trees at the ground.
TEST(CalibratedMap, WarnsOfASequenceUnlikeTheTrainingData)
{
  const TemporaryFolder folder;
  folder.write(
      "wood.yaml",
      "sharpness: 0.5\nground: [road, sidewalk]\n" + knots + classes +
          "seen:\n  usual_distance: 0.2\n  height:\n    vegetation: [1, 0, 0]\n");
  const std::string text =
      succeed(mapOf(tinyStreet()) + " --output " + folder.path("map") +
              " --label-calibration " + folder.path("wood.yaml"));
  EXPECT_TRUE(holds(text, "wood.yaml: was learned from data unlike this sequence"));
  EXPECT_GT(readJson(folder.path("map/summary.json"))["domain_shift"], 1.0);
}

TEST(CalibratedMap, BadInput)
{
  const auto calibration = [](const std::string& text) {
    return
        [=](const std::string& street) { std::ofstream(street + "/c.yaml") << text; };
  };
  const std::string map = "--labels STREET/labels --label-calibration STREET/c.yaml";
  expectAllFail({
      {3, "c.yaml", map + " --archive TEMP/a.map"},
      {3, "c.yaml line 1: is a calibration of 'cliques', expected of pixels", map,
       calibration("of: cliques\nsharpness: 1\nground: []\n")},
      {2, "unrecognised option '--clique-calibration'",
       map + " --clique-calibration x"},
  });
}

} // namespace pcl_semantic
