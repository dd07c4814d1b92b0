// SPDX-License-Identifier: BSD-3-Clause
#include "truncated_kernel.h"
#include "aligned_array.h"
#include "core/fail.h"
#include "kernels/truncated_loops.h"
#include "parallel_loops.h"
#include "point_rows.h"
#include "requirements.h"

#include <pcl_semantic/crf/gaussian_kernels.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace pcl_semantic {

namespace {

constexpr std::size_t max_pairs = std::size_t(1) << 31; // 4 GiB of weights

void
validate(const Eigen::Matrix3Xf& positions, const std::vector<GaussianTerm>& terms,
         float radius)
{
  requirePositive(radius, "kernel radius");
  requireFinite(positions, "a position is not finite");
  for (const GaussianTerm& term : terms) {
    term.validate(positions.cols());
    if (term.position_deviation != terms[0].position_deviation)
      badParameter("terms of a truncated kernel have position deviations of ",
                   terms[0].position_deviation, " and ", term.position_deviation,
                   ", expected the same");
  }
}

constexpr std::size_t padding = 16; // the loops read this many values beyond the last
constexpr float log2_e = 1.44269504f;

/** \brief Memory of a thread, reused by its next task. */
class Scratch {
public:
  /** \brief At least \a count floats, uninitialised. */
  float*
  floats(std::size_t count)
  {
    if (count > floats_.size())
      floats_ = AlignedArray<float>(count);
    return floats_.data();
  }

private:
  AlignedArray<float> floats_;
};

} // namespace

/** \brief Positions and features of points in some order, and the scales of the terms,
 * in the arrays of the inner loops. */
class SortedPoints {
public:
  /** \param[in] order indices of the columns of \a positions
   * \param[in] squared_radius pairs farther apart are omitted
   * \param[in] variance of positions, in all terms */
  SortedPoints(const Eigen::Matrix3Xf& positions,
               const std::vector<std::int32_t>& order,
               const std::vector<GaussianTerm>& terms, float squared_radius,
               float variance)
      : stride_(order.size() + padding)
  {
    std::size_t arrays = 3;
    for (const GaussianTerm& term : terms) {
      terms_.push_back({int(term.features.rows()), arrays});
      arrays += std::size_t(term.features.rows());
    }
    arrays_.resize((arrays + terms.size()) * stride_);
    left_.resize(terms.size() * stride_);
    for (std::size_t m = 0; m < terms.size(); ++m)
      left_arrays_.push_back(left(m));
    view_ = {arrays_.data(),
             stride_,
             arrays,
             squared_radius,
             log2_e / (2.0f * variance),
             terms_.data(),
             int(terms_.size()),
             left_arrays_.data()};
    const auto copyRows = [&](const auto& matrix, std::size_t first, float scale) {
#pragma omp parallel for schedule(static)
      for (std::size_t i = 0; i < order.size(); ++i)
        for (Eigen::Index row = 0; row < matrix.rows(); ++row)
          arrays_[(first + std::size_t(row)) * stride_ + i] =
              scale * matrix(row, order[i]);
    };
    copyRows(positions, 0, 1.0f);
    for (std::size_t m = 0; m < terms.size(); ++m)
      copyRows(terms[m].features, terms_[m].first, std::sqrt(log2_e / 2.0f));
  }
  SortedPoints(const SortedPoints&) = delete; // views point into it
  SortedPoints& operator=(const SortedPoints&) = delete;

  const kernels::PointsView&
  view() const
  {
    return view_;
  }

  /** \brief Factors of a term's values, for the point and for its neighbour: weight /
   * D, or its square root on both sides. */
  float*
  left(std::size_t term)
  {
    return left_.data() + term * stride_;
  }

  float*
  right(std::size_t term)
  {
    return arrays_.data() + (view_.features_end + term) * stride_;
  }

private:
  std::size_t stride_;
  std::vector<float> arrays_; // see PointsView
  std::vector<float> left_;   // of the terms
  std::vector<const float*> left_arrays_;
  std::vector<kernels::TermView> terms_;
  kernels::PointsView view_;
};

/** \brief The neighbours of some sorted points, by groups of points. */
struct TruncatedKernel::Chunk {
  static constexpr std::size_t max_points = 256;

  PointRows::Groups groups;
  std::vector<std::uint32_t> lengths;       // points in the runs of each group
  std::vector<std::uint32_t> pair_ends;     // of each group, in pairs
  std::unique_ptr<std::uint32_t[]> weights; // two pairs each
  std::size_t pairs = 0;                    // of all groups
  std::size_t longest = 0;                  // points in the runs of a group
  std::size_t first = 0;                    // point

