// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/crf/crf_model.h>

#include "core/fail.h"
#include "requirements.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace pcl_semantic {

LabelCompatibility::LabelCompatibility(Eigen::MatrixXf costs) : costs_(std::move(costs))
{
  if (costs_.rows() != costs_.cols() || costs_.rows() == 0)
    badParameter("the label compatibility is ", costs_.rows(), " x ", costs_.cols(),
                 ", expected L x L");
  for (Eigen::Index k = 0; k < labels(); ++k)
    for (Eigen::Index l = 0; l < labels(); ++l) {
      // Otherwise sums of messages could overflow floats.
      if (!(std::abs(costs_(l, k)) <= 1e9f))
        badParameter("the compatibility of labels ", l, " and ", k, " (from 0) is ",
                     costs_(l, k), ", expected -1e9 to 1e9");
      is_potts_ = is_potts_ && costs_(l, k) == float(l != k);
    }
}

namespace {

constexpr std::size_t largest = std::numeric_limits<std::int32_t>::max();

void
validate(const std::vector<std::int32_t>& members, std::size_t clique,
         std::vector<std::int32_t>& last_clique)
{
  if (members.empty())
    badParameter("clique ", clique, " is empty");
  for (const std::int32_t i : members) {
    if (i < 0 || std::size_t(i) >= last_clique.size())
      badParameter("clique ", clique, " has the member ", i,
                   ", expected 0 to less than ", last_clique.size());
    if (last_clique[std::size_t(i)] == std::int32_t(clique))
      badParameter("clique ", clique, " has the member ", i, " twice");
    last_clique[std::size_t(i)] = std::int32_t(clique);
  }
}

IndexLists
transpose(const IndexLists& lists, std::size_t rows)
{
  IndexLists result;
  result.starts.assign(rows + 1, 0);
  for (const std::int32_t i : lists.indices)
    ++result.starts[std::size_t(i) + 1];
  std::partial_sum(result.starts.begin(), result.starts.end(), result.starts.begin());
  result.indices.resize(lists.indices.size());
  std::vector<std::size_t> next(result.starts.begin(), result.starts.end() - 1);
  for (std::size_t row = 0; row < lists.size(); ++row)
    for (const std::int32_t i : lists[row])
      result.indices[next[std::size_t(i)]++] = std::int32_t(row);
  return result;
}

} // namespace

CliqueSet::CliqueSet(const std::vector<std::vector<std::int32_t>>& cliques,
                     std::size_t variables)
{
  if (variables > largest || cliques.size() > largest)
    badParameter(cliques.size(), " cliques over ", variables,
                 " variables, expected less than 2^31 of each");
  std::vector<std::int32_t> last_clique(variables, -1);
  members_.starts.reserve(cliques.size() + 1);
  for (std::size_t c = 0; c < cliques.size(); ++c) {
    validate(cliques[c], c, last_clique);
    members_.starts.push_back(members_.starts.back() + cliques[c].size());
  }
  members_.indices.reserve(members_.starts.back());
  for (const auto& clique : cliques)
    members_.indices.insert(members_.indices.end(), clique.begin(), clique.end());
  cliques_ = transpose(members_, variables);
}

namespace {

void
validateWeights(const Eigen::MatrixXf& weights, Eigen::Index labels,
                Eigen::Index cliques)
{
  if ((weights.rows() != 1 && weights.rows() != labels) ||
      (weights.cols() != 1 && weights.cols() != cliques))
    badParameter("clique weights are ", weights.rows(), " x ", weights.cols(),
                 ", expected 1 or ", labels, " labels x 1 or ", cliques, " cliques");
  for (Eigen::Index c = 0; c < weights.cols(); ++c)
    for (Eigen::Index l = 0; l < weights.rows(); ++l)
      if (!(weights(l, c) >= 0.0f && weights(l, c) <= 1e9f))
        badParameter("the weight of clique ", c, " is ", weights(l, c),
                     ", expected 0 to 1e9");
}

} // namespace

void
CliquePotential::validate(Eigen::Index labels, Eigen::Index variables) const
{
  if (!cliques)
    badParameter("a clique potential has no cliques");
  const auto count = Eigen::Index(cliques->size());
  if (Eigen::Index(cliques->variables()) != variables)
    badParameter("cliques are over ", cliques->variables(), " variables, expected ",
                 variables);
  validateWeights(weights, labels, count);
  if (!(truncation > 0.0f && truncation <= 1.0f))
    badParameter("truncation is ", truncation, ", expected more than 0 and up to 1");
  if (type == Type::pn_potts && !kernels.empty())
    badParameter("P^n Potts cliques have no variables: kernels between them need the "
                 "robust potential");
  for (const auto& kernel : kernels)
    if (!kernel || kernel->size() != count)
      badParameter(
          "a kernel between cliques is ",
          (kernel ? "over " + std::to_string(kernel->size()) : std::string("missing")),
          ", expected one over ", count, " cliques");
}

namespace {

// N if there is none.
Eigen::Index
firstNotFinite(const Eigen::MatrixXf& unary)
{
  constexpr Eigen::Index block = 256;
  const Eigen::Index count = unary.cols(), labels = unary.rows();
  Eigen::Index first = count;
#pragma omp parallel for schedule(static) reduction(min : first) if (count > block)
  for (Eigen::Index begin = 0; begin < count; begin += block) {
    const Eigen::Index end = std::min(count, begin + block);
    if (areFinite(unary.data() + begin * labels, (end - begin) * labels))
      continue;
    for (Eigen::Index i = end - 1; i >= begin; --i)
      if (!areFinite(unary.data() + i * labels, labels))
        first = std::min(first, i);
  }
  return first;
}

} // namespace

void
CrfModel::validate() const
{
  const Eigen::Index labels = unary.rows(), variables = unary.cols();
  if (labels < 1 || labels > 255)
    badParameter("unary costs are of ", labels, " classes, expected 1 to 255");
  const Eigen::Index bad = firstNotFinite(unary);
  if (bad < variables)
    badParameter("a unary cost of variable ", bad, " is not finite");
  if (compatibility.labels() != 0 && compatibility.labels() != labels)
    badParameter("the label compatibility is of ", compatibility.labels(),
                 " classes, expected ", labels);
  for (const auto& kernel : kernels)
    if (!kernel || kernel->size() != variables)
      badParameter(
          "a kernel is ",
          (kernel ? "over " + std::to_string(kernel->size()) : std::string("missing")),
          ", expected one over ", variables, " variables");
  for (const CliquePotential& potential : cliques)
    potential.validate(labels, variables);
}

} // namespace pcl_semantic
