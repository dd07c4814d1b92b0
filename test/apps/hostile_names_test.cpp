// SPDX-License-Identifier: BSD-3-Clause

// Names that a terminal or JSON cannot take, folders that somebody else uses, and
// calibrations of other images.

#include "support/mapped_street.h"
#include "support/thrown_message.h"

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
  EXPECT_FALSE(holds(key.text, "\x1B"));
  EXPECT_TRUE(holds(key.text, "\\x1B]0;title\\x07"));
  const ToolResult path =
      runTool("crf '/none/\x1B[2J\xC2\x9B\xE9\xC3\xA9.pcd' /tmp/x.pcd");
  EXPECT_TRUE(holds(path.text, "/none/\\x1B[2J\\xC2\\x9B\\xE9\xC3\xA9.pcd"));
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
  const std::string command =
      mapOf(tinyStreet()) + " --crf none --frames 0:1 --output " + folder.path();
  expectFails(command, 5, "another run is writing to it");
  EXPECT_EQ(folder.entries(), 0u);
  close(held);
  succeed(command);
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
  EXPECT_FALSE(holds(fitting.text, "warning"));
  const std::string half = succeed(command + folder.path("half.txt") + output);
  EXPECT_TRUE(holds(half, "is far from the middle of the images"));
  EXPECT_EQ(runTool(command + folder.path("half.txt") + output + " --strict").code, 3);
  const ToolResult none =
      runTool(command + tinyStreet() + "/calib.txt" + output + " --max-depth 0.01");
  EXPECT_TRUE(holds(none.text, "warning: no pixel has a depth"));
}

} // namespace