  void
  find(const PointRows& rows, const SortedPoints& points, std::size_t begin)
  {
    first = begin;
    groups = rows.findRuns(begin, std::min(rows.size(), begin + max_points));
    trim(points);
    std::size_t run = 0;
    for (std::size_t g = 0; g < groups.run_ends.size(); ++g) {
      std::size_t length = 0;
      for (; run < groups.run_ends[g]; ++run)
        length += groups.runs[run] & kernels::run_length_mask;
      lengths.push_back(std::uint32_t(length));
      longest = std::max(longest, length);
      pairs += std::size_t(view(g).points) * kernels::strideOf(length);
      pair_ends.push_back(std::uint32_t(pairs)); // chunks with more pairs are refused
    }
  }

  // Runs are of whole cells, which takes twice the pairs within the radius if points
  // lie anywhere in space.
  void
  trim(const SortedPoints& points)
  {
    const kernels::TruncatedLoops& loops = kernels::truncatedLoops();
    std::uint32_t end = 0, point = std::uint32_t(first);
    for (std::size_t g = 0, run = 0; g < groups.run_ends.size(); ++g) {
      const kernels::GroupView group = {groups.runs.data() + run,
                                        groups.run_ends[g] - run, 0, point,
                                        int(groups.point_ends[g] - point)};
      run = groups.run_ends[g];
      point = groups.point_ends[g];
      end +=
          std::uint32_t(loops.trimRuns(points.view(), group, groups.runs.data() + end));
      groups.run_ends[g] = end;
    }
    groups.runs.resize(end);
    groups.runs.shrink_to_fit();
  }

  std::size_t
  size() const
  {
    return lengths.size();
  }

  kernels::GroupView
  view(std::size_t g) const
  {
    const std::size_t run = g == 0 ? 0 : groups.run_ends[g - 1];
    const std::size_t point = g == 0 ? first : groups.point_ends[g - 1];
    return {groups.runs.data() + run, groups.run_ends[g] - run, lengths[g], point,
            int(groups.point_ends[g] - point)};
  }

  std::uint32_t*
  weightsOf(std::size_t g) const
  {
    return weights.get() + (g == 0 ? 0 : pair_ends[g - 1]) / 2;
  }
};

TruncatedKernel::TruncatedKernel(const Eigen::Matrix3Xf& positions,
                                 const std::vector<GaussianTerm>& terms, float radius,
                                 Normalization normalization)
    : diagonal_(Eigen::VectorXf::Zero(positions.cols()))
{
  validate(positions, terms, radius);
  if (terms.empty() || positions.cols() == 0)
    return;
  const float deviation = terms[0].position_deviation;
  const PointRows rows(positions, radius * deviation, deviation / 2.0f);
  order_ = rows.order();
  const float reach = radius * deviation * 1.0001f; // as in PointRows
  SortedPoints points(positions, order_, terms, reach * reach,
                      deviation * deviation * widening(radius, normalization));
  sumTerms(rows, points, terms, normalization);
  makeWeights(points);
  if (std::is_sorted(order_.begin(), order_.end()))
    order_.clear();
}

TruncatedKernel::~TruncatedKernel() = default;

void
TruncatedKernel::sumTerms(const PointRows& rows, SortedPoints& points,
                          const std::vector<GaussianTerm>& terms,
                          Normalization normalization)
{
  chunks_.resize((rows.size() + Chunk::max_points - 1) / Chunk::max_points);
  const kernels::TruncatedLoops& loops = kernels::truncatedLoops();
  std::atomic<std::size_t> pairs{0};
  forEachInParallel(
      chunks_.size(), [] { return Scratch(); },
      [&](std::size_t c, Scratch& scratch) {
        Chunk& chunk = chunks_[c];
        if (pairs < max_pairs)
          chunk.find(rows, points, c * Chunk::max_points);
        if ((pairs += chunk.pairs) >= max_pairs)
          return; // refused below
        chunk.weights.reset(new std::uint32_t[chunk.pairs / 2]);
        float* const gathered = scratch.floats(
            kernels::scratchSize(chunk.longest, 1 + points.view().features_end));
        std::vector<float> sums(terms.size() * kernels::max_points);
        for (std::size_t g = 0; g < chunk.size(); ++g) {
          const kernels::GroupView group = chunk.view(g);
          loops.sumTerms(points.view(), group, gathered, sums.data(),
                         chunk.weightsOf(g));
          for (std::size_t p = 0; p < std::size_t(group.points); ++p)
            normalize(points, terms, group.point + p, sums.data() + p, normalization);
        }
      });
  if (pairs >= max_pairs)
    badParameter("too many pairs of points lie within the radius, expected less "
                 "than ",
                 max_pairs, ": take a smaller radius or fewer points");
}

