// SPDX-License-Identifier: BSD-3-Clause

// Names that a terminal or JSON cannot represent, folders with foreign files, and
// calibrations of other images.

#include "support/mapped_street.h"
#include "support/thrown_message.h"

#include <nlohmann/json.hpp>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>
#include <sstream>

namespace {

using namespace pcl_semantic;

namespace fs = std::filesystem;

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

TEST(HostileNames, ClassNamesAreEscapedInTextAndJson)
{
  const TemporaryFolder folder;
  std::string classes = bytesOf(kitti11);
  classes.replace(classes.find("building"), 8, "a\xC2\x9B\xE2\x80\xAEz");
  const std::string set = folder.write("classes.yaml", classes);
  fs::create_directories(folder.path("labels"));
  writePng(folder.path("labels/000000.png"), cv::Mat(20, 30, CV_8UC1, cv::Scalar(1)));
  const std::string command = "evaluate --prediction " + folder.path("labels") +
                              " --truth " + folder.path("labels") + " --label-set " +
                              set;
  const std::string json = succeed(command + " --json"), text = succeed(command);
  for (const std::string& output : {json, text}) {
    EXPECT_FALSE(holds(output, "\xC2\x9B")) << output;
    EXPECT_FALSE(holds(output, "\xE2\x80\xAE")) << output;
  }
  EXPECT_TRUE(holds(json, "a\\u009B\\u202Ez")) << json;
  EXPECT_TRUE(holds(text, "a\\xC2\\x9B\\xE2\\x80\\xAEz")) << text;
}

TEST(HostileOutputs, LoopsAndLongNamesCannotBeWritten)
{
  const TemporaryFolder folder;
  fs::create_symlink("loop", folder.path("loop"));
  const std::string street = tinyStreet();
  for (const std::string& output :
       {folder.path("loop"), folder.path("loop/x"), folder.path(std::string(300, 'x'))})
    for (const std::string& command :
         {mapOf(street) + " --crf none --frames 0:1 --output " + output,
          mapOf(street) + " --crf none --frames 0:1 --output " + folder.path("map") +
              " --archive " + output,
          "synthesize " + output + " --frames 1",
          "odometry " + street + " --output " + output + "/poses.txt",
          "fleet " + folder.write("plan.yaml",
                                  "output: " + output +
                                      "\ndrives:\n  - {name: a, sequence: " + street +
                                      ", labels: " + street + "/labels}\n")})
      EXPECT_EQ(runTool(command).code, 5) << command;
}

TEST(HostileInputs, PipesAndDevicesAreNotWaitedFor)
{
  const TemporaryFolder folder;
  const std::string street = tinyStreet(), out = " " + folder.path("out.pcd");
  for (const char* const name :
       {"pipe", "pipe.pcd", "pipe.png", "pipe.yaml", "pipe.mp4"})
    ASSERT_EQ(::mkfifo(folder.path(name).c_str(), 0600), 0);
  const std::string pipe = folder.path("pipe");
  for (const std::string& command : std::vector<std::string>{
           "archive info " + pipe, "archive info /dev/zero", "archive verify " + pipe,
           "archive merge " + pipe + " " + folder.path("other") + out,
           "export " + pipe + " " + folder.path("a.ply"),
           "render " + pipe + " " + folder.path("a.png"), "crf " + pipe + ".pcd" + out,
           "image_crf " + pipe + ".png " + pipe + ".png " + folder.path("b.png"),
           mapOf(street) + " --config " + pipe + ".yaml --output " + folder.path("map"),
           mapOf(street) + " --poses " + pipe + " --output " + folder.path("map"),
           mapOf(street) + " --archive " + pipe + " --resume --output " +
               folder.path("map"),
           "live --every-frame --left " + pipe + ".mp4 --right " + pipe +
               ".mp4 --calibration " + street + "/calib.txt --labels " + street +
               "/labels --output " + folder.path("live"),
           "fleet " + pipe + ".yaml"}) {
    const ToolResult result = runShell(
        "timeout 20 " PCL_SEMANTIC_BINARY_DIR "/bin/pcl_semantic_" + command + " 2>&1");
    EXPECT_EQ(result.code, 3) << command << "\n" << result.text;
  }
}

TEST(HostileNames, PathsNeedNotBeUtf8)
{
  const TemporaryFolder folder;
  const std::string output = folder.path("m\xE9p");
  mapStreet(tinyStreet(), output, "--crf none --frames 0:1");
  EXPECT_TRUE(readJson(output + "/summary.json")["finished"]);
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
  EXPECT_EQ(bytesOf(folder.path("code")), "5\n") << result.text; // no reader of results
  EXPECT_TRUE(readJson(folder.path("map/summary.json"))["finished"]);
}

TEST(HostileCalibrations, OfImagesOfAnotherSizeAreTold)
{
  // KITTI's file does not say a size, but its principal point is near the middle.
  const TemporaryFolder folder;
  fs::copy_file(tinyStreet() + "/calib.txt", folder.path("half.txt"));
  halveCamera(folder.path("half.txt"));
  const std::string image = "/000000.png ";
  const std::string command =
      "stereo " + tinyStreet() + "/image_2" + image + tinyStreet() + "/image_3" + image;
  const std::string output = " " + folder.path("pair.pcd");
  const ToolResult fitting = runTool(command + tinyStreet() + "/calib.txt" + output);
  EXPECT_FALSE(holds(fitting.text, "warning"));
  const std::string half = succeed(command + folder.path("half.txt") + output);
  EXPECT_TRUE(holds(half, "is far from the middle of the images"));
  EXPECT_EQ(runTool(command + folder.path("half.txt") + output + " --strict").code, 3);
  EXPECT_TRUE(holds(
      runTool(command + tinyStreet() + "/calib.txt" + output + " --max-depth 0.01")
          .text,
      "warning: no pixel has a depth"));
}

} // namespace
