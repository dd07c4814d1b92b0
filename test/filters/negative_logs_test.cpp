// SPDX-License-Identifier: BSD-3-Clause
#include "filters/negative_logs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

namespace {

using namespace pcl_semantic;

// From 1e-7 to 1, closer to each other where they are small.
std::vector<float>
probabilities()
{
  std::vector<float> values;
  for (int i = 0; i < 100003; ++i)
    values.push_back(1e-7f * std::exp2(float(i) * (23.253496f / 100002.0f)));
  return values;
}

TEST(NegativeLogs, AreThoseOfTheMathematicalLibrary)
{
  constexpr float smallest = 1e-6f;
  const std::vector<float> values = probabilities();
  std::vector<float> logs = values;
  negateLogs(logs.data(), logs.size(), smallest);
  for (std::size_t i = 0; i < logs.size(); ++i) {
    const double expected = -std::log(double(std::max(values[i], smallest)));
    ASSERT_NEAR(logs[i], expected, 1e-7 + 2e-7 * expected) << values[i];
  }
}

// A cloud's labels depend on these bits: they are the same for any number of
// values and on every platform.
TEST(NegativeLogs, HaveTheSameBitsEverywhere)
{
  std::vector<float> values;
  for (int i = 1; i <= 100000; ++i)
    values.push_back(float(i) / 100000.0f);
  std::vector<float> logs = values;
  negateLogs(logs.data(), logs.size(), 1e-6f);
  std::uint64_t digest = 0xCBF29CE484222325u; // FNV-1a of 32-bit words
  for (const float value : logs) {
    std::uint32_t bits = 0;
    std::memcpy(&bits, &value, sizeof(bits));
    digest = (digest ^ bits) * 0x100000001B3u;
  }
  EXPECT_EQ(digest, 11274029185852127504u);
  for (const std::size_t count : {1u, 3u, 4u, 7u, 21u, 60u}) {
    std::vector<float> some(values.begin(), values.begin() + long(count));
    negateLogs(some.data(), some.size(), 1e-6f);
    for (std::size_t i = 0; i < count / 4 * 4; ++i)
      EXPECT_EQ(some[i], logs[i]);
  }
}

} // namespace
