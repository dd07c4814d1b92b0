/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

// Included once a tier, behind float_lanes_tier.hpp: the product with the weights.

// The product for some points and some blocks of rows at a time, in enough sums for
// the units that add.
template <int points, int blocks>
PCL_SEMANTIC_INLINE void
addRows(const std::uint32_t* neighbours, const float* weights, std::size_t stride,
        std::size_t length, const float* values, std::size_t rows, float* result)
{
  constexpr int ways = points * blocks >= 3 ? 2 : 4;
  Floats sums[ways][points][blocks] = {};
  for (std::size_t e = 0; e < length; e += ways)
    for (int w = 0; w < ways; ++w) {
      const float* const from = values + neighbours[e + w] * rows;
      for (int b = 0; b < blocks; ++b) {
        const Floats value = load(from + b * lanes);
        for (int p = 0; p < points; ++p)
          sums[w][p][b] += value * weights[std::size_t(p) * stride + e + w];
      }
    }
  for (int p = 0; p < points; ++p)
    for (int b = 0; b < blocks; ++b) {
      Floats sum = sums[0][p][b];
      for (int w = 1; w < ways; ++w)
        sum += sums[w][p][b];
      float* const to = result + std::size_t(p) * rows + b * lanes;
      store(load(to) + sum, to);
    }
}

// Numbers of the neighbours, behind them that of a point of the group.
PCL_SEMANTIC_INLINE void
listNeighbours(const GroupView& group, std::uint32_t* neighbours)
{
  for (std::size_t r = 0; r < group.count; ++r) {
    for (std::size_t k = 0; k < longest_run; k += lanes)
      store(lane() + (group.runs[r] >> run_length_bits) + std::uint32_t(k),
            neighbours + k);
    neighbours += group.runs[r] & run_length_mask;
  }
  for (int k = 0; k < most_points; ++k)
    neighbours[k] = std::uint32_t(group.point);
}

PCL_SEMANTIC_TARGET void
addProduct(const GroupView& group, const std::uint32_t* packed, const float* values,
           std::size_t rows, float* scratch, float* result)
{
  const std::size_t stride = scratchStride(group.length);
  auto* const neighbours =
      reinterpret_cast<std::uint32_t*>(scratch + most_points * stride);
  listNeighbours(group, neighbours);
  for (std::size_t p = 0; p < std::size_t(group.points); ++p)
    unpackLine(packed + p * strideOf(group.length) / 2, group.length,
               scratch + p * stride);
  const std::size_t length = group.length;
  constexpr int blocks = lanes > 4 ? 16 / lanes : 2;
  for (std::size_t row = 0; row < rows; row += blocks * lanes) {
    const float* const from = values + row;
    float* const to = result + row;
    switch (group.points) {
    case 4:
      addRows<4, blocks>(neighbours, scratch, stride, length, from, rows, to);
      break;
    case 3:
      addRows<3, blocks>(neighbours, scratch, stride, length, from, rows, to);
      break;
    case 2:
      addRows<2, blocks>(neighbours, scratch, stride, length, from, rows, to);
      break;
    default:
      addRows<1, blocks>(neighbours, scratch, stride, length, from, rows, to);
    }
  }
}
