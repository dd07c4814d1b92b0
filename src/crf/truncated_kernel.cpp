/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "kernels/run_search.h"
#include "kernels/truncated_sums.h"
#include "point_rows.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/parallel_guard.h>
#include <pcl_semantic/crf/truncated_kernel.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>

namespace pcl_semantic {

namespace {

constexpr std::size_t chunk_points = 256;
constexpr std::size_t padding = 16; // loops go by as many values at a time
constexpr float log2_e = 1.44269504f;
constexpr std::size_t most_pairs = std::size_t(1) << 32;

void
validate(const Eigen::Matrix3Xf& positions, const std::vector<GaussianTerm>& terms,
         float radius)
{
  if (!(radius > 0.0f) || !std::isfinite(radius))
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "kernel radius is " << radius << ", expected more than 0");
  if (!positions.allFinite())
    PCL_THROW_EXCEPTION(InvalidParameterException, "a position is not finite");
  for (const GaussianTerm& term : terms) {
    if (!(term.position_deviation > 0.0f) || !std::isfinite(term.position_deviation))
      PCL_THROW_EXCEPTION(InvalidParameterException, "position deviation is "
                                                         << term.position_deviation
                                                         << ", expected more than 0");
    if (!(term.weight >= 0.0f) || !std::isfinite(term.weight))
      PCL_THROW_EXCEPTION(InvalidParameterException,
                          "kernel weight is " << term.weight << ", expected 0 or more");
    if (term.features.size() > 0 && term.features.cols() != positions.cols())
      PCL_THROW_EXCEPTION(InvalidParameterException, "features have "
                                                         << term.features.cols()
                                                         << " columns, expected "
                                                         << positions.cols());
    if (!term.features.allFinite())
      PCL_THROW_EXCEPTION(InvalidParameterException, "a feature is not finite");
  }
}

std::vector<float>
padded(std::size_t count)
{
  return std::vector<float>(count + padding, 0.0f);
}

} // namespace

// The neighbours of up to 256 sorted points.
struct TruncatedKernel::Chunk {
  std::vector<PointRows::Run> runs;
  std::vector<std::uint32_t> run_ends;    // of each point
  std::vector<std::uint32_t> pair_counts; // of each point
  std::vector<std::size_t> weight_ends;   // of each point, multiples of 16
  // bfloat16; while building the values of each term
  std::vector<std::vector<std::uint16_t>> values;
  std::size_t most = 0; // pairs of a point

  kernels::RunsView
  view(std::size_t k, std::size_t chunk) const
  {
    const std::size_t begin = k == 0 ? 0 : run_ends[k - 1];
    return {runs.data() + begin, run_ends[k] - begin, pair_counts[k],
            chunk * chunk_points + k};
  }

  const std::uint16_t*
  weights(std::size_t k) const
  {
    return values[0].data() + (k == 0 ? 0 : weight_ends[k - 1]);
  }

  // Where the values of a point begin, by term.
  void
  findValues(std::size_t k, std::vector<std::uint16_t*>& begins)
  {
    for (std::size_t m = 0; m < values.size(); ++m)
      begins[m] = values[m].data() + (k == 0 ? 0 : weight_ends[k - 1]);
  }

  void
  find(const PointRows& rows, std::size_t chunk, std::size_t terms)
  {
    const std::size_t begin = chunk * chunk_points;
    rows.findRuns(begin, std::min(rows.size(), begin + chunk_points), runs, run_ends);
    runs.shrink_to_fit();
    std::size_t end = 0, first = 0;
    for (const std::uint32_t last : run_ends) {
      std::size_t pairs = 0;
      for (; first < last; ++first)
        pairs += runs[first] & kernels::run_length_mask;
      pair_counts.push_back(std::uint32_t(pairs));
      most = std::max(most, pairs);
      end += (pairs + padding - 1) / padding * padding;
      weight_ends.push_back(end);
    }
    values.assign(terms, std::vector<std::uint16_t>(end));
  }
};

// Positions and features of the sorted points as arrays, and the scales of the terms.
struct TruncatedKernel::SortedPoints {
  std::vector<float> position[3];
  std::vector<std::vector<float>> features; // of all terms
  std::vector<const float*> feature_arrays;
  std::vector<kernels::TermView> terms;
  std::vector<std::vector<float>> left, right; // of the terms
  std::vector<const float*> right_arrays;
  kernels::PointsView view;

