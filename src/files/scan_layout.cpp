// SPDX-License-Identifier: BSD-3-Clause
#include "scan_layout.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace pcl_semantic {

namespace {

constexpr std::size_t kFewest = 16; // points that say something

// Ranges of columns differ by orders of magnitude: as large as one looks at.
float
compressed(float value)
{
  return std::asinh(value);
}

} // namespace

ScanLayout::ScanLayout(const std::vector<std::uint8_t>& bytes)
    : values_(bytes.size() / sizeof(float))
{
  std::memcpy(values_.data(), bytes.data(), values_.size() * sizeof(float));
}

// In parts all over the file.
double
ScanLayout::difference(std::size_t lag) const
{
  constexpr std::size_t parts = 8, size = 840; // a multiple of 3 to 7
  if (values_.size() <= lag)
    return std::numeric_limits<double>::infinity();
  const std::size_t last = values_.size() - lag;
  double sum = 0.0;
  std::size_t count = 0;
  for (std::size_t p = 0; p < parts; ++p) {
    const std::size_t begin =
        last <= parts * size ? p * size : p * (last - size) / (parts - 1);
    for (std::size_t i = begin; i < std::min(begin + size, last); ++i) {
      const float each =
          std::abs(compressed(values_[i + lag]) - compressed(values_[i]));
      if (!std::isfinite(each))
        continue;
      sum += double(each);
      ++count;
    }
  }
  return count > 0 ? sum / double(count) : 0.0;
}

std::size_t
ScanLayout::columnsInsteadOf(std::size_t assumed) const
{
  const std::size_t points = values_.size() / std::max<std::size_t>(assumed, 1);
  if (points < kFewest)
    return 0;
  // Every second point may come from another laser: 2 and 11 times the columns are a
  // multiple of no other number of them.
  const double here = std::min(
      {difference(assumed), difference(2 * assumed), difference(11 * assumed)});
  constexpr double more = 0.9; // twice three columns are six, too
  std::size_t best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t columns = 3; columns <= 7; ++columns) {
    if (values_.size() % columns != 0 || assumed % columns == 0 ||
        columns % assumed == 0)
      continue;
    const double each = difference(columns);
    if (each < more * least) {
      least = each;
      best = columns;
    }
  }
  const double clearly = std::min(0.8, 1.0 - 2.0 / std::sqrt(double(points)));
  return least < clearly * here ? best : 0;
}

bool
ScanLayout::isAbsurd(std::size_t columns) const
{
  std::size_t absurd = 0, seen = 0;
  const std::size_t points = values_.size() / columns;
  const std::size_t step = std::max<std::size_t>(1, points / 4096);
  for (std::size_t i = 0; i < points; i += step)
    for (std::size_t axis = 0; axis < 3; ++axis, ++seen)
      absurd += std::abs(values_[i * columns + axis]) > 1e7f;
  return points >= kFewest && 10 * absurd > seen;
}

} // namespace pcl_semantic
