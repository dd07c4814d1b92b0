// SPDX-License-Identifier: BSD-3-Clause
#include "files/pcd_file.h"
#include "support/bad_case.h"
#include "support/thrown_message.h"
#include "support/tiny_street.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <regex>
#include <set>

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
  EXPECT_EQ(complete("pcl_semantic_map", "--pos"), std::set<std::string>{"--poses"});
  EXPECT_TRUE(complete("pcl_semantic_map", "str").empty()); // files are the shell's
}

TEST(Kit, QuietIsQuietAndVerboseTellsOfEveryFrame)
{
  const TemporaryFolder folder;
  const std::string map = mapOfStreet();
  const ToolResult quiet = runTool(map + folder.path("quiet") + " --quiet");
  EXPECT_EQ(quiet.code, 0);
  EXPECT_EQ(quiet.text, "");
  const ToolResult verbose = runTool(map + folder.path("verbose") + " --verbose");
  EXPECT_EQ(verbose.code, 0);
  for (const char* const frame : {"0", "1", "2"})
    EXPECT_TRUE(std::regex_search(
        verbose.text, std::regex(std::string("pcl_semantic_map: [0-9.]+ s: frame ") +
                                 frame + ", .*map [0-9]+ ms.* voxels\n")))
        << verbose.text;
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
  const std::string evaluate = "evaluate --label-set " PCL_SEMANTIC_SOURCE_DIR
                               "/data/label_sets/kitti11.yaml --prediction " +
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

} // namespace pcl_semantic