  SortedPoints(const Eigen::Matrix3Xf& positions,
               const std::vector<std::int32_t>& order,
               const std::vector<GaussianTerm>& all_terms, float reach,
               float variance_factor)
  {
    const auto copyRow = [&](const auto& matrix, Eigen::Index row, float scale) {
      std::vector<float> array = padded(order.size());
      for (std::size_t i = 0; i < order.size(); ++i)
        array[i] = scale * matrix(row, order[i]);
      return array;
    };
    for (int a = 0; a < 3; ++a)
      view.position[a] = (position[a] = copyRow(positions, a, 1.0f)).data();
    for (const GaussianTerm& term : all_terms)
      for (Eigen::Index d = 0; d < term.features.rows(); ++d)
        features.push_back(copyRow(term.features, d, std::sqrt(log2_e / 2.0f)));
    for (const std::vector<float>& array : features)
      feature_arrays.push_back(array.data());
    const float* const* next = feature_arrays.data();
    for (const GaussianTerm& term : all_terms) {
      const float sigma = term.position_deviation;
      terms.push_back({log2_e / (2.0f * sigma * sigma * variance_factor), next,
                       int(term.features.rows())});
      next += term.features.rows();
      left.push_back(padded(order.size()));
      right.push_back(padded(order.size()));
      right_arrays.push_back(right.back().data());
    }
    view.squared_radius = reach * reach;
    view.terms = terms.data();
    view.count = int(terms.size());
  }

  std::size_t
  arrays() const
  {
    return 3 + features.size();
  }
};

TruncatedKernel::TruncatedKernel(const Eigen::Matrix3Xf& positions,
                                 const std::vector<GaussianTerm>& terms, float radius,
                                 Normalization normalization)
    : diagonal_(Eigen::VectorXf::Zero(positions.cols()))
{
  validate(positions, terms, radius);
  float widest = 0.0f;
  for (const GaussianTerm& term : terms)
    widest = std::max(widest, term.position_deviation);
  if (!terms.empty() && positions.cols() > 0)
    build(positions, terms, radius, widest, normalization);
}

TruncatedKernel::~TruncatedKernel() = default;

void
TruncatedKernel::build(const Eigen::Matrix3Xf& positions,
                       const std::vector<GaussianTerm>& terms, float radius,
                       float widest, Normalization normalization)
{
  const float reach = radius * widest;
  const PointRows rows(positions, reach, widest / 2.0f);
  order_ = rows.order();
  chunks_.resize((rows.size() + chunk_points - 1) / chunk_points);
  SortedPoints points(positions, order_, terms, reach * 1.0001f, widening(radius));
  const kernels::TruncatedSums& loops = kernels::truncatedSums(simdTier());
  std::atomic<std::size_t> pairs{0};
  ParallelGuard guard;
#pragma omp parallel for schedule(dynamic, 1)
  for (std::size_t c = 0; c < chunks_.size(); ++c)
    guard.run([&] {
      Chunk& chunk = chunks_[c];
      if (pairs < most_pairs) // else it is refused below
        chunk.find(rows, c, terms.size());
      pairs += chunk.weight_ends.empty() ? 0 : chunk.weight_ends.back();
      std::vector<float> scratch(kernels::scratchSize(chunk.most, points.arrays()));
      std::vector<float> sums(terms.size());
      std::vector<std::uint16_t*> values(terms.size());
      for (std::size_t k = 0; k < chunk.run_ends.size(); ++k) {
        const std::size_t i = c * chunk_points + k;
        chunk.findValues(k, values);
        loops.sumTerms(points.view, chunk.view(k, c), scratch.data(), sums.data(),
                       values.data());
        float diagonal = 0.0f;
        for (std::size_t m = 0; m < terms.size(); ++m) {
          const float weight = terms[m].weight;
          const bool symmetric = normalization == Normalization::symmetric;
          const float divisor = normalization == Normalization::none ? 1.0f : sums[m];
          points.left[m][i] =
              symmetric ? std::sqrt(weight / divisor) : weight / divisor;
          points.right[m][i] = symmetric ? points.left[m][i] : 1.0f;
          diagonal += weight / divisor;
        }
        diagonal_[order_[i]] = diagonal;
      }
    });
  guard.rethrow();
  if (pairs >= most_pairs)
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "more than "
                            << most_pairs << " pairs of points lie within " << reach
                            << " of each other: take a smaller radius or fewer points");
