// SPDX-License-Identifier: BSD-3-Clause
#include "support/mapped_street.h"
#include "support/thrown_message.h"

#include <pcl_semantic/files/image_file.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/files/trajectory_file.h>

#include <opencv2/core.hpp>

#include <cstring>

namespace pcl_semantic {

namespace fs = std::filesystem;

TEST(MapToolOptions, OldNamesAreRefused)
{
  const ToolResult renamed = runTool("map --hit-share 0.2 --print-config");
  EXPECT_EQ(renamed.code, 2);
  EXPECT_TRUE(holds(renamed.text, "--hit-share: is min_hit_ratio now"));
  const ToolResult removed = runTool("map --crf-tolerance=0.1 --print-config");
  EXPECT_EQ(removed.code, 2);
  EXPECT_TRUE(holds(removed.text, "--crf-tolerance: had no effect, removed"));
}

TEST(MapToolOptions, PresetsHaveKeysThatAreNoOptions)
{
  EXPECT_FALSE(holds(runTool("map --help").text, "superpixel-keep"));
  EXPECT_FALSE(holds(succeed("map --print-config"), "superpixel_keep"));
  const ToolResult option = runTool("map --superpixel-keep true --print-config");
  EXPECT_EQ(option.code, 2);
  EXPECT_TRUE(holds(option.text, "--superpixel-keep: is no option, but a key"));
  EXPECT_TRUE(holds(succeed("map --config " PCL_SEMANTIC_SOURCE_DIR
                            "/data/presets/zhao16.yaml --print-config"),
                    "superpixel_keep: true"));
}

TEST(MapTool, FramesKeepTheirNumbers)
{
  const TemporaryFolder folder;
  mapStreet(tinyStreet(), folder.path("part"), "--frames 1:3 --crf none");
  EXPECT_EQ(filesIn(folder.path("part")), filesOfMap({"000001", "000002"}));

  copyStreet(folder.path("street"));
  fs::remove(folder.path("street/image_2/000001.png"));
  fs::remove(folder.path("street/image_3/000001.png"));
  mapStreet(folder.path("street"), folder.path("gap"), "--crf none");
  EXPECT_EQ(filesIn(folder.path("gap")), filesOfMap({"000000", "000002"}));
  const Trajectory poses = readKittiTrajectory(folder.path("gap/trajectory.txt"));
  ASSERT_EQ(poses.size(), 3u);
  const Trajectory truth = readKittiTrajectory(tinyStreet() + "/poses.txt");
  EXPECT_TRUE(poses[2].isApprox(truth[2], 1e-9));
  EXPECT_EQ(readJson(folder.path("gap/summary.json"))["frame_numbers"],
            nlohmann::json({0, 2}));
}

TEST(MapTool, WritesTheMapWithoutImages)
{
  const TemporaryFolder folder;
  mapStreet(tinyStreet(), folder.path("all"), "--crf none");
  const std::string more = mapOf(tinyStreet()) + " --crf none --map-only --output ";
  EXPECT_FALSE(holds(succeed(more + folder.path("map")), "overlay"));
  EXPECT_EQ(filesIn(folder.path("map")), filesOfMap({}));
  for (const char* const file : {"/map.pcd", "/trajectory.txt", "/top_view.png"})
    EXPECT_TRUE(bytesOf(folder.path("map") + file) ==
                bytesOf(folder.path("all") + file))
        << file;
  // Nothing of a map with images is left.
  succeed(more + folder.path("all"));
  EXPECT_EQ(filesIn(folder.path("all")), filesOfMap({}));
  EXPECT_FALSE(fs::exists(folder.path("all/labels")));
}

TEST(MapTool, LabelsEveryNthFrame)
{
  const TemporaryFolder folder;
  copyStreet(folder.path("street"));
  const std::string labels = folder.path("street/labels/");
  fs::remove(labels + "000001.bin"); // needs none
  mapStreet(folder.path("street"), folder.path("out"), "--network-every 2");
  const auto labelled = [&](const std::string& frame) {
    return cv::countNonZero(readPng(folder.path("out/network_labels/") + frame + ".png",
                                    ImageKind::labels));
  };
  EXPECT_GT(labelled("000000"), 0);
  EXPECT_EQ(labelled("000001"), 0);
  EXPECT_GT(labelled("000002"), 0);
  EXPECT_GT(cv::countNonZero(
                readPng(folder.path("out/labels/000001.png"), ImageKind::labels)),
            1000);
}

TEST(MapTool, CrfAndThreads)
{
  const TemporaryFolder folder;
  const auto mapWith = [&](const std::string& options) {
    mapStreet(tinyStreet(), folder.path("out"), "--frames 0:2 " + options);
    return bytesOf(folder.path("out/map.pcd"));
  };
  const std::string dense = mapWith("--threads 1");
  EXPECT_TRUE(dense == mapWith("--threads 3 --crf dense"));
  EXPECT_FALSE(dense == mapWith("--crf none"));
}

TEST(MapTool, StoredLabelsOfEveryKind)
{
  const TemporaryFolder folder;
  copyStreet(folder.path("street"));
  const std::string stored = folder.path("street/labels/000000");
  const auto mapLabels = [&] {
    mapStreet(folder.path("street"), folder.path("out"), "--frames 0:1 --crf none");
    return readPng(folder.path("out/network_labels/000000.png"), ImageKind::labels);
  };
  const cv::Mat labels = mapLabels();
  const std::string map = bytesOf(folder.path("out/map.pcd"));
  const std::string bytes = bytesOf(stored + ".bin");
  fs::remove(stored + ".bin");

  std::ofstream(stored + ".npy") << npyBytes("<f4", "(64, 208, 11)", bytes);
  EXPECT_EQ(cv::norm(mapLabels(), labels, cv::NORM_L1), 0.0);
  EXPECT_TRUE(bytesOf(folder.path("out/map.pcd")) == map);

  std::string halves;
  for (std::size_t i = 0; i < bytes.size(); i += sizeof(float)) {
    float value = 0.0f;
    std::memcpy(&value, &bytes[i], sizeof(value));
    const Eigen::half half(value);
    halves.append(reinterpret_cast<const char*>(&half), sizeof(half));
  }
  std::ofstream(stored + ".npy") << npyBytes("<f2", "(64, 208, 11)", halves);
  EXPECT_LT(cv::countNonZero(mapLabels() != labels), 208 * 64 / 100);
  fs::remove(stored + ".npy");

  fs::copy(folder.path("street/gt/000000.png"), stored + ".png");
  EXPECT_EQ(
      cv::norm(mapLabels(), readPng(stored + ".png", ImageKind::labels), cv::NORM_L1),
      0.0);
}

TEST(MapTool, ConfigurationFileAndOptions)
{
  const TemporaryFolder folder;
  const std::string config =
      folder.write("config.yaml", "voxel_size: 0.2\nwindow: [20, 20, 8]\ncrf: none\n");
  const std::string printed =
      succeed("map --config " + config + " --voxel-size 0.25 --print-config");
  for (const char* line :
       {"voxel_size: 0.25 ", "window: [20,20,8] ", "crf: none ", "max_depth: 40 "})
    EXPECT_NE(("\n" + printed).find(std::string("\n") + line), std::string::npos)
        << line << "\n"
        << printed;
  const std::string whole = folder.write("whole.yaml", printed);
  EXPECT_EQ(runTool("map --print-config --config " + whole).text, printed);

  mapStreet(tinyStreet(), folder.path("out"),
            "--frames 0:1 --config " + config + " --voxel-size 0.25");
  const nlohmann::json summary = readJson(folder.path("out/summary.json"));
  EXPECT_EQ(summary["voxel_size"], 0.25);
  EXPECT_EQ(summary["options"]["window"], "20,20,8");
}

TEST(MapTool, AnInterruptEndsAfterTheFrame)
{
  constexpr int frames = 30;
  const TemporaryFolder folder;
  copyStreet(folder.path("street"));
  const auto name = [&](int frame, const std::string& kind, const char* extension) {
    return folder.path("street/" + kind + "/" + frameFileName(frame, extension));
  };
  for (int frame = 3; frame < frames; ++frame) {
    fs::copy(name(frame % 3, "image_2", ".png"), name(frame, "image_2", ".png"));
    fs::copy(name(frame % 3, "image_3", ".png"), name(frame, "image_3", ".png"));
    fs::copy(name(frame % 3, "labels", ".bin"), name(frame, "labels", ".bin"));
  }
  fs::remove(folder.path("street/times.txt"));
  std::ofstream poses(folder.path("street/poses.txt"));
  for (int frame = 0; frame < frames; ++frame)
    poses << "1 0 0 0 0 1 0 0 0 0 1 " << frame % 3 << "\n";
  poses.close();

  const std::string out = folder.path("out");
  const ToolResult result =
      runShell(PCL_SEMANTIC_BINARY_DIR "/bin/pcl_semantic_map " +
               folder.path("street") + " --labels " + folder.path("street/labels") +
               " --output " + out + " 2>&1 & while kill -0 $! && ! test -e " + out +
               "/labels/000000.png; do sleep 0.02; done; kill -INT $!; wait $!");
  EXPECT_EQ(result.code, 130) << result.text;
  const nlohmann::json summary = readJson(out + "/summary.json");
  EXPECT_GE(summary["frames"], 1);
  EXPECT_LT(summary["frames"], frames);
  std::vector<std::string> names;
  for (int frame = 0; frame < summary["frames"]; ++frame)
    names.push_back(frameFileName(frame, ""));
  EXPECT_EQ(filesIn(out), filesOfMap(names));
}

TEST(MapTool, AnEarlierRunIsReplacedAndForeignImagesAreNot)
{
  const TemporaryFolder folder;
  const std::string output = folder.path("out");
  mapStreet(tinyStreet(), output, "--crf none");
  mapStreet(tinyStreet(), output, "--crf none --frames 1:2");
  EXPECT_EQ(filesIn(output), filesOfMap({"000001"}));

  // Without a summary the images are somebody else's.
  fs::remove(output + "/summary.json");
  expectFails(mapOf(tinyStreet()) + " --output " + output, 5,
              "/labels: holds images, but no summary.json");
  EXPECT_TRUE(fs::exists(output + "/labels/000001.png"));
}

} // namespace pcl_semantic
