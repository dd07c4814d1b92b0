/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

// Every command of the README, run in a folder that looks like the project after
// ./dev demo, with a tiny street in the place of KITTI.

#include "support/onnx_writer.h"
#include "support/run_tool.h"
#include "support/tiny_street.h"

#include <gtest/gtest.h>

#include <filesystem>

namespace {

using namespace pcl_semantic;
namespace fs = std::filesystem;

// The commands in the README's bash blocks, continued lines joined.
std::vector<std::string>
readmeCommands()
{
  std::vector<std::string> commands;
  bool inside = false, continued = false;
  for (std::string line : linesOf(PCL_SEMANTIC_SOURCE_DIR "/README.md")) {
    if (line.rfind("```", 0) == 0) {
      inside = line == "```bash";
      continue;
    }
    if (!inside || line.empty())
      continue;
    const bool continues = line.back() == '\\';
    if (continues)
      line.pop_back();
    if (continued)
      commands.back() += line;
    else
      commands.push_back(line);
    continued = continues;
  }
  return commands;
}

TEST(Readme, ItsCommandsRun)
{
  const TemporaryFolder folder;
  fs::create_directories(folder.path("build/demo"));
  fs::create_directory_symlink(PCL_SEMANTIC_BINARY_DIR "/bin",
                               folder.path("build/bin"));
  fs::create_directory_symlink(PCL_SEMANTIC_SOURCE_DIR "/data", folder.path("data"));
  const std::string street = folder.path("build/demo/sequence");
  copyStreet(street);
  addScan(street);
  ASSERT_EQ(runTool("map " + street + " --labels " + street + "/labels --output " +
                    folder.path("build/demo/map"))
                .code,
            0);
  const std::string variables = "SEQUENCE=" + street +
                                "; MODEL=" + folder.write("city.onnx", cityNetwork()) +
                                "; ";
  int run = 0;
  for (const std::string& command : readmeCommands()) {
    if (command.rfind("SEQUENCE=", 0) == 0 || command.rfind("MODEL=", 0) == 0)
      continue; // the reader's own paths
    if (command.rfind("./dev ", 0) == 0)
      continue; // below
    ++run;
    const ToolResult result =
        runShell("{ cd " + folder.path() + "; " + variables + command + "; } 2>&1");
    EXPECT_EQ(result.code, 0) << command << "\n" << result.text;
  }
  EXPECT_GE(run, 5);
  for (const char* file :
       {"map_05/map.pcd", "map_coarse/map.pcd", "truth_05/000000.png", "refined.pcd",
        "refined.png", "overlay.png"})
    EXPECT_TRUE(fs::exists(folder.path(file))) << file;
}

// .ci/run calls these itself.
TEST(Readme, ItsCommandsOfDevExistAndCiRunsThem)
{
  const std::string help =
      runShell("bash " PCL_SEMANTIC_SOURCE_DIR "/dev --help 2>&1").text;
  const std::string ci = bytesOf(PCL_SEMANTIC_SOURCE_DIR "/.ci/run");
  int found = 0;
  for (const std::string& command : readmeCommands())
    if (command.rfind("./dev ", 0) == 0) {
      ++found;
      EXPECT_NE(help.find("\n  " + command.substr(6)), std::string::npos) << command;
      EXPECT_NE(ci.find(command), std::string::npos) << command;
    }
  EXPECT_EQ(found, 3);
}

TEST(Readme, ItsTableNamesEveryTool)
{
  const std::string readme = bytesOf(PCL_SEMANTIC_SOURCE_DIR "/README.md");
  int tools = 0;
  for (const fs::directory_entry& entry :
       fs::directory_iterator(PCL_SEMANTIC_BINARY_DIR "/bin")) {
    ++tools;
    EXPECT_NE(readme.find("| `" + entry.path().filename().string() + "` |"),
              std::string::npos)
        << entry.path();
  }
  EXPECT_GE(tools, 4);
}

TEST(Readme, ItsLinksLeadSomewhere)
{
  const std::string readme = bytesOf(PCL_SEMANTIC_SOURCE_DIR "/README.md");
  int links = 0;
  for (std::size_t at = 0; (at = readme.find("](", at)) != std::string::npos; ++at) {
    const std::string target = readme.substr(at + 2, readme.find(')', at) - at - 2);
    if (target.rfind("http", 0) == 0)
      continue;
    ++links;
    EXPECT_TRUE(fs::exists(fs::path(PCL_SEMANTIC_SOURCE_DIR) / target)) << target;
  }
  EXPECT_GE(links, 5);
}

} // namespace