#pragma omp parallel for schedule(dynamic, 1)
  for (std::size_t c = 0; c < chunks_.size(); ++c)
    guard.run([&] {
      Chunk& chunk = chunks_[c];
      std::vector<float> scratch(kernels::scratchSize(chunk.most, points.arrays()));
      std::vector<float> left(terms.size());
      std::vector<std::uint16_t*> values(terms.size());
      for (std::size_t k = 0; k < chunk.run_ends.size(); ++k) {
        chunk.findValues(k, values);
        for (std::size_t m = 0; m < terms.size(); ++m)
          left[m] = points.left[m][c * chunk_points + k];
        loops.makeWeights(chunk.view(k, c), int(terms.size()), left.data(),
                          points.right_arrays.data(), scratch.data(), values.data());
      }
      chunk.values.resize(1);
    });
  guard.rethrow();
  if (std::is_sorted(order_.begin(), order_.end()))
    order_.clear();
}

float
TruncatedKernel::widening(float radius)
{
  return 1.0f + std::exp(-0.84f * (radius * radius - 4.0f));
}

std::vector<std::int32_t>
TruncatedKernel::fastestOrder(const Eigen::Matrix3Xf& positions, float reach,
                              float cell)
{
  return PointRows(positions, reach, cell).order();
}

std::size_t
TruncatedKernel::pairs() const
{
  std::size_t sum = 0;
  for (const Chunk& chunk : chunks_)
    for (const std::uint32_t count : chunk.pair_counts)
      sum += count;
  return sum;
}

std::size_t
TruncatedKernel::memory() const
{
  std::size_t bytes = order_.size() * 4 + std::size_t(diagonal_.size()) * 4;
  for (const Chunk& chunk : chunks_)
    bytes += chunk.runs.capacity() * 4 + chunk.run_ends.capacity() * 16 +
             chunk.values[0].capacity() * 2;
  return bytes;
}

void
TruncatedKernel::addProduct(const Eigen::Ref<const Eigen::MatrixXf>& values,
                            Eigen::Ref<Eigen::MatrixXf> result,
                            const VariableMask& active) const
{
  if (chunks_.empty())
    return;
  const auto rows = std::size_t(values.rows());
  const std::size_t stride = (rows + padding - 1) / padding * padding;
  const bool direct =
      order_.empty() && rows == stride && std::size_t(values.outerStride()) == stride;
  std::vector<float> copy;
  if (!direct) {
    copy.assign(stride * std::size_t(size()), 0.0f);
#pragma omp parallel for schedule(static)
    for (Eigen::Index i = 0; i < size(); ++i)
      std::copy_n(values.col(order_.empty() ? i : order_[i]).data(), rows,
                  copy.data() + std::size_t(i) * stride);
  }
  const float* const from = direct ? values.data() : copy.data();
  const kernels::TruncatedSums& loops = kernels::truncatedSums(simdTier());
  ParallelGuard guard;
#pragma omp parallel for schedule(dynamic, 1)
  for (std::size_t c = 0; c < chunks_.size(); ++c)
    guard.run([&] {
      const Chunk& chunk = chunks_[c];
      std::vector<float> scratch(kernels::scratchSize(chunk.most, 2));
      std::vector<float> sum(stride);
      for (std::size_t k = 0; k < chunk.run_ends.size(); ++k) {
        const std::size_t i = c * chunk_points + k;
        const std::size_t column = order_.empty() ? i : std::size_t(order_[i]);
        if (!active.empty() && !active[column])
          continue;
        std::fill(sum.begin(), sum.end(), 0.0f);
        loops.addProduct(chunk.view(k, c), chunk.weights(k), from, stride,
                         scratch.data(), sum.data());
        result.col(Eigen::Index(column)) +=
            Eigen::Map<const Eigen::VectorXf>(sum.data(), Eigen::Index(rows));
      }
    });
  guard.rethrow();
}

void
TruncatedKernel::markAffected(const VariableMask& changed, VariableMask& affected) const
{
  affected.assign(std::size_t(size()), 0);
  std::vector<std::uint32_t> before(std::size_t(size()) + 1, 0); // changed ones
  for (std::size_t i = 0; i + 1 < before.size(); ++i)
    before[i + 1] = before[i] + changed[order_.empty() ? i : std::size_t(order_[i])];
#pragma omp parallel for schedule(dynamic, 1)
  for (std::size_t c = 0; c < chunks_.size(); ++c)
    for (std::size_t k = 0; k < chunks_[c].run_ends.size(); ++k) {
      const kernels::RunsView runs = chunks_[c].view(k, c);
      bool hears = false;
      for (std::size_t r = 0; r < runs.count && !hears; ++r) {
        const std::size_t first = runs.runs[r] >> kernels::run_length_bits;
        const std::size_t length = runs.runs[r] & kernels::run_length_mask;
        hears = before[first] != before[first + length];
      }
      affected[order_.empty() ? runs.point : std::size_t(order_[runs.point])] = hears;
    }
}

} // namespace pcl_semantic
