// SPDX-License-Identifier: BSD-3-Clause
#include "support/temporary_folder.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/pipeline/tuning_grid.h>

#include <gtest/gtest.h>

namespace pcl_semantic {

namespace {

using Texts = std::vector<std::string>;

class Grid : public testing::Test {
protected:
  TuningGrid
  read(const std::string& text)
  {
    return readTuningGrid(folder_.write("grid.yaml", text), start_,
                          LabelSet({{"road", {}}, {"pole", {}}}));
  }

  std::string
  messageOf(const std::string& text)
  {
    std::string message = thrownMessage<BadInputException>([&] { read(text); });
    EXPECT_EQ(message.rfind(folder_.path("grid.yaml"), 0), 0u) << message;
    return message.substr(std::min(message.size(), folder_.path("grid.yaml").size()));
  }

  TemporaryFolder folder_;
  MapperConfig start_;
};

TEST_F(Grid, ListsAreSearchedAndValuesAreFixed)
{
  const TuningGrid grid = read("crf: hierarchical\n"
                               "smoothness_weight: [10, 1, 3.50]\n"
                               "cliques: [\"cubes:2\", \"cubes:0.5\"]\n"
                               "voxel_size: 0.2\n"
                               "crf_iterations: [5]\n"
                               "clique_free_label: [false]\n");
  EXPECT_EQ(grid.start.crf, "hierarchical");
  EXPECT_EQ(grid.start.map.voxel_size, 0.2);
  ASSERT_EQ(grid.axes.size(), 4u);
  EXPECT_EQ(grid.axes[0].name, "smoothness_weight"); // the order of the file
  EXPECT_EQ(grid.axes[0].candidates, (Texts{"1", "3", "3.5", "10"}));
  EXPECT_EQ(grid.axes[0].start, 1u);
  EXPECT_TRUE(grid.axes[0].is_number);
  EXPECT_EQ(grid.axes[1].candidates, (Texts{"cubes:1", "cubes:2", "cubes:0.5"}));
  EXPECT_EQ(grid.axes[1].start, 0u);
  EXPECT_FALSE(grid.axes[1].is_number);
  EXPECT_EQ(grid.axes[2].candidates, (Texts{"1", "5"}));
  EXPECT_EQ(grid.axes[3].candidates, (Texts{"true", "false"}));
  EXPECT_EQ(grid.startChoice(), (TuningChoice{1, 0, 0, 0}));
}

TEST_F(Grid, AChoiceIsAConfiguration)
{
  start_.map.fusion.hit_probability = 0.6;
  const TuningGrid grid = read("smoothness_weight: [1, 5]\nhit_probability: [0.8]\n"
                               "window: [\"84,84,24\", \"40,40,8\"]\n");
  EXPECT_EQ(printMapperConfig(grid.config(grid.startChoice())),
            printMapperConfig(start_));
  const MapperConfig config = grid.config({2, 1, 1});
  EXPECT_EQ(config.crf_parameters.smoothness_weight, 5.0);
  EXPECT_EQ(config.map.fusion.hit_probability, 0.8);
  EXPECT_EQ(config.map.window, Eigen::Vector3d(40.0, 40.0, 8.0));
}

TEST_F(Grid, ATripleInAListIsOneValue)
{
  const TuningGrid grid = read("window: [40, 40, 8]\nsmoothness_weight: [1]\n");
  EXPECT_EQ(grid.start.map.window, Eigen::Vector3d(40.0, 40.0, 8.0));
  EXPECT_EQ(grid.axes.size(), 1u);
}

TEST_F(Grid, ValuesMayNotGoTogether)
{
  const TuningGrid grid =
      read("min_probability: [0.45]\noccupied_probability: [0.2]\n");
  EXPECT_TRUE(grid.isPossible(grid.startChoice()));
  EXPECT_TRUE(grid.isPossible({1, 1}));
  EXPECT_FALSE(grid.isPossible({1, 0}));
}

TEST_F(Grid, BadGridsAreRefusedWithTheirLine)
{
  EXPECT_TRUE(holds(messageOf("crf: dense\nsmothness_weight: [1, 3]\n"),
                    " line 2: key 'smothness_weight' is not known"));
  EXPECT_TRUE(holds(messageOf("crf: dense\nsmoothness_weight: [1, -3]\n"),
                    " line 2: smoothness_weight is -3"));
  EXPECT_TRUE(holds(messageOf("crf: dense\nsmoothness_weight: [1, much]\n"),
                    " line 2: 'much'"));
  EXPECT_TRUE(holds(messageOf("crf: dens\nsmoothness_weight: [1]\n"),
                    " line 1: crf is 'dens'"));
  EXPECT_TRUE(holds(messageOf("crf_kernels: [lattice, tree]\n"), " line 1: 'tree'"));
  EXPECT_TRUE(holds(messageOf("smoothness_weight: []\n"), " line 1: no candidates"));
  EXPECT_TRUE(holds(messageOf("crf: dense\n"), "no parameter has a list"));
  EXPECT_TRUE(holds(messageOf("smoothness_weight: {a: 1}\n"), " line 1: "));
  EXPECT_TRUE(holds(messageOf("smoothness_weight: [1]\nsmoothness_weight: [2]\n"),
                    " line 2: key 'smoothness_weight' is there twice"));
}

} // namespace

} // namespace pcl_semantic
