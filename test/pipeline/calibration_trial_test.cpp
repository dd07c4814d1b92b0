// SPDX-License-Identifier: BSD-3-Clause
#include "support/plain_calibration.h"

#include <pcl_semantic/labelling/calibration_fit.h>
#include <pcl_semantic/pipeline/calibration_trial.h>

#include <gtest/gtest.h>

namespace pcl_semantic {
namespace {

CalibrationSamples
someSequence(std::size_t count, unsigned seed)
{
  CalibrationSamples samples;
  samples.network = randomNetwork(3, Eigen::Index(count), seed);
  samples.features = randomFeatures(count, seed + 1);
  std::mt19937 random(seed + 2);
  std::discrete_distribution<int> draw{1.0, 2.0, double(seed)};
  for (std::size_t i = 0; i < count; ++i)
    samples.truth.push_back(Label(draw(random) + 1));
  return samples;
}

// A sequence with ten times as many samples counts no more.
TEST(TryCalibration, EverySequenceCountsAlike)
{
  CalibrationSamples first = someSequence(300, 1), second = someSequence(200, 9);
  first.weights.assign(300, 1.0f);
  second.weights.assign(200, 1.0f);
  CalibrationSamples longer = first;
  longer.weights.assign(300, 10.0f);
  const CalibrationTrial one = tryCalibration({first, second}, {}, {});
  const CalibrationTrial ten = tryCalibration({longer, second}, {}, {});
  EXPECT_LT((one.all.bias - ten.all.bias).cwiseAbs().maxCoeff(), 1e-4f);
  EXPECT_NEAR(one.all.sharpness, ten.all.sharpness, 1e-4f);
  ASSERT_EQ(one.without.size(), 2u);
  EXPECT_GT((one.without[0].bias - one.without[1].bias).norm(), 0.01f);
}

// The calibration without a sequence equals the one from the other sequences.
TEST(TryCalibration, LeavesOneSequenceOut)
{
  const CalibrationSamples first = someSequence(300, 1), second = someSequence(200, 9);
  const CalibrationTrial trial = tryCalibration({first, second}, {2}, {});
  ASSERT_EQ(trial.without.size(), 2u);
  EXPECT_EQ(trial.without[0].bias, fitCalibration(second, {}).bias);
  EXPECT_EQ(trial.without[1].bias, fitCalibration(first, {}).bias);
  EXPECT_EQ(trial.without[1].ground, std::vector<Label>{2});
  std::uint64_t held_out = 0;
  for (Label truth = 1; truth <= 3; ++truth)
    for (Label prediction = 1; prediction <= 3; ++prediction)
      held_out += trial.held_out(truth, prediction);
  EXPECT_EQ(held_out, 500u);
  EXPECT_TRUE(tryCalibration({first}, {}, {}).without.empty());
}

// Three sequences of one frame each, of classes 1, 1 and 2 alone.
TEST(TryCalibration, KnowsWhatItHasSeen)
{
  std::vector<CalibrationSamples> sequences;
  for (const Eigen::Index row : {0, 0, 1}) {
    sequences.push_back(someSequence(200, unsigned(sequences.size()) + 1));
    sequences.back().frames.resize(1);
    for (const auto& [feature, knots] : CalibrationOptions().curves) {
      sequences.back().frames[0].push_back(
          Eigen::MatrixXf::Zero(3, Eigen::Index(knots.size())));
      sequences.back().frames[0].back()(row, 1) = 1.0f;
    }
  }
  const CalibrationTrial trial = tryCalibration(sequences, {}, {});
  ASSERT_EQ(trial.all.seen.size(), trial.all.curves.size());
  EXPECT_NEAR(trial.all.seen[0](0, 1), 2.0f / 3.0f, 1e-6f);
  EXPECT_NEAR(trial.all.seen[0](1, 1), 1.0f / 3.0f, 1e-6f);
  EXPECT_EQ(trial.all.usual_distance, 1.0f); // the third has nothing of the others
  EXPECT_EQ(trial.without[2].seen[0](0, 1), 1.0f);
  EXPECT_EQ(trial.without[2].usual_distance, 0.0f);
}

} // namespace
} // namespace pcl_semantic
