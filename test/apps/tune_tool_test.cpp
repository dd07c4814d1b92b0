// SPDX-License-Identifier: BSD-3-Clause
#include "support/bad_case.h"
#include "support/mapped_street.h"
#include "support/thrown_message.h"
#include "support/tiny_street.h"

#include <gtest/gtest.h>

namespace pcl_semantic {

namespace fs = std::filesystem;

namespace {

const std::string folders = " --labels '{sequence}/labels' --truth '{sequence}/gt' ";

// Two streets and a grid in a folder.
class TuneTool : public testing::Test {
protected:
  TuneTool()
  {
    for (const char* const name : {"one", "two"})
      copyStreet(folder_.path(name));
    folder_.write("grid.yaml", "voxel_size: 0.2\n"
                               "crf: [none, dense]\n"
                               "appearance_weight: [2]\n");
  }

  ToolResult
  tune(const std::string& options)
  {
    return runTool("tune " + folder_.path("one ") + folder_.path("two") + " --config " +
                   folder_.path("grid.yaml") + folders + "--output " +
                   folder_.path("out") + " " + options);
  }

  TemporaryFolder folder_;
};

} // namespace

TEST_F(TuneTool, WritesAConfigurationThatTheMapTakes)
{
  const ToolResult result = tune("--workers 2");
  ASSERT_EQ(result.code, 0) << result.text;
  EXPECT_TRUE(holds(result.text, "known_runs: 0\n"));
  EXPECT_EQ(filesIn(folder_.path("out")),
            (std::set<std::string>{"best.yaml", "report.md", "runs.jsonl",
                                   "sensitivity.png", "table.tsv"}));
  const ToolResult map =
      runTool("map " + folder_.path("one") + " --labels " + folder_.path("one/labels") +
              " --config " + folder_.path("out/best.yaml") + " --output " +
              folder_.path("map"));
  EXPECT_EQ(map.code, 0) << map.text;
  const std::string best = bytesOf(folder_.path("out/best.yaml"));
  EXPECT_NE(best.find("\nvoxel_size: 0.2 "), std::string::npos) << best;
  const std::string report = bytesOf(folder_.path("out/report.md"));
  for (const char* const part : {"| one |", "| two |", "| pooled |", "without two",
                                 "## At depth", "## Rendered", "3 with truth of"})
    EXPECT_NE(report.find(part), std::string::npos) << part;
  EXPECT_GE(linesOf(folder_.path("out/table.tsv")).size(), 4u);
}

TEST_F(TuneTool, TheTableAgreesWithPclSemanticEvaluate)
{
  ASSERT_EQ(tune("--search grid").code, 0);
  for (const char* const name : {"one", "two"})
    ASSERT_EQ(runTool("map " + folder_.path(name) + " --labels " + folder_.path(name) +
                      "/labels --voxel-size 0.2 " + "--appearance-weight 2 --output " +
                      folder_.path(name + std::string("_map")))
                  .code,
              0);
  std::string row = "dense\t2\t";
  const std::vector<std::string> lines = linesOf(folder_.path("out/table.tsv"));
  const auto found = std::find_if(lines.begin(), lines.end(), [&](const auto& line) {
    return line.rfind(row, 0) == 0;
  });
  ASSERT_NE(found, lines.end());
  std::vector<double> figures;
  std::istringstream words(found->substr(row.size()));
  for (double figure = 0.0; words >> figure;)
    figures.push_back(figure);
  ASSERT_EQ(figures.size(), 7u); // pooled, one, two, depth, rendered and inclusive
  for (const auto& [images, place] :
       {std::pair("labels_at_depth", 3), std::pair("labels", 4)}) {
    std::string command = "evaluate --label-set " PCL_SEMANTIC_SOURCE_DIR
                          "/data/label_sets/kitti11.yaml --output " +
                          folder_.path("evaluation");
    for (const std::string name : {"one", "two"})
      command += " --prediction " + folder_.path(name + "_map/" + images) +
                 " --truth " + folder_.path(name + "/gt");
    ASSERT_EQ(runTool(command).code, 0);
    const auto mean = readJson(folder_.path("evaluation/metrics.json"))["mean"];
    EXPECT_NEAR(figures[std::size_t(place)],
                100.0 * mean["iou_exclusive"].get<double>(), 0.006);
    EXPECT_NEAR(figures[std::size_t(place) + 2],
                100.0 * mean["iou_inclusive"].get<double>(), 0.006);
  }
}

TEST_F(TuneTool, GoesOnWithWhatItKnows)
{
  ASSERT_EQ(tune("--budget 2").code, 0);
  const std::size_t before = linesOf(folder_.path("out/runs.jsonl")).size();
  const std::string report = bytesOf(folder_.path("out/report.md"));
  ToolResult result = tune("--budget 2 --workers 1");
  ASSERT_EQ(result.code, 0) << result.text;
  EXPECT_TRUE(holds(result.text, "new_runs: 0\n"));
  EXPECT_EQ(linesOf(folder_.path("out/runs.jsonl")).size(), before);
  EXPECT_EQ(bytesOf(folder_.path("out/report.md")), report);
  // Other truth makes other runs.
  fs::remove(folder_.path("two/gt/000002.png"));
  result = tune("");
  EXPECT_EQ(result.code, 3);
  EXPECT_TRUE(holds(result.text, "runs.jsonl: holds other runs: two was "));
}

TEST(TuneToolUsage, BadInput)
{
  const auto grid = [](const std::string& text) {
    return [=](const std::string& street) {
      std::ofstream(street + "/grid.yaml") << text;
    };
  };
  const auto good = grid("crf: [none, dense]\n");
  const std::string all =
      "tune STREET --config STREET/grid.yaml --output OUT" + folders;
  for (const BadCase& bad : std::vector<BadCase>{
           {"nothing", 2, "'--sequences' is required",
            "tune --config STREET/grid.yaml --output OUT" + folders, good},
           {"no grid", 2, "'--config' is required",
            "tune STREET --output OUT" + folders},
           {"unknown key", 3, "grid.yaml line 2: key 'speed' is not known", all,
            grid("crf: [none, dense]\nspeed: [1, 2]\n")},
           {"bad value", 3, "grid.yaml line 1: smoothness_weight is -1", all,
            grid("smoothness_weight: [-1, 2]\n")},
           {"unknown class", 3,
            "grid.yaml line 1: clique_leaves_out: class 'pol' is not", all,
            grid("clique_leaves_out: [none, \"pole,pol\"]\n")},
           {"nothing to search", 3, "no parameter has a list", all,
            grid("crf: none\n")},
           {"search", 2, "--search is 'all', expected coordinate, grid or random",
            all + "--search all", good},
           {"score", 2, "--score is 'best'", all + "--score best", good},
           {"view", 2, "--view is 'top'", all + "--view top", good},
           {"budget", 2, "budget of a search is 0", all + "--budget 0", good},
           {"grid beyond the budget", 2, "2 configurations, more than the budget of 1",
            all + "--search grid --budget 1", good},
           {"workers", 2, "runs at a time are 0", all + "--workers 0", good},
           {"margin", 2, "margin is -1", all + "--margin -1", good},
           {"least gain", 2, "least gain is nan", all + "--least-gain nan", good},
           {"memory", 2, "--memory is -1", all + "--memory -1", good},
           {"one twice", 2, "each of another name",
            "tune STREET STREET --config STREET/grid.yaml --output OUT" + folders,
            good},
           {"no truth", 3, "street/none",
            "tune STREET --config STREET/grid.yaml --output OUT "
            "--labels '{sequence}/labels' --truth '{sequence}/none'",
            good},
           {"no labels", 3, "x/street: is no folder of stored labels",
            "tune STREET --config STREET/grid.yaml --output OUT "
            "--labels 'TEMP/x/{name}' --truth '{sequence}/gt'",
            good},
           {"no poses", 3, "has no poses.txt", all,
            [&](const std::string& street) {
              good(street);
              fs::remove(street + "/poses.txt");
            }},
           {"no labels of a frame", 3, "frame 2 has no labels", all,
            [&](const std::string& street) {
              good(street);
              fs::remove(street + "/labels/000002.bin");
            }},
           {"a start that cannot be", 3, "start.yaml line 1: key 'x'",
            all + "--start STREET/start.yaml", [&](const std::string& street) {
              good(street);
              std::ofstream(street + "/start.yaml") << "x: 1\n";
            }}})
    expectFails(bad);
}

} // namespace pcl_semantic
