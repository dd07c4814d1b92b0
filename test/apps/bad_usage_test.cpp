// SPDX-License-Identifier: BSD-3-Clause
#include "support/bad_case.h"
#include "support/tiny_street.h"

namespace pcl_semantic {

namespace fs = std::filesystem;

namespace {

const std::string labels = "--labels STREET/labels ";

BadCase::Damage
config(const std::string& text)
{
  return [=](const std::string& street) {
    std::ofstream(street + "/config.yaml") << text;
  };
}

} // namespace

TEST(BadUsage, OptionsOfTheMap)
{
  const std::string with_config = labels + "--config STREET/config.yaml";
  expectAllFail({
      {2, "'--speed'", labels + "--speed 3"},
      {2, "'--voxel'", labels + "--voxel 0.1"},
      {2, "'--voxel-size'", labels + "--voxel-size"},
      {2, "in quotes: --left 'left/*.png'", labels + "a.png b.png c.png"},
      {2, "more than once", labels + "--crf none --crf none"},
      {2, "'10:5'", labels + "--frames 10:5"},
      {3, "street: has no frame in 7:9", labels + "--frames 7:9"},
      {2, "threads is -1", labels + "--threads -1"},
      {2, "--threads: 'abc'", labels + "--threads abc"},
      {2, "voxel_size is nan m", labels + "--voxel-size nan"},
      {2, "voxel_size is 1e-09 m", labels + "--voxel-size 1e-9"},
      {2, "window is 0 1 1 m", labels + "--window 0,1,1"},
      {2, "--window: '1 1'", labels + "--window 1,1"},
      {2, "too large", labels + "--window 99999,99999,99999"},
      {2, "window is", labels + "--window 1e300,1,1"},
      {2, "'2e9', expected an integer up to", labels + "--crf-every 2e9"},
      {2, "0", labels + "--crf hierarchical --cliques cubes:0"},
      {2, "--clique-free-label: 'perhaps', expected false or true",
       labels + "--clique-free-label perhaps"},
      {2, "--labels and --network exclude each other", labels + "--network x.yaml"},
      {2, "--model needs --network", labels + "--model x.onnx"},
      {2, "--engine needs --network", labels + "--engine opencv"},
      {2, "--engine is 'best', expected onnxruntime or opencv",
       "--network x.yaml --engine best"},
      {2, "images that --map-only leaves out", labels + "--map-only --also measured"},
      {2, "--label-set is for --labels", "--network x.yaml --label-set y.yaml"},
      {2, "expected a SEQUENCE, or --left", "map --output OUT " + labels},
      {2, "--output is missing", "map STREET " + labels},
      {3, "config.yaml: cannot be read", with_config},
      {3, "config.yaml line 2: key 'voxel_sise'", with_config,
       config("crf: none\nvoxel_sise: 0.2\n")},
      {3, "config.yaml: voxel_size is -2 m", with_config, config("voxel_size: -2\n")},
  });
}

TEST(BadUsage, OtherTools)
{
  const std::string gt = "evaluate --truth STREET/gt --prediction ";
  expectAllFail({
      {2, "output", "synthesize"},
      {2, "'--speed'", "synthesize OUT --speed 3"},
      {2, "frames", "synthesize OUT --frames 0"},
      {2, "--size 9", "synthesize OUT --size 9"},
      {2, "0", "synthesize OUT --size 0x0"},
      {2, "--seed -1", "synthesize OUT --seed -1"},
      {2, "--traffic", "synthesize OUT --traffic -1"},
      {2, "--label-noise nan", "synthesize OUT --label-noise nan"},
      {2, "--scene is 'house'", "synthesize OUT --scene house"},
      {2, "--traffic is of a street", "synthesize OUT --scene room --traffic 1"},
      {2, "--depth-noise is of a room", "synthesize OUT --depth-noise 0"},
      {2, "--depth-noise -1", "synthesize OUT --scene room --depth-noise -1"},
      {5, "calib.txt", "synthesize STREET/calib.txt/x --frames 1"},
      {3, "none/000000.png: is missing", gt + "STREET/none" + of_kitti11},
      {3, "none.yaml", gt + "STREET/gt --label-set none.yaml"},
      {5, "calib.txt", gt + "STREET/gt --output STREET/calib.txt/x" + of_kitti11},
  });
}

TEST(BadOutput, OfTheMap)
{
  expectAllFail({
      {2, "--output holds a sequence",
       "map STREET --output STREET/../street " + labels},
      {2, "--labels is the folder of labels that --output writes",
       "map STREET --output OUT --labels OUT/labels",
       [](const std::string& street) {
         fs::create_directories(fs::path(street).parent_path() / "out/labels");
       }},
      {5, "calib.txt/x", "map STREET --output STREET/calib.txt/x " + labels},
      {5, "calib.txt", "map STREET --output STREET/calib.txt " + labels},
  });
}

TEST(BadOutput, FullStandardOutput)
{
  const ToolResult result =
      runShell(PCL_SEMANTIC_BINARY_DIR "/bin/pcl_semantic_map --print-config 2>&1 "
                                       ">/dev/full");
  EXPECT_EQ(result.code, 5);
  EXPECT_EQ(result.text, "pcl_semantic_map: standard output cannot be written\n");
}

TEST(BadOutput, FullDisk)
{
  const TemporaryFolder folder;
  const std::string output = folder.path("out");
  const std::string command =
      mapOf(tinyStreet()) + " --frames 0:1 --crf none --output " + output;
  for (const auto& [bytes, name] :
       {std::pair<rlim_t, std::string>(1200, "labels/000000.png"),
        {60000, "map.pcd"}}) {
    expectDiskFull(command, bytes, output + "/" + name);
    expectNothingUnfinished(output);
  }
  succeed(command);
  EXPECT_TRUE(fs::exists(output + "/map.pcd"));
}

#ifndef __SANITIZE_ADDRESS__
TEST(OutOfMemory, IsSaid)
{
  const TemporaryFolder folder;
  const ToolResult result =
      runTool(mapOf(tinyStreet()) + " --threads 1 --voxel-size 0.02 --output " +
                  folder.path("out"),
              "ulimit -v 500000;");
  EXPECT_EQ(result.code, 6) << result.text;
  EXPECT_EQ(result.text, "pcl_semantic_map: out of memory\n");
  expectNothingUnfinished(folder.path("out"));
}
#endif

} // namespace pcl_semantic
