// SPDX-License-Identifier: BSD-3-Clause
#include "support/plain_cloud_crf.h"
#include "support/plain_mean_field.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/filters/semantic_crf.h>

#include <gtest/gtest.h>

namespace {

using namespace pcl_semantic;
using Cloud = pcl::PointCloud<pcl::PointXYZRGBL>;

// Weights of a truncated kernel have 8 bits, so a message may be off by 1/128 of it:
// with those of this cloud that is up to 0.01 of a marginal.
constexpr double tolerance = 0.01;

Eigen::MatrixXd
expectedMarginals(const CrfCloud& input, int iterations)
{
  PlainMeanField inference(
      makePlainCrf(input, allIndices(input.cloud->size()), SemanticCRFParameters()));
  for (int i = 0; i < iterations; ++i)
    inference.update();
  return inference.q;
}

LabelDistributions
refinedBy(const SemanticCRFParameters& parameters, const CrfCloud& input,
          const std::vector<Label>& thin = {})
{
  SemanticCRF<pcl::PointXYZRGBL> crf;
  crf.setParameters(parameters);
  crf.setThinLabels(thin);
  crf.setInputCloud(input.cloud);
  crf.setLabelDistributions(input.distributions);
  Cloud output;
  crf.filter(output);
  return crf.getLabelDistributions();
}

TEST(SemanticCRF, EqualsThePlainModel)
{
  const CrfCloud input = makeCrfCloud(400, 1);
  for (const int iterations : {1, 3}) {
    SemanticCRF<pcl::PointXYZRGBL> crf;
    SemanticCRFParameters parameters;
    parameters.iterations = iterations;
    crf.setParameters(parameters);
    crf.setInputCloud(input.cloud);
    crf.setLabelDistributions(input.distributions);
    Cloud output;
    crf.filter(output);
    const Eigen::MatrixXd expected = expectedMarginals(input, iterations);
    const Eigen::MatrixXd refined = crf.getLabelDistributions().matrix().cast<double>();
    EXPECT_LT((refined - expected).cwiseAbs().maxCoeff(), tolerance);
    EXPECT_LT((refined - expected).cwiseAbs().mean(), tolerance / 10);
    for (std::size_t i = 0; i < output.size(); ++i)
      EXPECT_EQ(output[i].label, crf.getLabelDistributions().mapLabel(Eigen::Index(i)));
    EXPECT_EQ(output[0].getVector3fMap(), (*input.cloud)[0].getVector3fMap());
    EXPECT_EQ(output[0].rgba, (*input.cloud)[0].rgba);
  }
}

TEST(SemanticCRF, ATemperatureMakesProbabilitiesLessSureAndKeepsLabels)
{
  const CrfCloud input = makeCrfCloud(300, 4);
  const auto refine = [&](double temperature) {
    SemanticCRFParameters parameters;
    parameters.temperature = temperature;
    return refinedBy(parameters, input);
  };
  const LabelDistributions sure = refine(1.0), tempered = refine(3.0);
  const LabelDistributions hot = refine(1000.0);
  for (Eigen::Index i = 0; i < sure.size(); ++i) {
    Eigen::ArrayXd expected =
        sure.matrix().col(i).cast<double>().array().max(1e-30).pow(1.0 / 3.0);
    expected /= expected.sum();
    EXPECT_LT(
        (tempered.matrix().col(i).cast<double>().array() - expected).abs().maxCoeff(),
        1e-5);
    EXPECT_EQ(tempered.mapLabel(i), sure.mapLabel(i));
    EXPECT_EQ(hot.mapLabel(i), sure.mapLabel(i)); // where classes are nearly alike
  }
}

TEST(SemanticCRF, ThinThingsStayWhatTheyWereMeasuredAsUnlessMuchOutvoted)
{
  const CrfCloud input = makeCrfCloud(300, 5);
  const auto refine = [&](double weight, bool keep, const std::vector<Label>& thin) {
    SemanticCRFParameters parameters;
    parameters.smoothness_weight = weight;
    parameters.keep_thin = keep;
    return refinedBy(parameters, input, thin);
  };
  int kept_others = 0, outvoted = 0;
  for (const double weight : {3.0, 400.0}) {
    const LabelDistributions all = refine(weight, true, {});
    const LabelDistributions kept = refine(weight, true, {2});
    EXPECT_TRUE(refine(weight, false, {2}).matrix() == all.matrix());
    for (Eigen::Index i = 0; i < kept.size(); ++i) {
      const Eigen::VectorXf marginal = all.matrix().col(i);
      const Eigen::VectorXf measured = input.distributions.matrix().col(i) /
                                       input.distributions.matrix().col(i).sum();
      const int winner = int(all.mapLabel(i)) - 1;
      const double odds = double(marginal[winner]) * measured[1] /
                          (double(marginal[1]) * std::max(measured[winner], 1e-6f));
      if (input.distributions.mapLabel(i) == 2 && odds < 403.0) {
        EXPECT_LT((kept.matrix().col(i) - measured).norm(), 1e-6f);
        kept_others += winner != 1;
      }
      else if (input.distributions.mapLabel(i) != 2 || odds > 404.0) {
        EXPECT_TRUE(kept.matrix().col(i) == marginal);
        outvoted += odds > 404.0;
      }
    }
  }
  EXPECT_GT(kept_others, 5);
  EXPECT_GT(outvoted, 5);
}

TEST(SemanticCRF, ThinLabelsAreClassesThatThereAre)
{
  const CrfCloud input = makeCrfCloud(40, 1);
  const int classes = input.distributions.classes();
  for (const int label : {0, classes + 1, 200})
    EXPECT_TRUE(throws<InvalidParameterException>(
        "thin labels: " + std::to_string(label) + ", expected 1 to " +
            std::to_string(classes),
        [&] {
          refinedBy(SemanticCRFParameters(), input, {1, Label(label)});
        }));
}

TEST(SemanticCRF, AnUnlabelledPointTakesTheLabelOfItsNeighbours)
{
  CrfCloud input = makeCrfCloud(30, 4);
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
  CrfCloud input = makeCrfCloud(30, 4);
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

TEST(SemanticCRF, AnEmptyCloudGivesAnEmptyCloud)
{
  SemanticCRF<pcl::PointXYZRGBL> crf;
  crf.setInputCloud(Cloud::Ptr(new Cloud));
  crf.setLabelDistributions(LabelDistributions(4, 0));
  Cloud output;
  crf.filter(output);
  EXPECT_TRUE(output.empty());
}

} // namespace
