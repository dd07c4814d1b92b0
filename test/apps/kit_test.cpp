// SPDX-License-Identifier: BSD-3-Clause
#include "files/pcd_file.h"
#include "support/bad_case.h"
#include "support/onnx_writer.h"
#include "support/thrown_message.h"
#include "support/tiny_street.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <regex>
#include <set>
#include <sstream>

// What all programs have in common.

namespace pcl_semantic {

namespace fs = std::filesystem;

namespace {

const std::string bin = PCL_SEMANTIC_BINARY_DIR "/bin";

std::vector<std::string>
allTools()
{
  std::vector<std::string> tools;
  const std::string begin = "pcl_semantic_";
  for (const auto& entry : fs::directory_iterator(bin))
    if (const std::string name = entry.path().filename(); name.rfind(begin, 0) == 0)
      tools.push_back(name.substr(begin.size()));
  return tools;
}

// Long options, as the help lists them.
std::set<std::string>
optionsOf(const std::string& tool)
{
  const std::string help = runTool(tool + " --help-all").text;
  static const std::regex line("\n  (-. \\[ )?(--[a-z0-9-]+)");
  std::set<std::string> options;
  for (std::sregex_iterator it(help.begin(), help.end(), line), end; it != end; ++it)
    options.insert((*it)[2]);
  return options;
}

std::set<std::string>
wordsOf(const std::string& text)
{
  std::istringstream stream(text);
  return {std::istream_iterator<std::string>(stream), {}};
}

std::string
mapOfStreet()
{
  return mapOf(tinyStreet()) + " --crf none --output ";
}

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

// In this order: a map is made of the street, and evaluated.
const std::vector<std::string> verbs = [] {
  std::vector<std::string> all = {
      "synthesize", "map",    "evaluate", "crf",     "image_crf", "archive",
      "odometry",   "stereo", "label",    "cliques", "render",    "export",
      "cloud",      "rgbd",   "fleet",    "live",    "things"};
  // It may have been left out, or have nothing to draw on.
  if (fs::exists(PCL_SEMANTIC_BINARY_DIR "/bin/pcl_semantic_view") &&
      runShell("command -v xvfb-run").code == 0)
    all.push_back("view");
  return all;
}();

} // namespace

TEST(Kit, EveryToolHasTheSameGeneralOptions)
{
  const std::vector<std::string> tools = allTools();
  EXPECT_GE(tools.size(), 17u);
  for (const std::string& tool : tools) {
    const std::set<std::string> options = optionsOf(tool);
    for (const char* const each : {"--help", "--help-all", "--version", "--quiet",
                                   "--verbose", "--json", "--man"})
      EXPECT_EQ(options.count(each), 1u) << tool << " " << each;
    const std::string version = succeed(tool + " --version");
    EXPECT_EQ(version.rfind("pcl_semantic_" + tool + " ", 0), 0u) << version;
  }
}

TEST(Kit, ManualPagesNameEveryOption)
{
  for (const std::string& tool : allTools()) {
    const std::string page = succeed(tool + " --man");
    EXPECT_EQ(page.rfind(".TH pcl_semantic_" + tool + " 1 ", 0), 0u);
    for (const std::string& option : optionsOf(tool))
      EXPECT_TRUE(holds(page, replaceAll(option, "-", "\\-") + "\\fR")) << tool;
  }
}

TEST(Kit, ManualPagesAreWellFormed)
{
  if (runShell("command -v groff").code != 0)
    GTEST_SKIP() << "groff is not installed";
  for (const std::string& tool : allTools()) {
    const ToolResult set = runShell(bin + "/pcl_semantic_" + tool +
                                    " --man | groff -man -Tascii -ww 2>&1 >/dev/null");
    EXPECT_EQ(set.text, "") << tool;
  }
}

TEST(Kit, TheShellCompletesOptions)
{
  const auto complete = [](const std::string& words, const std::string& last) {
    return wordsOf(runShell("bash -c 'PATH=" + bin + ":$PATH; source " +
                            PCL_SEMANTIC_BINARY_DIR +
                            "/share/bash-completion/pcl_semantic; COMP_WORDS=(" +
                            words + " \"" + last +
                            "\"); COMP_CWORD=1; _pcl_semantic; "
                            "echo ${COMPREPLY[@]}'")
                       .text);
  };
  EXPECT_EQ(complete("pcl_semantic_map", "--"), optionsOf("map"));
  EXPECT_EQ(complete("pcl_semantic_map", "--poses"), std::set<std::string>{"--poses"});
  EXPECT_TRUE(complete("pcl_semantic_map", "str").empty()); // files are the shell's
}

TEST(Kit, QuietIsQuietAndVerboseTellsOfEveryFrame)
{
  const TemporaryFolder folder;
  const std::string map = mapOfStreet();
  EXPECT_EQ(succeed(map + folder.path("quiet") + " --quiet"), "");
  const std::string verbose = succeed(map + folder.path("verbose") + " --verbose");
  for (const char* const frame : {"0", "1", "2"})
    EXPECT_TRUE(std::regex_search(
        verbose, std::regex(std::string("pcl_semantic_map: [0-9.]+ s: frame ") + frame +
                            ", .*map [0-9]+ ms.* voxels\n")))
        << verbose;
  EXPECT_EQ(bytesOf(folder.path("quiet/map.pcd")),
            bytesOf(folder.path("verbose/map.pcd")));
  expectFails(map + folder.path("both") + " --quiet --verbose", 2,
              "--quiet and --verbose exclude each other");
  EXPECT_FALSE(fs::exists(folder.path("both")));
}

TEST(Kit, FiguresAreTheSameAsJson)
{
  const TemporaryFolder folder;
  const auto json = [](const std::string& arguments) {
    return nlohmann::json::parse(runTool(arguments + " --json").text);
  };
  EXPECT_EQ(json(mapOfStreet() + folder.path("map"))["map"],
            folder.path("map/map.pcd"));
  const std::string evaluate = "evaluate" + of_kitti11 + "--prediction " +
                               folder.path("map/labels") + " --truth " + tinyStreet() +
                               "/gt --output " + folder.path("scores");
  const auto scores = json(evaluate);
  EXPECT_EQ(scores, nlohmann::json::parse(bytesOf(folder.path("scores/metrics.json"))));
  const auto crf =
      json("crf " + folder.path("map/map.pcd ") + folder.path("refined.pcd"));
  EXPECT_EQ(crf["points"], readPcd(folder.path("map/map.pcd")).points());
  EXPECT_EQ(runTool(evaluate + " --json --row x").code, 2);
  EXPECT_EQ(runTool(evaluate + " --json --header").code, 2);
}

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
        "coloured.pcd", "street.bt", "street.ply", "disparity.png",
        "street_labelled/000001.pcd", "map.png", "grouped.pcd", "street.yaml"})
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

} // namespace pcl_semantic
