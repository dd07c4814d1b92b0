// SPDX-License-Identifier: BSD-3-Clause

// Every command of the README and doc/kitti.md, run in a folder like the project after
// ./dev demo, with a tiny street instead of KITTI.

#include "support/code_blocks.h"
#include "support/onnx_writer.h"
#include "support/run_tool.h"
#include "support/thrown_message.h"

#include <gtest/gtest.h>

#include <filesystem>

namespace {

using namespace pcl_semantic;
namespace fs = std::filesystem;

const char* const readme = PCL_SEMANTIC_SOURCE_DIR "/README.md";
const char* const kitti = PCL_SEMANTIC_SOURCE_DIR "/doc/kitti.md";

TEST(Readme, ItsCommandsRun)
{
  const TemporaryFolder folder;
  fs::create_directories(folder.path("build/demo"));
  for (const std::string name : {"/bin", "/python"})
    fs::create_directory_symlink(PCL_SEMANTIC_BINARY_DIR + name,
                                 folder.path("build" + name));
  fs::create_directory_symlink(PCL_SEMANTIC_SOURCE_DIR "/data", folder.path("data"));
  fs::create_directory_symlink(PCL_SEMANTIC_SOURCE_DIR "/python",
                               folder.path("python"));
  const std::string street = folder.path("build/demo/sequence");
  copyStreet(street);
  addScan(street);
  succeed(mapOf(street) + " --output " + folder.path("build/demo/map"));
  const std::string variables = "SEQUENCE=" + street +
                                "; MODEL=" + folder.write("city.onnx", cityNetwork()) +
                                "; PATH=/usr/bin:$PATH; "; // Debian's Python
  int run = 0;
  std::vector<std::string> commands = bashCommandsOf(readme);
  for (const std::string& command : bashCommandsOf(kitti))
    commands.push_back(command);
  for (const std::string& command : commands) {
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
  for (const std::string& command : bashCommandsOf(readme))
    if (command.rfind("./dev ", 0) == 0) {
      ++found;
      EXPECT_TRUE(holds(help, "\n  " + command.substr(6))) << command;
      EXPECT_TRUE(holds(ci, command)) << command;
    }
  EXPECT_EQ(found, 3);
}

TEST(Readme, ItsTableNamesEveryTool)
{
  const std::string text = bytesOf(readme);
  int tools = 0;
  for (const fs::directory_entry& entry :
       fs::directory_iterator(PCL_SEMANTIC_BINARY_DIR "/bin")) {
    ++tools;
    const std::string name = entry.path().filename().string();
    const std::string prefix = "pcl_semantic_";
    ASSERT_EQ(name.rfind(prefix, 0), 0u) << name;
    EXPECT_TRUE(holds(text, "`" + name.substr(prefix.size()) + "`")) << name;
  }
  EXPECT_GE(tools, 4);
}

TEST(Readme, ItsLinksLeadSomewhere)
{
  const std::vector<std::string> links = localLinksOf(readme);
  for (const std::string& target : links)
    EXPECT_TRUE(fs::exists(fs::path(PCL_SEMANTIC_SOURCE_DIR) / target)) << target;
  EXPECT_GE(links.size(), 5u);
}

} // namespace
