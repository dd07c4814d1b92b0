// SPDX-License-Identifier: BSD-3-Clause
#include "scan_layout.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace pcl_semantic {

namespace {

constexpr std::size_t kFewest = 16; // points needed for a decision
constexpr std::size_t kTurns = 8;

float
numberAt(const std::vector<std::uint8_t>& bytes, std::size_t i)
{
  float value;
  std::memcpy(&value, bytes.data() + i * sizeof(value), sizeof(value));
  return value;
}

} // namespace

ScanLayout::ScanLayout(const std::vector<std::uint8_t>& bytes)
    : bytes_(bytes), count_(bytes.size() / sizeof(float))
{
  constexpr std::size_t parts = 8, size = 840; // a multiple of 3 to 7
  for (std::size_t p = 0; p < parts; ++p) {
    const std::size_t begin =
        count_ <= parts * size ? p * size : p * (count_ - size) / (parts - 1);
    std::vector<float> part;
    // asinh, because columns differ by orders of magnitude.
    for (std::size_t i = begin; i < std::min(begin + size, count_); ++i)
      part.push_back(std::asinh(numberAt(bytes_, i)));
    parts_.push_back(std::move(part));
  }
}

double
ScanLayout::difference(std::size_t lag) const
{
  double sum = 0.0;
  std::size_t count = 0;
  for (const std::vector<float>& part : parts_)
    for (std::size_t i = lag; i < part.size(); ++i) {
      const float each = std::abs(part[i] - part[i - lag]);
      if (!std::isfinite(each))
        continue;
      sum += double(each);
      ++count;
    }
  return count > 0 ? sum / double(count) : std::numeric_limits<double>::infinity();
}

std::size_t
ScanLayout::columnsInsteadOf(std::size_t assumed) const
{
  const std::size_t points = count_ / std::max<std::size_t>(assumed, 1);
  if (points < kFewest)
    return 0;
  // Scanners may interleave lasers, so one of the nearest points is of the same laser.
  const auto differenceHere = [&](std::size_t other) {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 1; k <= kTurns; ++k)
      if (assumed * k % other != 0) // otherwise it would be the same column in the
                                    // other layout
        least = std::min(least, difference(assumed * k));
    return least;
  };
  const double clearly = std::min(0.8, 1.0 - 2.0 / std::sqrt(double(points)));
  constexpr double more = 0.9; // margin for multiples of the right number of columns
  std::size_t best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t columns = 3; columns <= 7; ++columns) {
    if (count_ % columns != 0 || assumed % columns == 0 || columns % assumed == 0)
      continue;
    const double each = difference(columns);
    if (each < more * least && each < clearly * differenceHere(columns)) {
      least = each;
      best = columns;
    }
  }
  return best == 0 && isTwice(assumed) ? 2 * assumed : best;
}

// Interleaved lasers may see different surfaces, but all on both sides. If x or y of
// every second point is never negative, its columns have another meaning.
bool
ScanLayout::isTwice(std::size_t assumed) const
{
  const std::size_t twice = 2 * assumed, pairs = count_ / twice;
  if (count_ % twice != 0 || pairs < kFewest)
    return false;
  constexpr double clearly = 0.6;
  for (std::size_t k = 1; k < kTurns; k += 2)
    if (!(difference(twice) < clearly * difference(assumed * k)))
      return false;
  const auto negative = [&](std::size_t column) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < pairs; ++i)
      count += numberAt(bytes_, i * twice + column) < 0.0f;
    return double(count) / double(pairs);
  };
  constexpr double many = 0.1;
  for (const std::size_t axis : {0u, 1u}) {
    const double first = negative(axis);
    if (first > many && first < 1.0 - many && negative(assumed + axis) == 0.0)
      return true;
  }
  return false;
}

bool
ScanLayout::isAbsurd(std::size_t columns) const
{
  std::size_t absurd = 0, seen = 0;
  const std::size_t points = count_ / columns;
  const std::size_t step = std::max<std::size_t>(1, points / 4096);
  for (std::size_t i = 0; i < points; i += step)
    for (std::size_t axis = 0; axis < 3; ++axis, ++seen)
      absurd += std::abs(numberAt(bytes_, i * columns + axis)) > 1e7f;
  return points >= kFewest && 10 * absurd > seen;
}

bool
ScanLayout::isText() const
{
  constexpr std::size_t enough = 64, most = 4096;
  return bytes_.size() >= enough &&
         std::all_of(bytes_.begin(),
                     bytes_.begin() + std::ptrdiff_t(std::min(most, bytes_.size())),
                     [](std::uint8_t byte) {
                       return (byte >= ' ' && byte < 0x7F) ||
                              (byte >= '\t' && byte <= '\r');
                     });
}

bool
ScanLayout::isSigned(std::size_t columns, std::size_t column) const
{
  std::size_t negative = 0;
  const std::size_t points = count_ / columns;
  for (std::size_t i = 0; i < points; ++i)
    negative += numberAt(bytes_, i * columns + column) < 0.0f;
  return points >= kFewest && 20 * negative > points;
}

} // namespace pcl_semantic