// Divides by D_i of each term.
void
TruncatedKernel::normalize(SortedPoints& points, const std::vector<GaussianTerm>& terms,
                           std::size_t point, const float* sums,
                           Normalization normalization)
{
  const bool symmetric = normalization == Normalization::symmetric;
  for (std::size_t m = 0; m < terms.size(); ++m) {
    const float divisor =
        normalization == Normalization::none ? 1.0f : sums[m * kernels::max_points];
    const float scale = terms[m].weight / divisor;
    points.left(m)[point] = symmetric ? std::sqrt(scale) : scale;
    points.right(m)[point] = symmetric ? std::sqrt(scale) : 1.0f;
    diagonal_[order_[point]] += scale;
  }
}

void
TruncatedKernel::makeWeights(const SortedPoints& points)
{
  const kernels::TruncatedLoops& loops = kernels::truncatedLoops();
  const std::size_t arrays =
      1 + points.view().features_end + std::size_t(points.view().count);
  forEachInParallel(
      chunks_.size(), [] { return Scratch(); },
      [&](std::size_t c, Scratch& scratch) {
        const Chunk& chunk = chunks_[c];
        float* const gathered =
            scratch.floats(kernels::scratchSize(chunk.longest, arrays));
        for (std::size_t g = 0; g < chunk.size(); ++g)
          loops.makeWeights(points.view(), chunk.view(g), gathered, chunk.weightsOf(g));
      });
}

float
TruncatedKernel::widening(float radius, Normalization normalization)
{
  // Without normalisation a wider kernel would also have a larger weight.
  return normalization == Normalization::none
             ? 1.0f
             : 1.0f + std::exp(-0.84f * (radius * radius - 4.0f));
}

// Cells of rows are half as wide as the deviation.
bool
TruncatedKernel::canHold(const Eigen::Matrix3Xf& positions, float deviation)
{
  return PointRows::canHold(positions, deviation / 2.0f);
}

std::vector<std::int32_t>
TruncatedKernel::fastestOrder(const Eigen::Matrix3Xf& positions, float radius,
                              float deviation)
{
  return PointRows::orderOf(positions, radius * deviation, deviation / 2.0f);
}

void
TruncatedKernel::addProduct(const Eigen::Ref<const Eigen::MatrixXf>& values,
                            Eigen::Ref<Eigen::MatrixXf> result) const
{
  constexpr std::size_t block = 16; // rows that the loops process at once
  const auto rows = std::size_t(values.rows());
  const std::size_t stride = (rows + block - 1) / block * block;
  const bool sorted = order_.empty();
  const bool direct =
      sorted && rows == stride && std::size_t(values.outerStride()) == stride;
  std::vector<float> copy;
  if (!direct) {
    copy.assign(stride * std::size_t(size()), 0.0f);
#pragma omp parallel for schedule(static)
    for (Eigen::Index i = 0; i < size(); ++i)
      std::copy_n(values.col(sorted ? i : order_[i]).data(), rows,
                  copy.data() + std::size_t(i) * stride);
  }
  const float* const from = direct ? values.data() : copy.data();
  const bool in_place = direct && std::size_t(result.outerStride()) == stride;
  const kernels::TruncatedLoops& loops = kernels::truncatedLoops();
  forEachInParallel(
      chunks_.size(), [] { return Scratch(); },
      [&](std::size_t c, Scratch& scratch) {
        const Chunk& chunk = chunks_[c];
        const std::size_t size =
            kernels::scratchSize(chunk.longest, 1 + kernels::max_points);
        const std::size_t sums_size = stride * kernels::max_points;
        float* const sums = scratch.floats(sums_size + size);
        float* const weights = sums + sums_size;
        for (std::size_t g = 0; g < chunk.size(); ++g) {
          const kernels::GroupView group = chunk.view(g);
          if (in_place) {
            loops.addProduct(group, chunk.weightsOf(g), from, stride, weights,
                             result.col(Eigen::Index(group.point)).data());
            continue;
          }
          std::fill_n(sums, sums_size, 0.0f);
          loops.addProduct(group, chunk.weightsOf(g), from, stride, weights, sums);
          for (std::size_t p = 0; p < std::size_t(group.points); ++p) {
            const std::size_t point = group.point + p;
            result.col(sorted ? Eigen::Index(point) : Eigen::Index(order_[point])) +=
                Eigen::Map<const Eigen::VectorXf>(sums + p * stride, values.rows());
          }
        }
      });
}

} // namespace pcl_semantic
