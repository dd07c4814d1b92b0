// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "kernels/slab_crossing.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <vector>

namespace pcl_semantic {

/** \brief Rays or bundles of rays, column by column, as wide loops want them. The first
 * column of numbers is the slab that none of their rays goes beyond. */
template <std::size_t Slopes, std::size_t Numbers> struct RayTable {
  std::array<std::vector<float>, Slopes> slopes;
  std::array<std::vector<std::int32_t>, Numbers> numbers;
  std::size_t count = 0; ///< of rows; the columns have kernels::slab_lanes more

  /** \brief Makes room for some rows in all. */
  void
  reserve(std::size_t rows)
  {
    if (numbers[0].size() >= rows + kernels::slab_lanes)
      return;
    forEachColumn([&](auto& column) { column.resize(2 * rows + kernels::slab_lanes); });
  }

  /** \brief Adds some rows of another table, for which there is room. */
  void
  add(const RayTable& from, std::size_t begin, std::size_t end)
  {
    constexpr std::size_t step = 4; // what is copied beyond the end counts for nothing
    for (std::size_t i = begin; i < end; i += step) {
      const std::size_t to = count + (i - begin);
      for (std::size_t c = 0; c < Slopes; ++c)
        std::memcpy(&slopes[c][to], &from.slopes[c][i], step * sizeof(float));
      for (std::size_t c = 0; c < Numbers; ++c)
        std::memcpy(&numbers[c][to], &from.numbers[c][i], step * sizeof(std::int32_t));
    }
    count += end - begin;
  }

  /** \brief Removes the rows of which all rays end before a slab. */
  void
  removeEnded(int slab)
  {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const bool keep = numbers[0][i] >= slab;
      forEachColumn([&](auto& column) { column[kept] = column[i]; });
      kept += keep;
    }
    count = kept;
  }

private:
  template <typename Do>
  void
  forEachColumn(Do&& apply)
  {
    for (auto& column : slopes)
      apply(column);
    for (auto& column : numbers)
      apply(column);
  }
};

} // namespace pcl_semantic
