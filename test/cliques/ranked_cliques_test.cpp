// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/cliques/ranked_cliques.h>

#include "support/thrown_message.h"

#include <pcl_semantic/cliques/cube_cliques.h>
#include <pcl_semantic/core/exceptions.h>

#include <gtest/gtest.h>

namespace pcl_semantic {

namespace {

// The first points of the cloud as one clique.
class FirstPoints : public CliqueGenerator {
public:
  explicit FirstPoints(int count) : count_(count) {}

  bool
  usesColour() const override
  {
    return true;
  }

  std::vector<pcl::PointIndices>
  generate(const Cloud& cloud) override
  {
    origin = origin_;
    means = meansOr(cloud).size();
    std::vector<pcl::PointIndices> cliques(1);
    for (int i = 0; i < count_; ++i)
      cliques[0].indices.push_back(i);
    return cliques;
  }

  Eigen::Vector3d origin; // of the last call
  std::size_t means = 0;  // number of mean positions of the last call

private:
  int count_;
};

CliqueGenerator::Cloud
line()
{
  CliqueGenerator::Cloud cloud;
  for (int i = 0; i < 6; ++i) {
    cloud.emplace_back();
    cloud.back().getVector3fMap() = Eigen::Vector3f(0.5f * float(i), 0.0f, 0.0f);
  }
  return cloud;
}

} // namespace

TEST(RankedCliques, ThePointsOfAnEarlierGeneratorLeaveTheLaterOnes)
{
  RankedCliques cliques(
      {std::make_shared<FirstPoints>(3), std::make_shared<CubeCliques>(1.0)});
  const std::vector<pcl::PointIndices> found = cliques.generate(line());
  ASSERT_EQ(found.size(), 3u); // the cube of points 0 and 1 has none left
  EXPECT_EQ(found[0].indices, (pcl::Indices{0, 1, 2}));
  EXPECT_EQ(found[1].indices, (pcl::Indices{3}));
  EXPECT_EQ(found[2].indices, (pcl::Indices{4, 5}));
}

TEST(RankedCliques, PassesItsSettings)
{
  const auto first = std::make_shared<FirstPoints>(1);
  RankedCliques cliques({first, std::make_shared<CubeCliques>(1.0)});
  EXPECT_TRUE(cliques.usesColour());
  EXPECT_EQ(generatorsOf(first).size(), 1u);
  cliques.setOrigin({1000.0, 0.0, 0.0});
  const auto cloud = std::make_shared<CliqueGenerator::Cloud>(line());
  cliques.setMeanPositions(cloud, 0.5);
  cliques.generate(*cloud);
  EXPECT_EQ(first->origin, Eigen::Vector3d(1000.0, 0.0, 0.0));
  // Indices choose among the mean positions, too.
  cliques.setInputCloud(cloud);
  cliques.setIndices(pcl::make_shared<pcl::Indices>(pcl::Indices{1, 4}));
  std::vector<pcl::PointIndices> found;
  cliques.extract(found);
  EXPECT_EQ(first->means, 2u);
  EXPECT_EQ(found[0].indices, (pcl::Indices{1}));
  CliqueGenerator::Cloud other = line();
  other.resize(5);
  expectBadParameter("6 mean positions for a cloud of 5 points",
                     [&] { cliques.generate(other); });
}

TEST(RankedCliques, RefusesNoGenerator)
{
  expectBadParameter("there is no generator", [] { RankedCliques cliques({}); });
  expectBadParameter("a generator is null", [] { RankedCliques cliques({nullptr}); });
}

} // namespace pcl_semantic
