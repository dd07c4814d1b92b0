// SPDX-License-Identifier: BSD-3-Clause

// Names that a terminal or JSON cannot take, folders that somebody else uses, and
// calibrations of other images.

#include "support/mapped_street.h"

#include <nlohmann/json.hpp>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <fstream>
#include <sstream>

namespace {

using namespace pcl_semantic;

TEST(HostileNames, ControlCharactersAreEscapedInMessages)
{
  const TemporaryFolder folder;
  folder.write("c.yaml", "\"\\e]0;title\\a\": 1\n");
  const ToolResult key =
      runTool("map " + tinyStreet() + " --config " + folder.path("c.yaml"));
  EXPECT_EQ(key.code, 3);
  EXPECT_EQ(key.text.find('\x1B'), std::string::npos) << key.text;
  EXPECT_NE(key.text.find("\\x1B]0;title\\x07"), std::string::npos) << key.text;
  const ToolResult path =
      runTool("crf '/none/\x1B[2J\xC2\x9B\xE9\xC3\xA9.pcd' /tmp/x.pcd");
  EXPECT_NE(path.text.find("/none/\\x1B[2J\\xC2\\x9B\\xE9\xC3\xA9.pcd"),
            std::string::npos)
      << path.text;
}

TEST(HostileNames, PathsNeedNotBeUtf8)
{
  const TemporaryFolder folder;
  const std::string output = folder.path("m\xE9p");
  mapStreet(tinyStreet(), output, "--crf none --frames 0:1");
  std::ifstream summary(output + "/summary.json");
  EXPECT_TRUE(nlohmann::json::parse(summary)["finished"]);
}

TEST(HostileNames, AFolderThatIsWrittenToIsRefused)
{
  const TemporaryFolder folder;
  const int held = open(folder.path().c_str(), O_RDONLY | O_DIRECTORY);
  ASSERT_EQ(flock(held, LOCK_EX), 0);
  const std::string command = "map " + tinyStreet() + " --labels " + tinyStreet() +
                              "/labels --crf none --frames 0:1 --output " +
                              folder.path();
  const ToolResult refused = runTool(command);
  EXPECT_EQ(refused.code, 5);
  EXPECT_NE(refused.text.find("another run is writing to it"), std::string::npos)
      << refused.text;
  EXPECT_EQ(folder.entries(), 0u);
  close(held);
  EXPECT_EQ(runTool(command).code, 0);
}

TEST(HostileNames, AReaderThatLeavesDoesNotEndARun)
{
  const TemporaryFolder folder;
  const ToolResult result =
      runShell("( " PCL_SEMANTIC_BINARY_DIR "/bin/pcl_semantic_map " + tinyStreet() +
               " --labels " + tinyStreet() + "/labels --crf none --verbose --output " +
               folder.path("map") + "; echo $? > " + folder.path("code") +
               " ) 2>&1 | head -n 1");
  std::ifstream code(folder.path("code"));
  int number = -1;
  code >> number;
  EXPECT_EQ(number, 5) << result.text; // its results had no reader
  std::ifstream summary(folder.path("map/summary.json"));
  EXPECT_TRUE(nlohmann::json::parse(summary)["finished"]);
}

TEST(HostileCalibrations, OfImagesOfAnotherSizeAreTold)
{
  // KITTI's file does not say a size, but its principal point is near the middle.
  const TemporaryFolder folder;
  std::ifstream original(tinyStreet() + "/calib.txt");
  std::ostringstream changed;
  for (std::string name, line; original >> name && std::getline(original, line);) {
    std::istringstream numbers(line);
    changed << name;
    double number = 0.0;
    for (int i = 0; numbers >> number; ++i)
      changed << " " << (name != "Tr:" && i < 8 ? number / 2.0 : number);
    changed << "\n";
  }
  folder.write("half.txt", changed.str());
  const std::string image = "/000000.png ";
  const std::string command =
      "stereo " + tinyStreet() + "/image_2" + image + tinyStreet() + "/image_3" + image;
  const std::string output = " " + folder.path("pair.pcd");
  const ToolResult fitting = runTool(command + tinyStreet() + "/calib.txt" + output);
  EXPECT_EQ(fitting.text.find("warning"), std::string::npos) << fitting.text;
  const ToolResult half = runTool(command + folder.path("half.txt") + output);
  EXPECT_EQ(half.code, 0);
  EXPECT_NE(half.text.find("is far from the middle of the images"), std::string::npos)
      << half.text;
  EXPECT_EQ(runTool(command + folder.path("half.txt") + output + " --strict").code, 3);
  const ToolResult none =
      runTool(command + tinyStreet() + "/calib.txt" + output + " --max-depth 0.01");
  EXPECT_NE(none.text.find("warning: no pixel has a depth"), std::string::npos)
      << none.text;
}

} // namespace
