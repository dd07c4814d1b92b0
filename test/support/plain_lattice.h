// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <stdexcept>
#include <vector>

namespace pcl_semantic {

/** \brief The permutohedral lattice of Adams, Baek and Davis (2010), a readable
 * single-threaded reference: Gaussian sums over N points in linear time, result_i ~ sum
 * over all j (i included) of exp(-|f_i - f_j|^2 / 2) value_j up to a constant factor.
 *
 * Values are in blocks of four floats, which compilers vectorise. */
class PlainLattice {
public:
  /** \brief Blocks of four rows; point i owns the columns i * blocks ... */
  using Blocks = Eigen::Array<float, 4, Eigen::Dynamic>;

  /** \param[in] features d x N, divided by their deviations
   * \throws std::overflow_error if coordinates exceed 16 bits: centre them first */
  explicit PlainLattice(const Eigen::MatrixXf& features)
      : d_(int(features.rows())), points_(features.cols()), keys_(d_, points_)
  {
    for (int j = 0; j <= d_; ++j)
      scale_.push_back(std::sqrt(2.0f / 3.0f) * float(d_ + 1) /
                       std::sqrt(float(j) * float(j + 1)));
    simplex_.resize(std::size_t(points_) * std::size_t(d_ + 1));
    weights_.resize(simplex_.size());
    order_.resize(simplex_.size());
    for (Eigen::Index i = 0; i < points_; ++i)
      embed(features.col(i).data(), i);
    findNeighbours();
  }

  Eigen::Index
  vertices() const
  {
    return keys_.size();
  }

  /** \brief Scale of the sums that makes the response of a vertex to itself 1, if it
   * has all neighbours. */
  float
  gain() const
  {
    return 1.0f / (1.0f + std::pow(2.0f, -float(d_)));
  }

  /** \brief Splats values times splat_scale to the lattice, blurs, and slices them at
   * the points times slice_scale; \a reversed is the transposed map. */
  void
  filter(const Blocks& values, Eigen::Index blocks, const Eigen::ArrayXf& splat_scale,
         const Eigen::ArrayXf& slice_scale, Blocks& result, bool reversed = false)
  {
    front_.setZero(4, (vertices() + 1) * blocks); // the last column represents missing
                                                  // vertices
    back_.setZero(4, (vertices() + 1) * blocks);
    for (Eigen::Index i = 0; i < points_; ++i)
      for (int k = 0; k <= d_; ++k) {
        const Eigen::Index v = simplex_[at(i, k)];
        const float weight = weights_[at(i, k)] * splat_scale[i];
        for (Eigen::Index b = 0; b < blocks; ++b)
          front_.col(v * blocks + b) += weight * values.col(i * blocks + b);
      }
    for (int j = 0; j <= d_; ++j)
      blur(reversed ? d_ - j : j, blocks);
    const float alpha = gain();
    for (Eigen::Index i = 0; i < points_; ++i)
      for (Eigen::Index b = 0; b < blocks; ++b) {
        Eigen::Array4f sum = Eigen::Array4f::Zero();
        for (int k = 0; k <= d_; ++k)
          sum += weights_[at(i, k)] * front_.col(simplex_[at(i, k)] * blocks + b);
        result.col(i * blocks + b) = alpha * slice_scale[i] * sum;
      }
  }

  /** \brief The response of each point to a one at itself. A value moves from vertex k
   * of the simplex to vertex k + m (modulo d + 1) by one step ahead in m directions or
   * one step back in the d + 1 - m others. */
  Eigen::ArrayXf
  selfResponse() const
  {
    const float alpha = gain();
    Eigen::ArrayXf response = Eigen::ArrayXf::Zero(points_);
    std::vector<bool> ahead(std::size_t(d_) + 1);
    for (Eigen::Index i = 0; i < points_; ++i)
      for (int k = 0; k <= d_; ++k) {
        ahead.assign(ahead.size(), false);
        for (int m = 0; m <= d_ + 1; ++m) {
          if (m > 0)
            ahead[order_[at(i, (k + m - 1) % (d_ + 1))]] = true;
          const float weight = weights_[at(i, k)] * weights_[at(i, (k + m) % (d_ + 1))];
          response[i] += alpha * weight * walk(simplex_[at(i, k)], ahead, +1);
          if (m > 0 && m <= d_)
            response[i] += alpha * weight * walk(simplex_[at(i, k)], ahead, -1);
          if (m == d_ + 1)
            response[i] += alpha * weight * walk(simplex_[at(i, k)], ahead, 0);
        }
      }
    return response;
  }

private:
  using Key = std::int16_t;

