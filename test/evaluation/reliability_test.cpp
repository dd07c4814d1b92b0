// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/evaluation/reliability.h>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include <cmath>
#include <random>

using namespace pcl_semantic;

namespace {

const LabelSet label_set({{"a", {200, 0, 0}}, {"b", {0, 200, 0}}, {"sky", {0, 0, 9}}});

// Pixels whose ground truth is drawn from what they are given, or from something else.
Reliability
drawn(double sharpness, int pixels)
{
  std::mt19937 random(3);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  LabelDistributions given(3, pixels);
  cv::Mat truth(1, pixels, CV_8UC1);
  for (int i = 0; i < pixels; ++i) {
    const double p = share(random);
    const double a = std::pow(p, sharpness), b = std::pow(1.0 - p, sharpness);
    given.column(i)[0] = float(a / (a + b));
    given.column(i)[1] = float(b / (a + b));
    truth.at<std::uint8_t>(0, i) = share(random) < p ? 1 : 2;
  }
  Reliability reliability(3, {1, 2});
  reliability.add(truth, given);
  return reliability;
}

} // namespace

TEST(Reliability, HonestProbabilitiesHaveNoError)
{
  const Reliability honest = drawn(1.0, 40000);
  for (const Reliability::Curve* const curve :
       {&honest.ofConfidence(), &honest.of(1), &honest.of(2)})
    EXPECT_LT(expectedCalibrationError(*curve), 0.015);
}

// p is given as p^3 / (p^3 + (1 - p)^3): the error is the mean of the difference.
TEST(Reliability, TooSureProbabilitiesHaveTheErrorOfTheDefinition)
{
  double expected = 0.0;
  constexpr int steps = 10000;
  for (int i = 0; i < steps; ++i) {
    const double p = (i + 0.5) / steps, a = p * p * p, q = 1.0 - p, b = q * q * q;
    expected += std::abs(a / (a + b) - p) / steps;
  }
  const Reliability sure = drawn(3.0, 40000);
  EXPECT_NEAR(expectedCalibrationError(sure.ofConfidence()), expected, 0.01);
  EXPECT_NEAR(expectedCalibrationError(sure.of(1)), expected, 0.01);
}

TEST(Reliability, CountsByHand)
{
  LabelDistributions given(3, 5);
  given.setLabel(0, 1, 0.9f);
  given.setLabel(1, 1, 0.9f);
  given.setLabel(2, 3, 0.8f);
  given.setLabel(3, 2, 0.9f); // no ground truth
  cv::Mat truth =
      (cv::Mat_<std::uint8_t>(1, 5) << 1, 2, 2, 0, 1); // the last unlabelled
  Reliability reliability(3, {1, 2});
  reliability.add(truth, given);
  std::uint64_t pixels = 0;
  for (const Reliability::Bin& bin : reliability.ofConfidence())
    pixels += bin.pixels;
  EXPECT_EQ(pixels, 3u);
  EXPECT_EQ(reliability.ofConfidence()[13].pixels, 2u);
  EXPECT_EQ(reliability.ofConfidence()[13].right, 1u);
  EXPECT_NEAR(expectedCalibrationError(reliability.ofConfidence()),
              (std::abs(1 - 1.8) + 0.8) / 3, 1e-6);
  Reliability twice = reliability;
  twice += reliability;
  EXPECT_EQ(twice.of(2)[0].pixels, 2 * reliability.of(2)[0].pixels);
  EXPECT_DOUBLE_EQ(expectedCalibrationError(twice.of(2)),
                   expectedCalibrationError(reliability.of(2)));
  const std::string json = reliabilityJson(reliability, label_set);
  EXPECT_NE(json.find("\"expected_calibration_error\""), std::string::npos);
  EXPECT_NE(json.find("null"), std::string::npos) << "empty bins have no frequency";
  EXPECT_NE(reliabilityTable(reliability, label_set).find("most probable class"),
            std::string::npos);
  EXPECT_TRUE(std::isnan(expectedCalibrationError(Reliability(3, {1}).of(1))));
}

TEST(Reliability, TheDiagramShowsTheCurves)
{
  const cv::Mat sure = reliabilityDiagram(drawn(3.0, 20000), label_set);
  const cv::Mat honest = reliabilityDiagram(drawn(1.0, 20000), label_set);
  const cv::Mat none = reliabilityDiagram(Reliability(3, {1, 2}), label_set);
  EXPECT_EQ(sure.size(), none.size());
  EXPECT_GT(cv::norm(sure, none, cv::NORM_L1), 1000.0);
  EXPECT_GT(cv::norm(sure, honest, cv::NORM_L1), 1000.0);
}

TEST(Reliability, RefusesWhatDoesNotFit)
{
  EXPECT_THROW(Reliability(3, {0}), InvalidParameterException);
  EXPECT_THROW(Reliability(3, {4}), InvalidParameterException);
  Reliability reliability(3, {1});
  EXPECT_THROW(reliability.add(cv::Mat::zeros(1, 4, CV_8UC1), LabelDistributions(3, 5)),
               BadInputException);
  EXPECT_THROW(reliability.add(cv::Mat::zeros(1, 5, CV_8UC1), LabelDistributions(2, 5)),
               BadInputException);
  EXPECT_THROW(reliability += Reliability(3, {2}), InvalidParameterException);
}
