// SPDX-License-Identifier: BSD-3-Clause
#include "support/temporary_folder.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/files/config_file.h>
#include <pcl_semantic/pipeline/mapper_config.h>

#include <gtest/gtest.h>

#include <set>

namespace {

using namespace pcl_semantic;

std::string
writeConfig(const TemporaryFolder& folder, const std::string& text)
{
  const std::string path = folder.path("config.yaml");
  writeTextFile(path, text);
  return path;
}

// Error message for a config file.
std::string
complaintAbout(const std::string& text)
{
  const TemporaryFolder folder;
  const std::string path = writeConfig(folder, text);
  MapperConfig config;
  return thrownMessage<BadInputException>([&] { readMapperConfig(path, config); });
}

TEST(MapperConfig, SetsWhatTheFileNamesAndKeepsTheRest)
{
  const TemporaryFolder folder;
  MapperConfig config;
  config.crf_every = 5;
  readMapperConfig(writeConfig(folder,
                               "voxel_size: 0.2\nwindow: [25, 26, 8]\ncrf: none\n"
                               "pixel_fusion: product\ndisparities: 64\n"),
                   config);
  EXPECT_EQ(config.map.voxel_size, 0.2);
  EXPECT_EQ(config.map.window, Eigen::Vector3d(25, 26, 8));
  EXPECT_EQ(config.crf, CRFModelType::unary);
  EXPECT_EQ(config.map.fusion.pixel_fusion, PixelFusion::product);
  EXPECT_EQ(config.disparities, 64);
  EXPECT_EQ(config.crf_every, 5);
}

TEST(MapperConfig, OldKeysAreRefused)
{
  EXPECT_TRUE(holds(complaintAbout("voxel_size: 0.2\nhit_share: 0.2\n"),
                    "line 2: hit_share: was renamed to min_hit_ratio"));
  EXPECT_TRUE(holds(complaintAbout("crf_tolerance: 0\n"),
                    "line 1: crf_tolerance: was removed, it had no effect"));
  EXPECT_EQ(whyRemoved("voxel_size"), "");
}

TEST(MapperConfig, KeysOfPresetsArePrintedWhereTheyAreNotTheDefault)
{
  MapperConfig config;
  const std::string printed = printMapperConfig(config);
  for (const ConfigParameter& parameter : parametersOf(config)) {
    EXPECT_EQ(whyRemoved(parameter.name), "") << parameter.name;
    if (parameter.preset_default.empty())
      continue;
    EXPECT_EQ(parameter.preset_default, parameter.text()) << parameter.name;
    EXPECT_FALSE(holds(printed, "\n" + parameter.name + ":")) << parameter.name;
  }
  config.clique_parameters.superpixel.keep = true;
  EXPECT_TRUE(holds(printMapperConfig(config), "\nsuperpixel_keep: true"));
}

TEST(MapperConfig, WhatIsPrintedIsReadBackTheSame)
{
  MapperConfig config;
  config.map.voxel_size = 0.05;
  config.map.window = {10.5, 11, 12};
  config.crf_parameters.iterations = 5;
  config.map.fusion.pixel_fusion = PixelFusion::product;
  config.crf = CRFModelType::hierarchical;
  config.cliques = "cubes:0.5";
  config.crf_parameters.free_label = false;
  config.crf_parameters.normalization = Normalization::none;
  config.crf_parameters.kernel_method = KernelMethod::truncated;
  const TemporaryFolder folder;
  MapperConfig read;
  readMapperConfig(writeConfig(folder, printMapperConfig(config)), read);
  EXPECT_EQ(printMapperConfig(read), printMapperConfig(config));
  EXPECT_NE(printMapperConfig(read), printMapperConfig(MapperConfig()));
}

TEST(MapperConfig, NamesAreUniqueAndExplained)
{
  MapperConfig config;
  std::set<std::string> names;
  for (const ConfigParameter& parameter : parametersOf(config)) {
    EXPECT_TRUE(names.insert(parameter.name).second) << parameter.name;
    EXPECT_FALSE(parameter.help.empty());
    EXPECT_EQ(parameter.option().find('_'), std::string::npos);
  }
}

TEST(MapperConfig, MistakesAreNamedWithTheirLine)
{
  for (const auto& [text, complaint] : std::vector<std::pair<const char*, const char*>>{
           {"voxel_size: 0.1\nvoxel_sise: 0.2\n",
            "line 2: key 'voxel_sise' is not known"},
           {"crf: dense\ncrf: none\n", "line 2"},
           {"crf_every: often\n", "line 1: 'often' is not a number"},
           {"crf_every: 1.5\n", "line 1: '1.5', expected an integer"},
           {"window: [1, 2]\n", "line 1"},
           {"window: 1,5\n", "line 1"},
           {"voxel_size: 0\n", "voxel_size is 0 m"},
           {"voxel_size: .nan\n", "'.nan' is not a number"},
           {"crf: densest\n",
            "line 1: 'densest', expected none, dense, pn-potts or hierarchical"},
           {"crf_kernels: fast\n",
            "line 1: 'fast', expected automatic, truncated or lattice"},
           {"clique_truncation: 0\n", "clique_truncation is 0"},
           {"cliques: slic\n", "expected planes, superpixel"},
           {"crf_every: 0\n", "crf_every is 0"},
           {"network_every: 0\n", "network_every is 0"},
           {"label_confidence: 1.5\n", "label_confidence is 1.5"},
           {"hit_probability: 0.4\n", "hit_probability is 0.4"}})
    EXPECT_TRUE(holds(complaintAbout(text), complaint)) << text;
}

TEST(MapperConfig, TheWindowHoldsWhatTheSensorReaches)
{
  MapParameters parameters;
  EXPECT_EQ(parameters.withWindow().window, Eigen::Vector3d(84, 84, 24));
  parameters.max_range = 8.0;
  EXPECT_EQ(parameters.withWindow().window, Eigen::Vector3d(20, 20, 20));
  parameters.max_range = 1000.0;
  EXPECT_EQ(parameters.withWindow().window, Eigen::Vector3d(204, 204, 24));
  parameters.window = {25, 26, 8};
  EXPECT_EQ(parameters.withWindow().window, Eigen::Vector3d(25, 26, 8));
  EXPECT_TRUE(holds(complaintAbout("window: [0, 0, 8]\n"), "window is 0 0 8 m"));
}

TEST(MapperConfig, ThePresetOfThePaperIsItsHeadlineModel)
{
  MapperConfig config;
  readMapperConfig(PCL_SEMANTIC_SOURCE_DIR "/data/presets/paper.yaml", config);
  EXPECT_EQ(config.map.window, Eigen::Vector3d(25, 25, 8));
  EXPECT_EQ(config.stereo, "elas");
  EXPECT_EQ(config.crf, CRFModelType::hierarchical);
  EXPECT_EQ(config.cliques, "superpixel");
}

} // namespace