  // Keys of the vertices: open addressing with stored hashes, which avoid most key
  // comparisons.
  class KeyTable {
  public:
    KeyTable(int d, Eigen::Index expected) : d_(d)
    {
      std::size_t size = 1 << 10;
      while (size < 2 * std::size_t(expected))
        size *= 2;
      table_.assign(size, {0, -1});
    }

    Eigen::Index
    size() const
    {
      return Eigen::Index(keys_.size()) / d_;
    }

    const Key*
    key(Eigen::Index vertex) const
    {
      return keys_.data() + vertex * d_;
    }

    // Index of a vertex; -1 if it is missing and \a create is false.
    std::int32_t
    find(const Key* key, bool create)
    {
      if (create && std::size_t(size()) * 2 >= table_.size())
        grow();
      const std::uint32_t hash = hashOf(key);
      Slot& slot = table_[search(hash, [&](std::int32_t v) {
        for (int i = 0; i < d_; ++i)
          if (key[i] != keys_[std::size_t(v) * std::size_t(d_) + std::size_t(i)])
            return false;
        return true;
      })];
      if (slot.vertex >= 0 || !create)
        return slot.vertex;
      slot = {hash, std::int32_t(size())};
      keys_.insert(keys_.end(), key, key + d_);
      return slot.vertex;
    }

  private:
    struct Slot {
      std::uint32_t hash;
      std::int32_t vertex;
    };

    std::uint32_t
    hashOf(const Key* key) const
    {
      std::uint64_t value = 0;
      for (int i = 0; i < d_; ++i)
        value = (value + std::uint64_t(std::uint16_t(key[i]))) * 0x9E3779B97F4A7C15u;
      return std::uint32_t(value >> 32);
    }

    // The slot with this hash for which the predicate holds, or the free slot for it.
    template <typename IsIt>
    std::size_t
    search(std::uint32_t hash, IsIt&& is_it) const
    {
      std::size_t slot = hash & (table_.size() - 1);
      while (table_[slot].vertex >= 0 &&
             !(table_[slot].hash == hash && is_it(table_[slot].vertex)))
        slot = (slot + 1) & (table_.size() - 1);
      return slot;
    }

    void
    grow()
    {
      std::vector<Slot> old(2 * table_.size(), Slot{0, -1});
      table_.swap(old);
      for (const Slot& slot : old)
        if (slot.vertex >= 0)
          table_[search(slot.hash, [](std::int32_t) { return false; })] = slot;
    }

    int d_;
    std::vector<Slot> table_;
    std::vector<Key> keys_; // d per vertex; the last coordinate follows from the sum 0
  };

  std::size_t
  at(Eigen::Index i, int k) const
  {
    return std::size_t(i) * std::size_t(d_ + 1) + std::size_t(k);
  }

