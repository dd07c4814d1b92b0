// SPDX-License-Identifier: BSD-3-Clause
#include "map/voxel_fusion.h"

#include <pcl_semantic/core/exceptions.h>

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace {

using namespace pcl_semantic;

double
probability(StoredLogOdds stored)
{
  return 1.0 / (1.0 + std::exp(-double(stored) * kLogOddsUnit));
}

TEST(OccupancyUpdate, FollowsBayesRuleFromEvenOdds)
{
  const FusionParameters parameters;
  const OccupancyUpdate update(parameters);
  StoredLogOdds voxel = kUnknown;
  update.hit(voxel);
  EXPECT_NEAR(probability(voxel), 0.7, 1e-4);
  update.hit(voxel);
  EXPECT_NEAR(probability(voxel), 0.49 / (0.49 + 0.09), 1e-4);
  update.miss(voxel);
  EXPECT_NEAR(probability(voxel), 0.49 * 0.4 / (0.49 * 0.4 + 0.09 * 0.6), 1e-4);
}

TEST(OccupancyUpdate, OneHitIsEnoughAndUnknownIsNotOccupied)
{
  const OccupancyUpdate update{FusionParameters()};
  StoredLogOdds voxel = kUnknown;
  EXPECT_FALSE(update.isOccupied(voxel));
  update.hit(voxel);
  EXPECT_TRUE(update.isOccupied(voxel));
}

TEST(OccupancyUpdate, ClampsSoThatAVoxelCanChangeItsMind)
{
  const FusionParameters parameters;
  const OccupancyUpdate update(parameters);
  StoredLogOdds voxel = kUnknown;
  for (int i = 0; i < 1000; ++i)
    update.hit(voxel);
  EXPECT_NEAR(probability(voxel), parameters.max_probability, 1e-3);
  int misses = 0;
  for (; update.isOccupied(voxel); ++misses)
    update.miss(voxel);
  EXPECT_LE(misses, 10);
  for (int i = 0; i < 1000; ++i)
    update.miss(voxel);
  EXPECT_NEAR(probability(voxel), parameters.min_probability, 1e-3);
  EXPECT_NE(voxel, kUnknown);
}

class Measurement : public testing::TestWithParam<PixelFusion> {};

// Three scans of several pixels each, against the formula in double precision.
TEST_P(Measurement, FusesLikelihoodsAsStated)
{
  constexpr int classes = 4;
  FusionParameters parameters;
  parameters.pixel_fusion = GetParam();
  parameters.label_max_ratio = 1e12;
  VoxelMeasurement measurement(classes, parameters);
  std::vector<double> expected(classes, 0.0);
  std::vector<float> fused(classes, 0.0f);
  VoxelRecord record;
  std::mt19937 random(6);
  std::uniform_real_distribution<float> share(0.0f, 1.0f);
  for (int scan = 0; scan < 3; ++scan) {
    const int pixels = 1 + scan * 2;
    std::vector<double> sums(classes, 0.0);
    measurement.clear();
    for (int i = 0; i < pixels; ++i) {
      float p[classes];
      float sum = 0.0f;
      for (float& value : p)
        sum += value = share(random);
      for (int k = 0; k < classes; ++k) {
        p[k] /= sum;
        sums[k] += std::log(std::max(double(p[k]), parameters.label_min_probability));
      }
      measurement.addDistribution(p);
    }
    measurement.fuseInto(record, fused.data());
    for (int k = 0; k < classes; ++k)
      expected[k] += GetParam() == PixelFusion::mean ? sums[k] / pixels : sums[k];
  }
  EXPECT_EQ(record.label_observations, 3u);
  const double largest = *std::max_element(expected.begin(), expected.end());
  for (int k = 0; k < classes; ++k)
    EXPECT_NEAR(fused[k], expected[k] - largest, 1e-4);
}

INSTANTIATE_TEST_SUITE_P(VoxelMeasurement, Measurement,
                         testing::Values(PixelFusion::mean, PixelFusion::product));

// The mean of a scan's hits, then of the scans; a surface that moves is followed.
TEST(VoxelMeasurement, MeanPositionOfHits)
{
  VoxelMeasurement measurement(1, FusionParameters());
  VoxelRecord record;
  float fused = 0.0f;
  EXPECT_EQ(record.position[0], kVoxelCentre);
  measurement.addPosition({0, 100, 1023});
  measurement.addPosition({0, 300, 1023});
  measurement.fuseInto(record, &fused);
  EXPECT_EQ(record.position[0], 32); // half of a unit of 2^-10
  EXPECT_EQ(record.position[1], 64 * 200 + 32);
  EXPECT_EQ(record.position[2], 65536 - 32);
  measurement.clear();
  measurement.addPosition({512, 200, 1023});
  measurement.fuseInto(record, &fused);
  EXPECT_EQ(record.position[0], 64 * 256 + 32);
  EXPECT_EQ(record.position[1], 64 * 200 + 32);
  EXPECT_EQ(record.position[2], 65536 - 32);
  for (int scan = 0; scan < 5000; ++scan)
    measurement.fuseInto(record, &fused);
  EXPECT_NEAR(record.position[0], 64 * 512 + 32, 256);
}

TEST(VoxelMeasurement, MeanColourAndUnlabelledPixels)
{
  VoxelMeasurement measurement(2, FusionParameters());
  const float unlabelled[2] = {0.0f, 0.0f};
  measurement.addColour(0x0A1420u);
  measurement.addColour(0x1E2840u);
  measurement.addDistribution(unlabelled);
  VoxelRecord record;
  float fused[2] = {0.0f, 0.0f};
  measurement.fuseInto(record, fused);
  EXPECT_EQ(record.observations, 1u);
  EXPECT_EQ(record.label_observations, 0u);
  EXPECT_EQ(record.colour_sum[0] / record.colour_count, 20u);
  EXPECT_EQ(record.colour_sum[1] / record.colour_count, 30u);
  EXPECT_EQ(record.colour_sum[2] / record.colour_count, 48u);
}

// What FusionParameters allow fits the stored units, and keeps its sign.
TEST(OccupancyUpdate, TheStrongestUpdatesFit)
{
  FusionParameters parameters;
  parameters.hit_probability = 0.9995;
  parameters.miss_probability = 0.0005;
  parameters.min_probability = 0.0005;
  parameters.max_probability = 0.9995;
  EXPECT_NO_THROW(parameters.validate());
  const OccupancyUpdate update(parameters);
  StoredLogOdds voxel = kUnknown;
  update.hit(voxel);
  EXPECT_NEAR(probability(voxel), 0.9995, 1e-5);
  update.miss(voxel);
  update.miss(voxel);
  EXPECT_NEAR(probability(voxel), 0.0005, 1e-5);
}

TEST(LogSums, AreThoseOfTheStandardLibrary)
{
  std::mt19937 random(3);
  std::uniform_real_distribution<float> exponent(-20.0f, 0.0f);
  for (const std::size_t count : {1, 2, 11, 16, 17, 40}) {
    std::vector<float> values(count);
    for (float& value : values)
      value = std::exp(exponent(random));
    values[0] = count % 2 == 0 ? 0.0f : 1.0f;
    std::vector<std::int64_t> sums(count, 7);
    addLogs(values.data(), count, 0.01f, sums.data());
    for (std::size_t k = 0; k < count; ++k)
      EXPECT_NEAR(double(sums[k] - 7),
                  std::log(double(std::max(values[k], 0.01f))) *
                      double(1 << kLogFractionBits),
                  5.0)
          << values[k];
  }
}

TEST(FusionParameters, RefusesWhatCannotWork)
{
  const auto refused = [](auto&& change) {
    FusionParameters parameters;
    change(parameters);
    EXPECT_THROW(parameters.validate(), InvalidParameterException);
  };
  refused([](FusionParameters& p) { p.hit_probability = 0.5; });
  refused([](FusionParameters& p) { p.hit_probability = 0.9997; });
  refused([](FusionParameters& p) { p.miss_probability = 0.0002; });
  refused([](FusionParameters& p) { p.miss_probability = 0.6; });
  refused([](FusionParameters& p) { p.max_probability = 1.0; });
  refused([](FusionParameters& p) { p.min_probability = 0.0; });
  refused([](FusionParameters& p) { p.label_min_probability = std::nan(""); });
  refused([](FusionParameters& p) { p.label_max_ratio = 1.0; });
  EXPECT_NO_THROW(FusionParameters().validate());
}

TEST(OccupancyProbability, BeginsAtThePriorAndKeepsTheOrder)
{
  EXPECT_FLOAT_EQ(occupancyProbability(0.0f), kOccupancyPrior);
  EXPECT_LT(occupancyProbability(std::log(0.4f / 0.6f)), kOccupancyPrior);
  // One hit: 0.27 / 0.73 * 7 / 3 to 1
  EXPECT_NEAR(occupancyProbability(std::log(0.7f / 0.3f)), 0.463, 0.001);
}

} // namespace
