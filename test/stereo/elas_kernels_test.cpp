// SPDX-License-Identifier: BSD-3-Clause

// The inner loops of every tier against plain ones that can be checked by reading. All
// numbers are whole: results have to be equal.

#include "stereo/kernels/elas_loops.h"
#include "support/supported_tiers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <random>
#include <vector>

namespace pcl_semantic::kernels {
namespace {

std::vector<std::uint8_t>
randomBytes(std::size_t count, unsigned seed)
{
  std::mt19937 random(seed);
  std::vector<std::uint8_t> bytes(count);
  for (std::uint8_t& byte : bytes)
    byte = std::uint8_t(random());
  return bytes;
}

int
distance(const std::uint8_t* a, const std::uint8_t* b)
{
  int sum = 0;
  for (int i = 0; i < descriptor_bytes; ++i)
    sum += std::abs(a[i] - b[i]);
  return sum;
}

TEST(ElasKernels, GradientsAreSobels)
{
  for (const int width : {1, 2, 3, 70}) {
    const auto rows = randomBytes(std::size_t(3 * width), 5);
    for (const SimdTier tier : supportedTiers()) {
      std::vector<std::uint8_t> across(rows.size()), down(rows.size());
      elasLoops(tier).gradients(rows.data(), rows.data() + width,
                                rows.data() + 2 * width, width, across.data(),
                                down.data());
      for (int u = 0; u < width; ++u) {
        double sums[2] = {};
        for (int y = -1; y <= 1; ++y)
          for (int x = -1; x <= 1; ++x)
            if (u > 0 && u < width - 1) {
              const int grey = rows[std::size_t((y + 1) * width + u + x)];
              sums[0] += x * (2 - std::abs(y)) * grey;
              sums[1] += y * (2 - std::abs(x)) * grey;
            }
        const auto byte = [](double sum) {
          return std::min(255.0, std::max(0.0, std::floor(sum / 4.0) + 128.0));
        };
        EXPECT_EQ(across[std::size_t(u)], byte(sums[0])) << nameOf(tier) << " " << u;
        EXPECT_EQ(down[std::size_t(u)], byte(sums[1])) << nameOf(tier) << " " << u;
      }
    }
  }
}

TEST(ElasKernels, DescriptorsAreGatheredAndCompared)
{
  constexpr int count = 48;
  const auto plane = randomBytes(count + descriptor_bytes, 6);
  const std::uint8_t* elements[descriptor_bytes];
  for (int i = 0; i < descriptor_bytes; ++i)
    elements[i] = plane.data() + i * 7 % descriptor_bytes;
  for (const SimdTier tier : supportedTiers()) {
    std::vector<std::uint8_t> gathered(count * descriptor_bytes);
    elasLoops(tier).gather(elements, count, gathered.data());
    for (int u = 0; u < count; ++u)
      for (int i = 0; i < descriptor_bytes; ++i)
        ASSERT_EQ(gathered[std::size_t(u * descriptor_bytes + i)], elements[i][u]);
    std::vector<std::uint16_t> costs(count, 11);
    const std::uint8_t* const own = gathered.data() + 5 * descriptor_bytes;
    elasLoops(tier).addDistances(own, gathered.data(), count, costs.data());
    for (int u = 0; u < count; ++u)
      ASSERT_EQ(costs[std::size_t(u)],
                11 + distance(own, gathered.data() + u * descriptor_bytes));
  }
}

/** \brief A row of random descriptors, part of which match, with random priors. */
class MapDisparity : public testing::TestWithParam<int> {
protected:
  static constexpr int width = 117, disparities = 64, cell = 10;

  MapDisparity()
      : own_(randomBytes(padded, 1)), other_(randomBytes(padded, 2)), expected_(width),
        seen_(12 * disparities / 8), prior_(disparity_steps * 8)
  {
    std::mt19937 random(3);
    for (auto& value : expected_)
      value = random() % 7 == 0
                  ? no_disparity
                  : std::int16_t(random() % (disparities * disparity_steps));
    for (auto& value : seen_)
      value = random() % 3 == 0 ? std::uint8_t(random()) : std::uint8_t(0);
    for (auto& value : prior_)
      value = random() % 8 == 0 ? no_energy : std::uint16_t(random() % 900);
    row_.own = own_.data() + descriptor_margin * descriptor_bytes;
    row_.other = other_.data() + descriptor_margin * descriptor_bytes;
    row_.width = width;
    row_.disparities = disparities;
    row_.direction = GetParam();
    row_.plane = expected_.data();
    row_.seen = seen_.data();
    row_.cell_size = cell;
    row_.prior = prior_.data();
    row_.floor = 450;
  }

