// SPDX-License-Identifier: BSD-3-Clause
#include "support/bad_case.h"
#include "support/mapped_street.h"
#include "support/thrown_message.h"
#include "support/tiny_street.h"

#include <pcl_semantic/files/label_set_file.h>
#include <pcl_semantic/labelling/calibration_fit.h>

#include <gtest/gtest.h>

namespace pcl_semantic {

namespace fs = std::filesystem;

namespace {

const std::string folders = " --labels '{sequence}/labels' --truth '{sequence}/gt' ";

const std::set<std::string> files_of_one = {"calibration.yaml", "report.md"},
                            files_of_two = {"calibration.yaml", "report.md",
                                            "without_one.yaml", "without_two.yaml"};

// Two streets, the second with less ground truth, and their calibrations.
class CalibrateTool : public testing::Test {
protected:
  CalibrateTool()
  {
    for (const char* const name : {"one", "two"})
      copyStreet(folder_.path(name));
    fs::remove(folder_.path("two/gt/000000.png"));
    fs::remove(folder_.path("two/gt/000001.png"));
  }

  std::string
  calibrateStreets(const std::string& options = "")
  {
    return succeed("calibrate " + folder_.path("one ") + folder_.path("two") + folders +
                   "--output " + folder_.path("out") + " " + options);
  }

  // The figures of a row of the report: classes, mean, accuracy, inclusive, coverage.
  std::vector<double>
  rowOf(const std::string& name)
  {
    std::vector<double> figures;
    for (const std::string& line : linesOf(folder_.path("out/report.md")))
      if (line.rfind("| " + name + " | ", 0) == 0) {
        std::istringstream words(replaceAll(line.substr(name.size() + 5), "|", " "));
        for (double figure = 0.0; words >> figure;)
          figures.push_back(figure);
      }
    return figures;
  }