  // Finds the simplex around a point and its barycentric weights.
  void
  embed(const float* feature, Eigen::Index i)
  {
    constexpr int largest = 32;
    float elevated[largest + 1], weight[largest + 2] = {};
    int nearest[largest + 1], rank[largest + 1] = {};
    Key key[largest];
    if (d_ > largest)
      throw std::invalid_argument("features have more than 32 dimensions");

    // Projects to the plane where the d + 1 coordinates sum to 0, scaled to the
    // deviation of splat, blur and slice.
    float sum = 0.0f;
    for (int j = d_; j > 0; --j) {
      const float x = feature[j - 1] * scale_[std::size_t(j)];
      elevated[j] = sum - float(j) * x;
      sum += x;
    }
    elevated[0] = sum;

    // The nearest vertex whose coordinates are multiples of d + 1.
    int excess = 0;
    for (int j = 0; j <= d_; ++j) {
      if (!(std::abs(elevated[j]) < 32000.0f))
        throw std::overflow_error("features reach beyond the keys of the lattice");
      const int multiple =
          int(elevated[j] / float(d_ + 1) + (elevated[j] < 0.0f ? -0.5f : 0.5f));
      nearest[j] = multiple * (d_ + 1);
      excess += multiple;
    }
    for (int j = 0; j < d_; ++j)
      for (int l = j + 1; l <= d_; ++l)
        ++rank[elevated[j] - float(nearest[j]) < elevated[l] - float(nearest[l]) ? j
                                                                                 : l];
    for (int j = 0; j <= d_; ++j) { // returns to the plane
      rank[j] += excess;
      const int turn = rank[j] < 0 ? d_ + 1 : rank[j] > d_ ? -(d_ + 1) : 0;
      rank[j] += turn;
      nearest[j] += turn;
    }

    for (int j = 0; j <= d_; ++j) {
      const float share = (elevated[j] - float(nearest[j])) / float(d_ + 1);
      weight[d_ - rank[j]] += share;
      weight[d_ + 1 - rank[j]] -= share;
      // Vertex k + 1 is one step in direction order[k] ahead of vertex k.
      order_[at(i, d_ - rank[j])] = std::uint8_t(j);
    }
    weight[0] += 1.0f + weight[d_ + 1];
    for (int k = 0; k <= d_; ++k) {
      for (int j = 0; j < d_; ++j)
        key[j] = Key(nearest[j] + k - (rank[j] > d_ - k ? d_ + 1 : 0));
      simplex_[at(i, k)] = keys_.find(key, true);
      weights_[at(i, k)] = weight[k];
    }
  }

  void
  findNeighbours()
  {
    neighbours_.resize(std::size_t(d_ + 1));
    std::vector<Key> key(static_cast<std::size_t>(d_));
    for (int j = 0; j <= d_; ++j) {
      auto& neighbours = neighbours_[std::size_t(j)];
      neighbours.assign(std::size_t(vertices()), {-1, -1});
      for (std::int32_t v = 0; v < vertices(); ++v) {
        for (int l = 0; l < d_; ++l)
          key[std::size_t(l)] = Key(keys_.key(v)[l] + (l == j ? -d_ : 1));
        const std::int32_t ahead = keys_.find(key.data(), false);
        neighbours[std::size_t(v)].ahead = ahead;
        if (ahead >= 0)
          neighbours[std::size_t(ahead)].back = v;
      }
    }
  }

  void
  blur(int direction, Eigen::Index blocks)
  {
    const auto& neighbours = neighbours_[std::size_t(direction)];
    const auto orZero = [&](std::int32_t v) { return v < 0 ? vertices() : v; };
    for (Eigen::Index v = 0; v < vertices(); ++v) {
      const Eigen::Index ahead = orZero(neighbours[std::size_t(v)].ahead) * blocks;
      const Eigen::Index back = orZero(neighbours[std::size_t(v)].back) * blocks;
      for (Eigen::Index b = 0; b < blocks; ++b)
        back_.col(v * blocks + b) =
            front_.col(v * blocks + b) +
            0.5f * (front_.col(ahead + b) + front_.col(back + b));
    }
    front_.swap(back_);
  }

  // Weight of the path from a vertex that steps in some directions, in their order.
  float
  walk(std::int32_t vertex, const std::vector<bool>& ahead, int sign) const
  {
    float weight = 1.0f;
    for (int j = 0; j <= d_; ++j) {
      const bool steps = ahead[std::size_t(j)] == (sign > 0) || sign == 0;
      if (!steps)
        continue;
      const Neighbours& next = neighbours_[std::size_t(j)][std::size_t(vertex)];
      vertex = sign > 0 ? next.ahead : next.back;
      if (vertex < 0)
        return 0.0f;
      weight *= 0.5f;
    }
    return weight;
  }

  struct Neighbours {
    std::int32_t ahead;
    std::int32_t back;
  };

