// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/core/label_distributions.h>

#include "fail.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <numeric>

namespace pcl_semantic {

namespace {

// Scales a column to sum to one; false for a negative or non-finite value.
bool
normalizeColumn(float* column, int classes)
{
  double sum = 0.0; // double: the sum of large floats would overflow
  for (int k = 0; k < classes; ++k) {
    if (!(column[k] >= 0.0f) || !std::isfinite(column[k]))
      return false;
    sum += column[k];
  }
  // A column that sums to one within single precision stays unchanged, so that reading
  // and writing a file preserves it.
  constexpr double rounding = 0x1p-20;
  if (sum > 0.0 && std::abs(sum - 1.0) > rounding)
    for (int k = 0; k < classes; ++k)
      column[k] = static_cast<float>(column[k] / sum);
  return true;
}

void
requireClasses(Eigen::Index classes)
{
  if (classes < 1 || classes > 255)
    badParameter("distributions have ", classes, " classes, expected 1 to 255");
}

// e^x for x <= 0 with relative error 2e-7; 0 below -87. Without call and branch, so
// that compilers vectorise the loop over the classes: 2^n e^r with |r| <= ln 2 / 2 and
// a Taylor polynomial.
float
exponential(float x)
{
  constexpr float magic = 12582912.0f; // 1.5 * 2^23: adding it rounds to an integer
  const float bounded = x > -87.0f ? x : -87.0f;
  const float shifted = bounded * 1.44269504f + magic;
  const float n = shifted - magic;
  float r = bounded - n * 0.693359375f; // ln 2 in two parts
  r += n * 2.12194440e-4f;
  float sum = 1.0f / 5040.0f;
  for (const float term :
       {1.0f / 720.0f, 1.0f / 120.0f, 1.0f / 24.0f, 1.0f / 6.0f, 0.5f, 1.0f, 1.0f})
    sum = sum * r + term;
  std::uint32_t bits;
  std::memcpy(&bits, &shifted, sizeof bits);
  bits = (bits + 127u) << 23;
  float power;
  std::memcpy(&power, &bits, sizeof power);
  return x > -87.0f ? sum * power : 0.0f;
}

} // namespace

LabelDistributions::LabelDistributions(int classes, Eigen::Index count)
{
  requireClasses(classes);
  matrix_ = Matrix::Zero(classes, count);
}

LabelDistributions::LabelDistributions(Matrix weights) : matrix_(std::move(weights))
{
  requireClasses(matrix_.rows());
  normalize();
}

void
LabelDistributions::setLabel(Eigen::Index j, Label label, float confidence)
{
  const int L = classes();
  if (label > L)
    badInput("label ", int(label), " is beyond the ", L, " classes");
  if (!(confidence >= 0.0f && confidence <= 1.0f))
    badParameter("confidence is ", confidence, ", expected 0 to 1");
  float* const p = column(j);
  if (label == kUnlabelled) {
    std::fill_n(p, L, 0.0f);
    return;
  }
  std::fill_n(p, L, L > 1 ? (1.0f - confidence) / float(L - 1) : 0.0f);
  p[label - 1] = L > 1 ? confidence : 1.0f;
}

void
LabelDistributions::normalize()
{
  // Exceptions must not leave a parallel loop, so only the first bad column is
  // recorded.
  Eigen::Index bad = size();
#pragma omp parallel for schedule(static) reduction(min : bad)
  for (Eigen::Index j = 0; j < size(); ++j)
    if (!normalizeColumn(column(j), classes()))
      bad = std::min(bad, j);
  if (bad < size())
    badInput("the label distribution of point ", bad,
             " has a negative or non-finite probability");
}

Label
LabelDistributions::mapLabel(Eigen::Index j) const
{
  return pcl_semantic::mapLabel(column(j), classes());
}

float
LabelDistributions::entropy(Eigen::Index j) const
{
  const float* const p = column(j);
  float sum = 0.0f;
  float entropy = 0.0f;
  for (int k = 0; k < classes(); ++k) {
    sum += p[k];
    if (p[k] > 0.0f)
      entropy -= p[k] * std::log(p[k]);
  }
  return sum > 0.0f ? entropy : std::log(float(classes()));
}

Label
mapLabel(const float* distribution, int classes)
{
  int best = 0;
  for (int k = 1; k < classes; ++k)
    if (distribution[k] > distribution[best])
      best = k;
  return distribution[best] > 0.0f ? static_cast<Label>(best + 1) : kUnlabelled;
}

void
fuseLogLikelihood(const float* log_likelihood, int classes, float max_log_ratio,
                  float* log_distribution)
{
  float largest = log_distribution[0] + log_likelihood[0];
  for (int k = 0; k < classes; ++k) {
    log_distribution[k] += log_likelihood[k];
    largest = std::max(largest, log_distribution[k]);
  }
  for (int k = 0; k < classes; ++k)
    log_distribution[k] = std::max(log_distribution[k] - largest, -max_log_ratio);
}

void
distributionFromLog(const float* log_values, int classes, float* distribution)
{
  const float largest = *std::max_element(log_values, log_values + classes);
  for (int k = 0; k < classes; ++k)
    distribution[k] = exponential(log_values[k] - largest);
  const float sum = std::accumulate(distribution, distribution + classes, 0.0f);
  for (int k = 0; k < classes; ++k)
    distribution[k] /= sum;
}

} // namespace pcl_semantic
