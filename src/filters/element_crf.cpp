// SPDX-License-Identifier: BSD-3-Clause
#include "element_crf.h"

#include "core/fail.h"
#include "element_model.h"
#include "element_tiles.h"
#include "negative_logs.h"

#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/crf/mean_field.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

#include <omp.h>

namespace pcl_semantic {

namespace {

void
requireLabels(const std::vector<Label>& labels, int classes)
{
  for (const Label label : labels)
    if (label == kUnlabelled || int(label) > classes)
      badParameter("thin labels: ", int(label), ", expected 1 to ", classes);
}

bool
isDistribution(const Eigen::Ref<const Eigen::VectorXf>& column)
{
  return column.minCoeff() >= 0.0f &&
         (std::isfinite(column.sum()) || column.allFinite());
}

// Returns the number of unlabelled elements.
std::size_t
checkMeasurements(const LabelDistributions& measured, const pcl::Indices& indices)
{
  const auto count = static_cast<Eigen::Index>(indices.size());
  Eigen::Index bad = count, unlabelled = 0;
#pragma omp parallel for schedule(static) reduction(min : bad) reduction(+ : unlabelled)
  for (Eigen::Index k = 0; k < count; ++k) {
    const auto column = measured.matrix().col(indices[std::size_t(k)]);
    if (!isDistribution(column))
      bad = std::min(bad, k);
    unlabelled += column.isZero(0.0f);
  }
  if (bad < count)
    badInput("the label distribution of point ", indices[std::size_t(bad)],
             " has a negative or "
             "non-finite probability");
  return std::size_t(unlabelled);
}

void
normalize(const pcl::Indices& indices, LabelDistributions& distributions)
{
#pragma omp parallel for schedule(static)
  for (std::size_t k = 0; k < indices.size(); ++k) {
    auto column = distributions.matrix().col(indices[k]);
    const double sum = column.cast<double>().sum();
    if (sum > 0.0)
      column = (column.cast<double>() / sum).cast<float>();
  }
}

// Uniform measurements are left alone: the adjustment would label them.
bool
isUniform(const Eigen::Ref<const Eigen::VectorXf>& column)
{
  return column.maxCoeff() - column.minCoeff() <= 1e-4f * column.sum();
}

// SemanticCRFParameters::logit_adjustment.
void
adjustLogits(const pcl::Indices& indices, const Eigen::VectorXd& frequencies,
             double power, LabelDistributions& distributions)
{
  if (frequencies.size() != distributions.classes())
    badParameter("there are frequencies of ", frequencies.size(), " classes, expected ",
                 distributions.classes());
  constexpr double rare = 0.1; // rarer classes are treated alike
  Eigen::VectorXf factors(frequencies.size());
  for (Eigen::Index l = 0; l < factors.size(); ++l)
    factors[l] = float(std::pow(std::max(frequencies[l], rare), -power));
#pragma omp parallel for schedule(static)
  for (std::size_t k = 0; k < indices.size(); ++k) {
    auto column = distributions.matrix().col(indices[k]);
    if (!isUniform(column))
      column.array() *= factors.array() / column.sum();
  }
}

struct ResultOptions {
  double temperature;
  std::vector<Label> kept; // SemanticCRFParameters::keep_thin applies to these classes
};

// Writes tempered marginals in place of measurements.
// An unlabelled element without messages has a uniform marginal. Such an element stays
// unlabelled, because its most probable class would be the first one.
// \param[in] is_wanted whether to write an element, by index; empty = all
// \param[out] refined may be the measurements
void
writeResult(const MeanField::Marginals& marginals, const pcl::Indices& indices,
            const std::vector<std::uint8_t>& is_wanted, const ResultOptions& options,
            const LabelDistributions& distributions, LabelDistributions& refined)
{
  // A kept class loses only if the messages favour another class by more than a factor
  // of e^6, see doc/crf.md#thin-things. The marginals contain the unary odds, which
  // unary_odds removes.
  const auto isKept = [&](const auto& measured, const auto& marginal) {
    constexpr float e6 = 403.4288f;
    Eigen::Index before = 0, after = 0;
    const float largest = measured.maxCoeff(&before);
    if (!(largest > 0.0f) ||
        std::count(options.kept.begin(), options.kept.end(), Label(before + 1)) == 0)
      return false;
    const float winner = marginal.maxCoeff(&after);
    const float unary_odds =
        largest / std::max(measured[after], smallest_probability * measured.sum());
    return winner * unary_odds <= e6 * marginal[before];
  };
  const int classes = int(marginals.rows());
#pragma omp parallel for schedule(static)
  for (Eigen::Index k = 0; k < marginals.cols(); ++k) {
    const pcl::index_t i = indices[std::size_t(k)];
    if (!is_wanted.empty() && !is_wanted[std::size_t(i)])
      continue;
    const auto measured = distributions.matrix().col(i);
    const auto marginal = marginals.col(k);
    if (measured.isZero(0.0f) && !(marginal.minCoeff() < marginal.maxCoeff()))
      continue;
    auto column = refined.matrix().col(i);
    if (!isKept(measured, marginal))
      column = marginal;
    else
      column = measured / measured.sum();
    if (options.temperature == 1.0)
      continue;
    const auto winner = Eigen::Index(mapLabel(column.data(), classes)) - 1;
    negateLogs(column.data(), std::size_t(classes), 1e-30f);
    column *= float(-1.0 / options.temperature);
    distributionFromLog(column.data(), classes, column.data());
    if (winner >= 0 && mapLabel(column.data(), classes) != winner + 1) // by rounding
      column[winner] = std::nextafter(column.maxCoeff(), 1.0f);
  }
}

CRFElements
partOf(const CRFElements& elements, const ElementTile& tile,
       const GaussianKernels::Choice& choice)
{
  pcl::Indices columns = tile.own;
  columns.insert(columns.end(), tile.halo.begin(), tile.halo.end());
  CRFElements part;
  part.total = elements.total;
  part.indices.reserve(columns.size());
  for (const pcl::index_t k : columns)
    part.indices.push_back(elements.indices[std::size_t(k)]);
  part.positions = gather(elements.positions, columns);
  if (elements.colours.size() > 0)
    part.colours = gather(elements.colours, columns);
  part.spacing = elements.spacing;
  part.extent = elements.extent;
  part.choice = choice;
  return part;
}

void
refineWhole(const CRFTerms& terms, const Cliques* cliques, CRFElements& elements,
            const ResultOptions& options, CRFReport& report,
            LabelDistributions& distributions)
{
  MeanField inference(buildModel(terms, cliques, elements, distributions, report));
  inference.run(report.updates);
  writeResult(inference.marginals(), elements.indices, {}, options, distributions,
              distributions);
}

// Refines tile by tile, so that the memory of a model grows little with the cloud.
void
refineTiles(const CRFTerms& terms, CRFElements& elements, const ResultOptions& options,
            CRFReport& report, LabelDistributions& distributions)
{
  const KernelChoice kernels = chooseKernels(terms, elements);
  LabelDistributions refined; // of the tiles; halos need the measurements
  std::vector<std::uint8_t> is_own(elements.total, 0);
  const auto mark = [&](const ElementTile& tile, std::uint8_t value) {
    for (const pcl::index_t k : tile.own)
      is_own[std::size_t(elements.indices[std::size_t(k)])] = value;
  };
  TileLimits limits;
  limits.reach = haloOf(report.unlabelled, elements.indices.size(), report.updates) *
                 kernels.reach;
  limits.most = elements.tile_size;
  bool is_whole = false;
  forEachTile(elements.positions, limits, [&](const ElementTile& tile) {
    is_whole = tile.own.size() == elements.indices.size();
    if (is_whole)
      return;
    if (refined.empty())
      refined = distributions;
    CRFElements part = partOf(elements, tile, kernels.choice);
    mark(tile, 1);
    MeanField inference(buildModel(terms, nullptr, part, distributions, report));
    inference.run(report.updates);
    writeResult(inference.marginals(), part.indices, is_own, options, distributions,
                refined);
    mark(tile, 0);
  });
  if (is_whole)
    refineWhole(terms, nullptr, elements, options, report, distributions);
  else
    distributions = std::move(refined);
}

} // namespace

Eigen::VectorXd
classFrequencies(const pcl::Indices& indices, const LabelDistributions& measured)
{
  using Sums = Eigen::Matrix<std::int64_t, Eigen::Dynamic, 1>;
  constexpr double unit = 1 << 30; // integers are summed exactly, in any order
  const Sums zero = Sums::Zero(measured.classes());
  std::vector<Sums> parts(std::size_t(omp_get_max_threads()), zero);
#pragma omp parallel for schedule(static)
  for (std::size_t k = 0; k < indices.size(); ++k) {
    const auto column = measured.matrix().col(indices[k]);
    if (!isUniform(column))
      parts[std::size_t(omp_get_thread_num())] +=
          (column.cast<double>() * (unit / column.cast<double>().sum()))
              .cast<std::int64_t>();
  }
  const Sums sums = std::accumulate(parts.begin(), parts.end(), zero);
  const double total = double(sums.sum());
  return total > 0.0 ? (sums.cast<double>() / total).eval()
                     : Eigen::VectorXd::Zero(measured.classes());
}

void
requireMembers(const Cliques& cliques)
{
  for (std::size_t c = 0; c < cliques.size(); ++c)
    if (cliques[c].indices.empty())
      badParameter("clique ", c, " is empty");
}

SemanticCRFParameters
resolvedFor(const CRFElements& elements, const SemanticCRFParameters& parameters)
{
  return parameters.resolved(elements.spacing, elements.colours.size() > 0,
                             elements.extent);
}

CRFReport
refineElements(const CRFTerms& terms, const Cliques* cliques, CRFElements& elements,
               LabelDistributions& distributions)
{
  const ThreadScope threads(terms.threads);
  CRFReport report;
  report.spacing = elements.spacing;
  report.extent = elements.extent;
  report.unlabelled = checkMeasurements(distributions, elements.indices);
  if (elements.indices.empty())
    return report;
  requireLabels(terms.thin_labels, distributions.classes());
  if (terms.model == CRFModelType::unary) {
    normalize(elements.indices, distributions);
    return report;
  }
  const SemanticCRFParameters parameters = resolvedFor(elements, terms.parameters);
  if (parameters.logit_adjustment > 0.0)
    adjustLogits(elements.indices,
                 terms.class_frequencies.size() > 0
                     ? terms.class_frequencies
                     : classFrequencies(elements.indices, distributions),
                 parameters.logit_adjustment, distributions);
  const ResultOptions options{parameters.temperature, parameters.keep_thin
                                                          ? terms.thin_labels
                                                          : std::vector<Label>()};
  report.updates = parameters.iterations;
  if (!terms.usesCliques() && terms.kernels.empty() &&
      elements.indices.size() > elements.tile_size)
    refineTiles(terms, elements, options, report, distributions);
  else
    refineWhole(terms, cliques, elements, options, report, distributions);
  return report;
}

} // namespace pcl_semantic
