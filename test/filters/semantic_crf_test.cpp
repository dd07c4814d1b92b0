/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "support/brute_force_crf.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/filters/semantic_crf.h>

#include <gtest/gtest.h>

namespace {

using namespace pcl_semantic;
using Cloud = pcl::PointCloud<pcl::PointXYZRGBL>;

struct LabelledCloud {
  Cloud::Ptr cloud{new Cloud};
  LabelDistributions distributions;
};

LabelledCloud
makeCloud(Eigen::Index count, unsigned seed)
{
  LabelledCloud result;
  const Eigen::Matrix3Xf positions = makeVoxelPositions(count, seed);
  std::mt19937 random(seed);
  for (Eigen::Index i = 0; i < count; ++i) {
    pcl::PointXYZRGBL point;
    point.getVector3fMap() = positions.col(i);
    point.r = static_cast<std::uint8_t>(100 + random() % 30);
    point.g = static_cast<std::uint8_t>(100 + random() % 30);
    point.b = static_cast<std::uint8_t>(100 + random() % 30);
    point.label = 99;
    result.cloud->push_back(point);
  }
  result.distributions =
      LabelDistributions(makeRandomMatrix(4, count, 0.05f, 1.0f, seed + 1));
  return result;
}

// The filter's answer, written out: eq. (6) over the given points and plain mean field.
Eigen::MatrixXd
expectedMarginals(const LabelledCloud& input, const pcl::Indices& indices,
                  int iterations)
{
  const SemanticCRFParameters parameters;
  const auto count = Eigen::Index(indices.size());
  Eigen::Matrix3Xf positions(3, count);
  Eigen::MatrixXf colours(3, count);
  Eigen::MatrixXd unary(4, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const pcl::PointXYZRGBL& point = (*input.cloud)[std::size_t(indices[i])];
    positions.col(i) = point.getVector3fMap();
    colours.col(i) << float(point.r), float(point.g), float(point.b);
    unary.col(i) =
        -input.distributions.matrix().col(indices[i]).cast<double>().array().log();
  }
  const std::vector<GaussianTerm> terms{{3.0f, 0.2f, Eigen::MatrixXf()},
                                        {8.0f, 0.2f, colours / 8.0f}};
  return plainMeanField(
      unary, makeKernelMatrix(positions, terms, 0.2 * parameters.radius + 1e-5),
      iterations);
}

TEST(SemanticCRF, EqualsThePlainModel)
{
  const LabelledCloud input = makeCloud(400, 1);
  for (const int iterations : {1, 3}) {
    SemanticCRF<pcl::PointXYZRGBL> crf;
    SemanticCRFParameters parameters;
    parameters.iterations = iterations;
    crf.setParameters(parameters);
    crf.setInputCloud(input.cloud);
    crf.setLabelDistributions(input.distributions);
    Cloud output;
    crf.filter(output);
    pcl::Indices all(input.cloud->size());
    for (std::size_t i = 0; i < all.size(); ++i)
      all[i] = pcl::index_t(i);
    const Eigen::MatrixXd expected = expectedMarginals(input, all, iterations);
    const Eigen::MatrixXd refined = crf.getLabelDistributions().matrix().cast<double>();
    EXPECT_LT((refined - expected).cwiseAbs().maxCoeff(), 1e-3);
    for (std::size_t i = 0; i < output.size(); ++i)
      EXPECT_EQ(output[i].label, crf.getLabelDistributions().mapLabel(Eigen::Index(i)));
    EXPECT_EQ(output[0].getVector3fMap(), (*input.cloud)[0].getVector3fMap());
    EXPECT_EQ(output[0].rgba, (*input.cloud)[0].rgba);
  }
}

TEST(SemanticCRF, PointsOutsideTheIndicesStayAndSendNothing)
{
  const LabelledCloud input = makeCloud(300, 2);
  const pcl::IndicesPtr indices(new pcl::Indices);
  for (int i = 0; i < 300; i += 3)
    indices->push_back(i);
  SemanticCRF<pcl::PointXYZRGBL> crf;
  crf.setInputCloud(input.cloud);
  crf.setIndices(indices);
  crf.setLabelDistributions(input.distributions);
  Cloud output;
  crf.filter(output);
  const Eigen::MatrixXd expected = expectedMarginals(input, *indices, 1);
  const Eigen::MatrixXf& refined = crf.getLabelDistributions().matrix();
  for (int i = 0; i < 300; ++i) {
    if (i % 3 == 0) {
      EXPECT_LT((refined.col(i).cast<double>() - expected.col(i / 3)).norm(), 1e-2);
    }
    else {
      EXPECT_EQ(output[std::size_t(i)].label, 99u);
      EXPECT_EQ(refined.col(i), input.distributions.matrix().col(i));
    }
  }
}

TEST(SemanticCRF, PointsAtNanKeepTheirPlaceWithoutLabel)
{
  LabelledCloud input = makeCloud(100, 3);
  (*input.cloud)[5].x = std::nanf("");
  input.cloud->is_dense = false;
  input.cloud->width = 10;
  input.cloud->height = 10;
  SemanticCRF<pcl::PointXYZRGBL> crf;
  crf.setInputCloud(input.cloud);
  crf.setLabelDistributions(input.distributions);
  crf.filter(*input.cloud); // in place
  EXPECT_EQ(crf.getSkippedPoints(), 1u);
  EXPECT_EQ((*input.cloud)[5].label, 0u);
  EXPECT_NE((*input.cloud)[6].label, 99u);
  EXPECT_EQ(input.cloud->height, 10u);
  EXPECT_FALSE(input.cloud->is_dense);
}

TEST(SemanticCRF, AnUnlabelledPointTakesTheLabelOfItsNeighbours)
{
  LabelledCloud input = makeCloud(30, 4);
  for (int i = 0; i < 30; ++i) {
    (*input.cloud)[std::size_t(i)].getVector3fMap() << 0.1f * float(i), 0.0f, 0.0f;
    input.distributions.setLabel(i, i == 15 ? 0 : 3, 0.9f);
  }
  SemanticCRF<pcl::PointXYZRGBL> crf;
  crf.setInputCloud(input.cloud);
  crf.setLabelDistributions(input.distributions);
  Cloud output;
  crf.filter(output);
  EXPECT_EQ(output[15].label, 3u);
}

TEST(SemanticCRF, WithoutALabelNearAPointStaysUnlabelled)
{
  LabelledCloud input = makeCloud(30, 4);
  for (int i = 0; i < 30; ++i) { // two groups far apart, one without any label
    (*input.cloud)[std::size_t(i)].getVector3fMap() << 0.1f * float(i % 15),
        i < 15 ? 0.0f : 50.0f, 0.0f;
    input.distributions.setLabel(i, i < 15 ? 0 : 3, 0.9f);
  }
  for (const int iterations : {0, 1, 5}) {
    SemanticCRF<pcl::PointXYZRGBL> crf;
    SemanticCRFParameters parameters;
    parameters.iterations = iterations;
    crf.setParameters(parameters);
    crf.setInputCloud(input.cloud);
    crf.setLabelDistributions(input.distributions);
    Cloud output;
    crf.filter(output);
    for (int i = 0; i < 30; ++i)
      EXPECT_EQ(output[std::size_t(i)].label, i < 15 ? 0u : 3u) << i;
    EXPECT_EQ(crf.getLabelDistributions().matrix().leftCols(15).sum(), 0.0f);
  }
}

TEST(SemanticCRF, WorksOnPointsWithoutColour)
{
  pcl::PointCloud<pcl::PointXYZL>::Ptr cloud(new pcl::PointCloud<pcl::PointXYZL>);
  const LabelledCloud coloured = makeCloud(50, 5);
  for (const pcl::PointXYZRGBL& point : *coloured.cloud) {
    pcl::PointXYZL plain;
    plain.getVector3fMap() = point.getVector3fMap();
    cloud->push_back(plain);
  }
  SemanticCRF<pcl::PointXYZL> crf;
  crf.setInputCloud(cloud);
  crf.setLabelDistributions(coloured.distributions);
  pcl::PointCloud<pcl::PointXYZL> output;
  crf.filter(output);
  EXPECT_EQ(output.size(), 50u);
  EXPECT_GT(output[0].label, 0u);
}

TEST(SemanticCRF, AnEmptyCloudGivesAnEmptyCloud)
{
  SemanticCRF<pcl::PointXYZRGBL> crf;
  crf.setInputCloud(Cloud::Ptr(new Cloud));
  crf.setLabelDistributions(LabelDistributions(4, 0));
  Cloud output;
  crf.filter(output);
  EXPECT_TRUE(output.empty());
}

TEST(SemanticCRF, RefusesWhatDoesNotFit)
{
  const LabelledCloud input = makeCloud(20, 6);
  SemanticCRF<pcl::PointXYZRGBL> crf;
  crf.setInputCloud(input.cloud);
  crf.setLabelDistributions(LabelDistributions(4, 19));
  Cloud output;
  EXPECT_THROW(crf.filter(output), InvalidParameterException);
  const auto refused = [&](auto&& change) {
    SemanticCRFParameters parameters;
    change(parameters);
    EXPECT_THROW(crf.setParameters(parameters), InvalidParameterException);
  };
  refused([](SemanticCRFParameters& p) { p.smoothness_deviation = 0.0; });
  refused([](SemanticCRFParameters& p) { p.colour_deviation = std::nan(""); });
  refused([](SemanticCRFParameters& p) { p.appearance_weight = -1.0; });
  refused([](SemanticCRFParameters& p) { p.radius = 0.0; });
  refused([](SemanticCRFParameters& p) { p.iterations = -1; });
}

} // namespace
