// SPDX-License-Identifier: BSD-3-Clause
#include "support/bad_case.h"
#include "support/onnx_writer.h"
#include "support/tiny_street.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <regex>
#include <sstream>

namespace pcl_semantic {

namespace fs = std::filesystem;

namespace {

// The command that a tool gives as an example of itself.
std::string
exampleOf(const std::string& verb)
{
  const std::string help = succeed(verb + " --help");
  EXPECT_EQ(help.rfind("Usage: pcl_semantic_" + verb + " ", 0), 0u) << help;
  const std::string title = "\nExample:\n";
  const std::size_t start = help.find(title) + title.size();
  const std::size_t end = help.find("\nOptions", start);
  EXPECT_NE(end, std::string::npos) << help;
  return help.substr(start, end - start - 1); // without its last line break
}

} // namespace

// In this order: a map is made of the street, and evaluated.
const std::vector<std::string> verbs = [] {
  std::vector<std::string> all = {
      "synthesize", "map",    "evaluate", "crf",     "image_crf", "archive",
      "odometry",   "stereo", "label",    "cliques", "render",    "calibrate",
      "export",     "cloud",  "rgbd",     "fleet",   "live"};
  // It may have been left out, or have nothing to draw on.
  if (fs::exists(PCL_SEMANTIC_BINARY_DIR "/bin/pcl_semantic_view") &&
      runShell("command -v xvfb-run").code == 0)
    all.push_back("view");
  return all;
}();

TEST(Help, ItsExamplesRunWhenPasted)
{
  const TemporaryFolder folder;
  fs::create_directories(folder.path("sequences"));
  copyStreet(folder.path("sequences/05"));
  addScan(folder.path("sequences/05"));
  fs::create_directory_symlink(folder.path("sequences/05/labels"),
                               folder.path("labels_05"));
  folder.write("city.onnx", cityNetwork());
  fs::create_directory_symlink(PCL_SEMANTIC_SOURCE_DIR "/data", folder.path("data"));
  const std::string begin = "cd " + folder.path() +
                            " && export PATH=" PCL_SEMANTIC_BINARY_DIR "/bin:$PATH && ";
  for (const std::string& verb : verbs) {
    std::string example = replaceAll(exampleOf(verb), "/tmp/", folder.path() + "/");
    example = replaceAll(example, "pcl_semantic_synthesize ",
                         "pcl_semantic_synthesize --frames 2 --size 208x64 ");
    example = replaceAll(example, "359,359,303,93", "120,120,102,31"); // of that size
    const ToolResult result = runShell("{ " + begin + example + "; } 2>&1");
    EXPECT_EQ(result.code, 0) << example << result.text;
  }
  for (const char* file :
       {"street/poses.txt", "map/map.pcd", "live_map/map.pcd",
        "evaluation/metrics.json", "refined.pcd", "refined.png", "road.pcd", "pair.pcd",
        "disparity.png", "street_labelled/000001.pcd", "map.png", "grouped.pcd",
        "coloured.pcd", "calibrated/calibration.yaml", "street.bt", "street.ply",
        "street.yaml"})
    EXPECT_TRUE(fs::exists(folder.path(file))) << file;
  EXPECT_EQ(fs::exists(folder.path("view.png")), verbs.back() == "view");
}

// `--help` fits on a screen, and all listed options exist.
TEST(Help, FitsOnAScreen)
{
  for (const std::string& verb : verbs) {
    const std::string help = succeed(verb + " --help"),
                      all = succeed(verb + " --help-all");
    EXPECT_LE(std::count(help.begin(), help.end(), '\n'), 45) << verb;
    std::istringstream lines(help);
    int listed = 0;
    for (std::string line; std::getline(lines, line);) {
      EXPECT_LE(line.size(), 100u) << line;
      std::smatch option;
      const bool is_option =
          std::regex_search(line, option, std::regex("^  (?:-. \\[ )?--([a-z-]+)"));
      if (!is_option || line.find("options]") != std::string::npos)
        continue;
      EXPECT_TRUE(std::regex_search(
          all, std::regex("\n  (-. \\[ )?--" + option[1].str() + "[ \n]")))
          << verb << ": " << line;
      ++listed;
    }
    EXPECT_GE(listed, 5) << verb;
  }
}

TEST(Help, VersionOfEveryTool)
{
  for (const std::string& verb : verbs) {
    const std::string text = succeed(verb + " --version");
    EXPECT_EQ(text.rfind("pcl_semantic_" + verb + " ", 0), 0u) << text;
  }
}

} // namespace pcl_semantic