  int d_;
  Eigen::Index points_;
  std::vector<float> scale_; // of the coordinates 1 ... d
  KeyTable keys_;
  std::vector<std::int32_t> simplex_; // vertices around each point
  std::vector<float> weights_;        // barycentric
  std::vector<std::uint8_t> order_;   // direction from each vertex to the next
  std::vector<std::vector<Neighbours>> neighbours_;
  Blocks front_, back_;
};

/** \brief Soft-max of a point, in blocks of four. */
inline void
softMaxOfBlocks(const float* logs, Eigen::Index blocks, Eigen::Index labels,
                float* distribution)
{
  const auto block = [](auto* values, Eigen::Index b) { return values + 4 * b; };
  using Map = Eigen::Map<Eigen::Array4f>;
  using ConstMap = Eigen::Map<const Eigen::Array4f>;
  Eigen::Array4f largest = ConstMap(logs), sum = Eigen::Array4f::Zero();
  for (Eigen::Index b = 1; b < blocks; ++b)
    largest = largest.max(ConstMap(block(logs, b)));
  const float shift = largest.maxCoeff();
  for (Eigen::Index b = 0; b < blocks; ++b) {
    Map(block(distribution, b)) = (ConstMap(block(logs, b)) - shift).exp();
    if (b == blocks - 1) // avoids denormal numbers, which are slow
      Map(block(distribution, b)).tail(4 * blocks - labels) = 0.0f;
    sum += Map(block(distribution, b));
  }
  const float scale = 1.0f / sum.sum();
  for (Eigen::Index b = 0; b < blocks; ++b)
    Map(block(distribution, b)) *= scale;
}

/** \brief Potts mean field on plain lattices, kernels normalised as D^-1/2 K D^-1/2.
 *
 * For comparisons of run time, use self-interaction, because its subtraction is slow.
 * \param[in] unary L x N costs
 * \param[in] features a matrix d x N for each kernel, divided by the deviations
 * \param[in] kernel_weights of the kernels
 * \param[in] self_interaction messages include j = i, as in densecrf
 * \return marginals, L x N */
inline Eigen::MatrixXf
plainLatticeMeanField(const Eigen::MatrixXf& unary,
                      const std::vector<Eigen::MatrixXf>& features,
                      const std::vector<float>& kernel_weights, int iterations,
                      bool self_interaction)
{
  using Blocks = PlainLattice::Blocks;
  const Eigen::Index points = unary.cols(), labels = unary.rows();
  const Eigen::Index blocks = (labels + 3) / 4;
  // Padding rows have probability 0.
  Blocks costs = Blocks::Constant(4, blocks * points, 1e6f);
  Eigen::Map<Eigen::MatrixXf>(costs.data(), 4 * blocks, points).topRows(labels) = unary;

  struct Kernel {
    PlainLattice lattice;
    Eigen::ArrayXf scale, diagonal;
  };
  std::vector<Kernel> kernels;
  const Eigen::ArrayXf ones = Eigen::ArrayXf::Ones(points);
  for (std::size_t m = 0; m < features.size(); ++m) {
    kernels.push_back({PlainLattice(features[m]), {}, {}});
    Blocks sums(4, points);
    kernels[m].lattice.filter(Blocks::Ones(4, points), 1, ones, ones, sums);
    kernels[m].scale = (kernel_weights[m] / sums.row(0).transpose()).sqrt();
    kernels[m].diagonal = Eigen::ArrayXf::Zero(points);
    if (!self_interaction)
      kernels[m].diagonal =
          kernels[m].lattice.selfResponse() * kernels[m].scale.square();
  }

  Blocks marginals(4, blocks * points), message(4, blocks * points), logs = -costs;
  for (int iteration = 0; iteration <= iterations; ++iteration) {
    if (iteration > 0) {
      logs = -costs;
      for (Kernel& kernel : kernels) {
        kernel.lattice.filter(marginals, blocks, kernel.scale, kernel.scale, message);
        logs += message;
        if (!self_interaction)
          for (Eigen::Index c = 0; c < logs.cols(); ++c)
            logs.col(c) -= kernel.diagonal[c / blocks] * marginals.col(c);
      }
    }
    for (Eigen::Index i = 0; i < points; ++i)
      softMaxOfBlocks(&logs(0, i * blocks), blocks, labels, &marginals(0, i * blocks));
  }
  return Eigen::Map<Eigen::MatrixXf>(marginals.data(), 4 * blocks, points)
      .topRows(labels);
}

} // namespace pcl_semantic