  int
  distanceAt(int u, int d) const
  {
    return distance(row_.own + u * descriptor_bytes,
                    row_.other + (u + row_.direction * d) * descriptor_bytes);
  }

  // Least energy of disparity d of a pixel, or no_energy.
  int
  energyAt(int u, int d) const
  {
    int prior = no_energy;
    const std::uint8_t bits = seen_[std::size_t(u / cell * (disparities / 8) + d / 8)];
    if (bits >> d % 8 & 1)
      prior = row_.floor;
    const int expected = expected_[std::size_t(u)];
    const int place = d - (expected / disparity_steps - 3);
    if (expected >= 0 && place >= 0 && place < 8)
      prior = std::min<int>(
          prior, prior_[std::size_t(expected % disparity_steps * 8 +
                                    (row_.direction < 0 ? 7 - place : place))]);
    return prior == no_energy ? int(no_energy) : prior + distanceAt(u, d);
  }

  static constexpr std::size_t padded =
      std::size_t(width + 2 * descriptor_margin + 16) * descriptor_bytes;
  std::vector<std::uint8_t> own_, other_;
  std::vector<std::int16_t> expected_;
  std::vector<std::uint8_t> seen_;
  std::vector<std::uint16_t> prior_;
  MatchRow row_;
};

TEST_P(MapDisparity, IsThatOfTheLeastEnergy)
{
  for (const SimdTier tier : supportedTiers()) {
    std::vector<std::int16_t> found(width);
    elasLoops(tier).match(row_, found.data());
    int matched = 0;
    for (int u = 0; u < width; ++u) {
      int least = no_energy;
      const int reach = row_.direction < 0 ? u + 1 : width - u;
      for (int d = 0; d < std::min(disparities, reach); ++d)
        least = std::min(least, energyAt(u, d));
      const int value = found[std::size_t(u)];
      ASSERT_EQ(value < 0, least == no_energy) << nameOf(tier) << " pixel " << u;
      if (value < 0)
        continue;
      ++matched;
      // Half a step either way belongs to two disparities: one of them is the one.
      bool explained = false;
      for (int d = std::max(0, value / disparity_steps - 1);
           d <= value / disparity_steps + 1; ++d) {
        if (d >= std::min(disparities, reach) || energyAt(u, d) != least)
          continue;
        const double e0 = distanceAt(u, d - 1), e1 = distanceAt(u, d),
                     e2 = distanceAt(u, d + 1), rise = std::max(e0, e2) - e1;
        const double fraction = rise > 0 ? (e0 - e2) / (2 * rise) : 0.0;
        const double refined =
            std::max(0.0, d + std::min(0.5, std::max(-0.5, fraction)));
        explained |= std::abs(refined * disparity_steps - value) <= 0.5 + 1e-9;
      }
      EXPECT_TRUE(explained) << nameOf(tier) << " pixel " << u << " has " << value;
    }
    EXPECT_GT(matched, width / 2);
  }
}

INSTANTIATE_TEST_SUITE_P(ElasKernels, MapDisparity, testing::Values(-1, 1));

TEST(ElasKernels, SmoothingIsTheMeanOfWhatIsLikeThePixel)
{
  constexpr int count = 150, radius = 5, range = 64;
  std::mt19937 random(9);
  std::vector<std::int16_t> values(count + 2 * radius);
  for (auto& value : values)
    value = random() % 5 == 0 ? no_disparity : std::int16_t(900 + random() % 200);
  const std::int16_t* neighbours[2 * radius + 1];
  for (int i = 0; i <= 2 * radius; ++i)
    neighbours[i] = values.data() + i;
  for (const SimdTier tier : supportedTiers()) {
    std::vector<std::int16_t> smooth(count);
    smoothing(tier)(values.data() + radius, neighbours, 2 * radius + 1, range, count,
                    smooth.data());
    for (int u = 0; u < count; ++u) {
      const int own = values[std::size_t(u + radius)];
      double sum = 0.0, number = 0.0;
      for (int i = 0; i <= 2 * radius; ++i) {
        const int other = values[std::size_t(u + i)];
        if (other >= 0 && std::abs(other - own) <= range) {
          sum += other;
          ++number;
        }
      }
      if (own < 0)
        EXPECT_EQ(smooth[std::size_t(u)], no_disparity);
      else
        EXPECT_NEAR(smooth[std::size_t(u)], sum / number, 0.5 + 1e-3) << nameOf(tier);
    }
  }
}

} // namespace
} // namespace pcl_semantic::kernels