  TemporaryFolder folder_;
};

} // namespace

TEST_F(CalibrateTool, WritesWhatItLearned)
{
  const std::string text = calibrateStreets();
  EXPECT_EQ(filesIn(folder_.path("out")), files_of_two);
  EXPECT_TRUE(holds(text, bytesOf(folder_.path("out/report.md"))));
  const LabelSet label_set = readLabelSet(kitti11);
  std::array<bool, 256> is_there{};
  for (const char* const frame : {"000000", "000001", "000002"}) {
    const cv::Mat truth =
        readPng(folder_.path("one/gt/") + frame + ".png", ImageKind::labels);
    for (const Label label : cv::Mat_<Label>(truth))
      is_there[label] = true;
  }
  const LabelCalibration all =
      readCalibration(folder_.path("out/calibration.yaml"), label_set);
  EXPECT_EQ(all.ground,
            (std::vector<Label>{label_set.find("road"), label_set.find("sidewalk")}));
  for (int l = 0; l < label_set.size(); ++l)
    EXPECT_EQ(all.fitted[std::size_t(l)], is_there[std::size_t(l) + 1]) << l;
  EXPECT_GT(all.sharpness, 0.0f);
  // The calibration without a street equals the one from the other street only.
  succeed("calibrate " + folder_.path("one") + folders + "--output " +
          folder_.path("alone"));
  EXPECT_EQ(filesIn(folder_.path("alone")), files_of_one);
  EXPECT_EQ(bytesOf(folder_.path("alone/calibration.yaml")),
            bytesOf(folder_.path("out/without_two.yaml")));
  // The frames of a range; of an earlier run nothing is left.
  const std::string of_last_frame = bytesOf(folder_.path("out/without_one.yaml"));
  EXPECT_NE(of_last_frame, bytesOf(folder_.path("out/without_two.yaml")));
  succeed("calibrate " + folder_.path("one") + folders + "--frames 2:3 --output " +
          folder_.path("out"));
  EXPECT_EQ(bytesOf(folder_.path("out/calibration.yaml")), of_last_frame);
  EXPECT_EQ(filesIn(folder_.path("out")), files_of_one);
}

TEST_F(CalibrateTool, TakesFeatures)
{
  const LabelSet label_set = readLabelSet(kitti11);
  const auto features = [&](const std::string& options) {
    calibrateStreets(options);
    std::vector<Feature> all;
    const std::string path = folder_.path("out/calibration.yaml");
    const bool of_cliques = options.find("--clique-config") != std::string::npos;
    for (const ClassCurves& curves :
         readCalibration(path, label_set, of_cliques ? "cliques" : "pixels").curves)
      all.push_back(curves.feature);
    return all;
  };
  EXPECT_EQ(features(""), pixelFeatures());
  EXPECT_TRUE(
      holds(bytesOf(folder_.path("out/report.md")), "Features: height,distance,level"));
  EXPECT_EQ(features("--features red,side"),
            (std::vector<Feature>{Feature::side, Feature::red}));
  EXPECT_TRUE(holds(bytesOf(folder_.path("out/report.md")), "Features: red,side"));
  EXPECT_TRUE(features("--features none").empty());
  folder_.write("map.yaml", "crf: hierarchical\ncliques: \"superpixel:50\"\n");
  const std::string config = "--clique-config " + folder_.path("map.yaml ");
  EXPECT_EQ(features(config), cliqueFeatures());
  EXPECT_EQ(features(config + "--features extent"),
            (std::vector<Feature>{Feature::extent}));
}

TEST_F(CalibrateTool, ItsReportAgreesWithPclSemanticEvaluate)
{
  calibrateStreets("--threads 1");
  std::string command =
      "evaluate" + of_kitti11 + "--output " + folder_.path("evaluation");
  for (const std::string name : {"one", "two"}) {
    mapStreet(folder_.path(name), folder_.path(name + "_map"), "--crf none");
    command += " --prediction " + folder_.path(name + "_map/network_labels") +
               " --truth " + folder_.path(name + "/gt");
    if (name == "two") // where there is truth
      for (const char* const frame : {"/000000.png", "/000001.png"})
        fs::remove(folder_.path(name + "_map/network_labels" + frame));
  }
  succeed(command);
  const auto json = readJson(folder_.path("evaluation/metrics.json"));
  const std::vector<double> network = rowOf("the network as it comes");
  ASSERT_GT(network.size(), 4u);
  EXPECT_NEAR(network[network.size() - 4],
              100.0 * json["mean"]["iou_exclusive"].get<double>(), 0.051);
  EXPECT_NEAR(network[network.size() - 3],
              100.0 * json["global_accuracy"].get<double>(), 0.051);
  const std::vector<double> calibrated = rowOf("calibrated, learned from all");
  ASSERT_EQ(calibrated.size(), network.size());
  EXPECT_GT(calibrated[network.size() - 4], network[network.size() - 4]);
  EXPECT_EQ(rowOf("calibrated, learned from the others").size(), network.size());
}

TEST_F(CalibrateTool, TheMapTakesIt)
{
  calibrateStreets();
  const std::string street = folder_.path("one");
  mapStreet(street, folder_.path("plain"), "--crf none");
  mapStreet(street, folder_.path("calibrated"),
            "--crf none --label-calibration " + folder_.path("out/calibration.yaml"));
  EXPECT_NE(bytesOf(folder_.path("plain/labels_at_depth/000002.png")),
            bytesOf(folder_.path("calibrated/labels_at_depth/000002.png")));
  EXPECT_EQ(
      readJson(folder_.path("calibrated/summary.json"))["inputs"]["label_calibration"],
      folder_.path("out/calibration.yaml"));
  // The street is one of those that it has seen.
  EXPECT_LT(readJson(folder_.path("calibrated/summary.json"))["domain_shift"], 1.0);
  EXPECT_FALSE(readJson(folder_.path("plain/summary.json")).contains("domain_shift"));
  // Of another place: all was trees.
  std::string text = bytesOf(folder_.path("out/calibration.yaml"));
  text = text.substr(0, text.find("seen:")) +
         "seen:\n  usual_distance: 0.2\n  height:\n    vegetation: [1, 0, 0, 0, 0, 0, "
         "0, 0, 0, 0, 0]\n  distance: {}\n  level: {}\n";
  folder_.write("wood.yaml", text);
  const std::string wood = succeed(mapOf(street) + " --output " + folder_.path("wood") +
                                   " --label-calibration " + folder_.path("wood.yaml"));
  EXPECT_TRUE(holds(wood, "wood.yaml: was learned from data unlike this sequence"));
  EXPECT_GT(readJson(folder_.path("wood/summary.json"))["domain_shift"], 1.0);
  // It is the identity that changes nothing.
  folder_.write("same.yaml", "sharpness: 1\nground: []\nknots: {}\nclasses: {}\n");
  mapStreet(street, folder_.path("same"),
            "--crf none --label-calibration " + folder_.path("same.yaml"));
  EXPECT_EQ(bytesOf(folder_.path("plain/map.pcd")),
            bytesOf(folder_.path("same/map.pcd")));
}

TEST_F(CalibrateTool, LearnsWhatCliquesAreWorth)
{
  folder_.write("map.yaml",
                "crf: hierarchical\ncliques: \"superpixel:50\"\n"
                "clique_update_from_members: false\nclique_exclude: pole\n");
  const std::string config = " --clique-config " + folder_.path("map.yaml");
  calibrateStreets(config);
  EXPECT_EQ(filesIn(folder_.path("out")), files_of_two);
  const std::string of_cliques = bytesOf(folder_.path("out/calibration.yaml"));
  const std::vector<double> members = rowOf("the mean of the clique's members");
  const std::vector<double> calibrated = rowOf("calibrated, learned from all");
  ASSERT_GT(members.size(), 4u);
  EXPECT_GT(calibrated[members.size() - 4], members[members.size() - 4]);

  const std::string street = folder_.path("one");
  const std::string map = "--config " + folder_.path("map.yaml");
  mapStreet(street, folder_.path("plain"), map);
  mapStreet(street, folder_.path("calibrated"),
            map + " --clique-calibration " + folder_.path("out/calibration.yaml"));
  EXPECT_NE(bytesOf(folder_.path("plain/labels/000002.png")),
            bytesOf(folder_.path("calibrated/labels/000002.png")));
  EXPECT_EQ(
      readJson(folder_.path("calibrated/summary.json"))["inputs"]["clique_calibration"],
      folder_.path("out/calibration.yaml"));
  expectFails(mapOf(street) + " --output " + folder_.path("x") +
                  " --label-calibration " + folder_.path("out/calibration.yaml"),
              3, "line 1: is a calibration of 'cliques'");
  // The labels of the maps that it learns from can be calibrated.
  calibrateStreets();
  fs::rename(folder_.path("out"), folder_.path("pixels"));
  calibrateStreets(config + " --label-calibration " +
                   folder_.path("pixels/without_'{name}'.yaml"));
  EXPECT_NE(bytesOf(folder_.path("out/calibration.yaml")), of_cliques);
}

TEST_F(CalibrateTool, OptionsOverrideTheConfigurationOfTheMaps)
{
  std::vector<std::string> learned;
  for (const std::string engine : {"sgm", "sgbm"}) {
    folder_.write("map.yaml", "crf: hierarchical\nstereo: " + engine + "\n");
    for (const char* const option : {"", " --stereo sgbm"}) {
      calibrateStreets("--features extent --clique-config " + folder_.path("map.yaml") +
                       option);
      learned.push_back(bytesOf(folder_.path("out/calibration.yaml")));
    }
  }
  EXPECT_NE(learned[0], learned[1]);
  EXPECT_EQ(learned[1], learned[2]);
  EXPECT_EQ(learned[2], learned[3]);
}

TEST(CalibrateToolUsage, BadInput)
{
  const std::string all = "calibrate STREET --output OUT" + folders;
  const auto calibration = [](const std::string& text) {
    return
        [=](const std::string& street) { std::ofstream(street + "/c.yaml") << text; };
  };
  const std::string map =
      "--labels STREET/labels --label-calibration STREET/c.yaml --archive TEMP/a.map";
  expectAllFail({
      {2, "'--sequences' is required", "calibrate --output OUT" + folders},
      {2, "'--truth' is required",
       "calibrate STREET --output OUT --labels STREET/labels"},
      {2, "balance is 2, expected 0 to 1", all + "--balance 2"},
      {2, "--ground: class 'lawn' is not in the label set", all + "--ground road,lawn"},
      {2, "--features: 'smell' is no feature", all + "--features height,smell"},
      {2, "--features: 'lowest' is only for cliques", all + "--features lowest"},
      {2, "two sequences have the name street",
       "calibrate STREET STREET --output OUT" + folders},
      {3, "street/none",
       "calibrate STREET --output OUT --labels '{sequence}/labels' --truth "
       "'{sequence}/none'"},
      {2, "expected A:B", all + "--frames 3"},
      {3, "has no ground truth image", all + "--frames 7:9"},
      {3, "c.yaml: crf is dense, expected hierarchical",
       all + "--clique-config STREET/c.yaml", calibration("crf: dense\n")},
      {3, "expected ground truth of two classes or more", all,
       [](const std::string& street) {
         for (const char* const frame : {"000000", "000001", "000002"})
           writePng(street + "/gt/" + frame + ".png",
                    cv::Mat(64, 208, CV_8UC1, cv::Scalar(3)));
       }},
      {5, "poses.txt", "calibrate STREET --output STREET/poses.txt" + folders},
      {3, "c.yaml", map},
      {2, "is for maps, with --clique-config",
       all + "--label-calibration STREET/c.yaml"},
      {3, "c.yaml line 1: is a calibration of 'pixels'",
       "--labels STREET/labels --crf hierarchical --clique-calibration STREET/c.yaml",
       calibration("of: pixels\nsharpness: 1\nground: []\n")},
      {2, "--clique-calibration has no effect with --crf dense",
       "--labels STREET/labels --clique-calibration STREET/c.yaml",
       calibration("sharpness: 1\nground: []\nknots: {}\nclasses: {}\n")},
  });
}

} // namespace pcl_semantic
