// SPDX-License-Identifier: BSD-3-Clause
#include "finite.h"
#include "kernels/truncated_sums.h"
#include "padded_columns.h"
#include "point_rows.h"
#include "scratch.h"
#include "sorted_points.h"
#include "truncated_chunk.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/parallel_guard.h>
#include <pcl_semantic/crf/truncated_kernel.h>

#include <algorithm>
#include <atomic>
#include <cmath>

namespace pcl_semantic {

namespace {

constexpr std::size_t most_pairs = std::size_t(1) << 31; // 4 GiB of weights

void
validate(const Eigen::Matrix3Xf& positions, const std::vector<GaussianTerm>& terms,
         float radius)
{
  if (!(radius > 0.0f) || !std::isfinite(radius))
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "kernel radius is " << radius << ", expected more than 0");
  if (!areFinite(positions))
    PCL_THROW_EXCEPTION(InvalidParameterException, "a position is not finite");
  for (const GaussianTerm& term : terms) {
    term.validate(positions.cols());
    if (term.position_deviation != terms[0].position_deviation)
      PCL_THROW_EXCEPTION(InvalidParameterException,
                          "terms of a truncated kernel have position deviations of "
                              << terms[0].position_deviation << " and "
                              << term.position_deviation << ", expected the same");
  }
}

} // namespace

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
  const float reach = radius * deviation * 1.0001f; // as that of the rows
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
  chunks_.resize((rows.size() + Chunk::most_points - 1) / Chunk::most_points);
  const kernels::TruncatedSums& loops = kernels::truncatedSums(simdTier());
  std::atomic<std::size_t> pairs{0};
  ParallelGuard guard;
#pragma omp parallel
  {
    Scratch scratch;
    std::vector<float> sums(terms.size() * kernels::most_points);
#pragma omp for schedule(dynamic, 1)
    for (std::size_t c = 0; c < chunks_.size(); ++c)
      guard.run([&] {
        Chunk& chunk = chunks_[c];
        if (pairs < most_pairs)
          chunk.find(rows, c * Chunk::most_points);
        if ((pairs += chunk.pairs) >= most_pairs)
          return; // it is refused below
        chunk.weights.reset(new std::uint32_t[chunk.pairs / 2]);
        float* const gathered = scratch.floats(
            kernels::scratchSize(chunk.longest, 1 + points.view().features_end));
        for (std::size_t g = 0; g < chunk.size(); ++g) {
          const kernels::GroupView group = chunk.view(g);
          loops.sumTerms(points.view(), group, gathered, sums.data(),
                         chunk.weightsOf(g));
          for (std::size_t p = 0; p < std::size_t(group.points); ++p)
            normalize(points, terms, group.point + p, sums.data() + p, normalization);
        }
      });
  }
  guard.rethrow();
  if (pairs >= most_pairs)
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "too many pairs of points lie within the radius, expected less "
                        "than "
                            << most_pairs << ": take a smaller radius or fewer points");
}

// Divides by D_i, the sums over all j of k_ij, i included, of each term.
void
TruncatedKernel::normalize(SortedPoints& points, const std::vector<GaussianTerm>& terms,
                           std::size_t point, const float* sums,
                           Normalization normalization)
{
  const bool symmetric = normalization == Normalization::symmetric;
  for (std::size_t m = 0; m < terms.size(); ++m) {
    const float divisor =
        normalization == Normalization::none ? 1.0f : sums[m * kernels::most_points];
    const float scale = terms[m].weight / divisor;
    points.left(m)[point] = symmetric ? std::sqrt(scale) : scale;
    points.right(m)[point] = symmetric ? std::sqrt(scale) : 1.0f;
    diagonal_[order_[point]] += scale;
  }
}

void
TruncatedKernel::makeWeights(const SortedPoints& points)
{
  const kernels::TruncatedSums& loops = kernels::truncatedSums(simdTier());
  const std::size_t arrays =
      1 + points.view().features_end + std::size_t(points.view().count);
  ParallelGuard guard;
#pragma omp parallel
  {
    Scratch scratch;
#pragma omp for schedule(dynamic, 1)
    for (std::size_t c = 0; c < chunks_.size(); ++c)
      guard.run([&] {
        Chunk& chunk = chunks_[c];
        float* const gathered =
            scratch.floats(kernels::scratchSize(chunk.longest, arrays));
        for (std::size_t g = 0; g < chunk.size(); ++g)
          loops.makeWeights(points.view(), chunk.view(g), gathered, chunk.weightsOf(g));
      });
  }
  guard.rethrow();
}

float
TruncatedKernel::widening(float radius, Normalization normalization)
{
  // Without normalisation a wider kernel would be a heavier one.
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

std::size_t
TruncatedKernel::memory() const
{
  std::size_t bytes = order_.size() * 4 + std::size_t(diagonal_.size()) * 4;
  for (const Chunk& chunk : chunks_)
    bytes += chunk.groups.runs.capacity() * 4 + chunk.size() * 16 + chunk.pairs * 2;
  return bytes;
}

void
TruncatedKernel::addProduct(const Eigen::Ref<const Eigen::MatrixXf>& values,
                            Eigen::Ref<Eigen::MatrixXf> result) const
{
  constexpr std::size_t block = 16; // of rows that the loops take at once
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
  const kernels::TruncatedSums& loops = kernels::truncatedSums(simdTier());
  ParallelGuard guard;
#pragma omp parallel
  {
    Scratch scratch;
    PaddedColumns sums(Eigen::Index(stride), kernels::most_points);
#pragma omp for schedule(dynamic, 1)
    for (std::size_t c = 0; c < chunks_.size(); ++c)
      guard.run([&] {
        const Chunk& chunk = chunks_[c];
        float* const weights = scratch.floats(
            kernels::scratchSize(chunk.longest, 1 + kernels::most_points));
        for (std::size_t g = 0; g < chunk.size(); ++g) {
          const kernels::GroupView group = chunk.view(g);
          if (in_place) {
            loops.addProduct(group, chunk.weightsOf(g), from, stride, weights,
                             result.col(Eigen::Index(group.point)).data());
            continue;
          }
          std::fill_n(sums.column(0), stride * kernels::most_points, 0.0f);
          loops.addProduct(group, chunk.weightsOf(g), from, stride, weights,
                           sums.column(0));
          for (int p = 0; p < group.points; ++p) {
            const std::size_t point = group.point + std::size_t(p);
            result.col(sorted ? Eigen::Index(point) : Eigen::Index(order_[point])) +=
                sums.view().col(p).head(values.rows());
          }
        }
      });
  }
  guard.rethrow();
}

} // namespace pcl_semantic
