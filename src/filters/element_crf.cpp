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
#include <deque>
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

// The elements of a result, in the order of the marginals.
struct ResultElements {
  const pcl::Indices& indices; // of the measurements
  std::size_t own;             // only smaller indices are written
  const pcl::Indices* refined; // by index: where to write; null = the same
};

// Writes tempered marginals.
// An unlabelled element without messages has a uniform marginal. Such an element stays
// unlabelled, because its most probable class would be the first one.
// \param[out] refined may be the measurements
void
writeResult(const MeanField::Marginals& marginals, const ResultElements& elements,
            const ResultOptions& options, const LabelDistributions& distributions,
            LabelDistributions& refined)
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
    const pcl::index_t i = elements.indices[std::size_t(k)];
    if (std::size_t(i) >= elements.own)
      continue;
    const auto measured = distributions.matrix().col(i);
    const auto marginal = marginals.col(k);
    if (measured.isZero(0.0f) && !(marginal.minCoeff() < marginal.maxCoeff()))
      continue;
    auto column = refined.matrix().col(
        elements.refined ? (*elements.refined)[std::size_t(i)] : i);
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

void
runUpdates(const CRFTerms& terms, int updates, MeanField& inference)
{
  for (int i = 0; i < updates; ++i) {
    terms.checkInterruption();
    inference.update();
  }
}

void
refineWhole(const CRFTerms& terms, const Cliques* cliques, CRFElements& elements,
            const ResultOptions& options, CRFReport& report,
            LabelDistributions& distributions)
{
  MeanField inference(buildModel(terms, cliques, elements, distributions, report));
  runUpdates(terms, report.updates, inference);
  writeResult(inference.marginals(), {elements.indices, elements.total, nullptr},
              options, distributions, distributions);
}

// Columns that results have replaced, in reusable slots.
class SavedColumns {
public:
  explicit SavedColumns(int rows) : rows_(rows) {}

  // Returns the slot.
  std::int32_t
  add(const Eigen::Ref<const Eigen::VectorXf>& column)
  {
    if (free_.empty()) {
      free_.push_back(std::int32_t(values_.size() / std::size_t(rows_)));
      values_.resize(values_.size() + std::size_t(rows_));
    }
    const std::int32_t slot = free_.back();
    free_.pop_back();
    std::copy_n(column.data(), rows_, values_.begin() + begin(slot));
    return slot;
  }

  void
  remove(std::int32_t slot)
  {
    free_.push_back(slot);
  }

  void
  read(std::int32_t slot, Eigen::Ref<Eigen::VectorXf> column) const
  {
    std::copy_n(values_.begin() + begin(slot), rows_, column.data());
  }

private:
  std::ptrdiff_t
  begin(std::int32_t slot) const
  {
    return std::ptrdiff_t(slot) * rows_;
  }

  int rows_;
  std::deque<float> values_; // a vector would be copied when it grows
  std::vector<std::int32_t> free_;
};

// Refines tile by tile, so that the memory of a model grows little with the cloud.
// Results replace measurements. Those that later tiles need are saved until then.
class TileRefinement {
public:
  TileRefinement(const CRFTerms& terms, CRFElements& elements,
                 const ResultOptions& options, CRFReport& report,
                 LabelDistributions& distributions)
      : terms_(terms), elements_(elements), options_(options), report_(report),
        distributions_(distributions), kernels_(chooseKernels(terms, elements)),
        uses_(elements.indices.size()), saved_(distributions.classes())
  {
    limits_.reach = kernels_.reach *
                    haloOf(report.unlabelled, elements.indices.size(), report.updates);
    limits_.most = elements.tile_size;
    // Single precision has steps of 0.06 mm at a kilometre, and of 1/1000 of the
    // spacing at 16,384 times the spacing.
    if (elements.remainders.size() > 0)
      limits_.widest = std::max(1000.0, 16384.0 * elements.spacing);
  }

  void
  run()
  {
    std::vector<ElementTile> tiles;
    forEachTile(elements_.positions, limits_, [&](const ElementTile& tile) {
      terms_.checkInterruption();
      tiles.push_back(tile);
      for (const pcl::index_t k : columnsOf(tile))
        ++uses_[std::size_t(k)].tiles;
    });
    if (tiles.size() == 1)
      return refineWhole(terms_, nullptr, elements_, options_, report_, distributions_);
    for (const ElementTile& tile : tiles) {
      terms_.checkInterruption();
      refine(tile);
    }
  }

private:
  struct Use {
    std::uint16_t tiles = 0; // that are not refined yet
    std::int32_t slot = -1;  // of the saved measurement
  };

  static pcl::Indices
  columnsOf(const ElementTile& tile)
  {
    pcl::Indices columns = tile.own;
    columns.insert(columns.end(), tile.halo.begin(), tile.halo.end());
    return columns;
  }

  void
  refine(const ElementTile& tile)
  {
    const pcl::Indices columns = columnsOf(tile);
    const LabelDistributions measured(measurementsOf(columns));
    CRFElements part = partOf(columns);
    if (elements_.remainders.size() > 0)
      refinePositions(tile, columns, part);
    MeanField inference(buildModel(terms_, nullptr, part, measured, report_));
    runUpdates(terms_, report_.updates, inference);
    release(columns);
    pcl::Indices refined;
    for (const pcl::index_t k : tile.own) {
      refined.push_back(elements_.indices[std::size_t(k)]);
      Use& use = uses_[std::size_t(k)];
      if (use.tiles > 0)
        use.slot = saved_.add(distributions_.matrix().col(refined.back()));
    }
    writeResult(inference.marginals(), {part.indices, tile.own.size(), &refined},
                options_, measured, distributions_);
  }

  // Ends the use of columns by a tile.
  void
  release(const pcl::Indices& columns)
  {
    for (const pcl::index_t k : columns) {
      Use& use = uses_[std::size_t(k)];
      if (--use.tiles == 0 && use.slot >= 0)
        saved_.remove(use.slot);
    }
  }

  LabelDistributions::Matrix
  measurementsOf(const pcl::Indices& columns) const
  {
    LabelDistributions::Matrix measured(distributions_.classes(),
                                        Eigen::Index(columns.size()));
#pragma omp parallel for schedule(static)
    for (std::size_t k = 0; k < columns.size(); ++k) {
      const auto column = std::size_t(columns[k]);
      if (uses_[column].slot >= 0)
        saved_.read(uses_[column].slot, measured.col(Eigen::Index(k)));
      else
        measured.col(Eigen::Index(k)) =
            distributions_.matrix().col(elements_.indices[column]);
    }
    return measured;
  }

  CRFElements
  partOf(const pcl::Indices& columns) const
  {
    CRFElements part;
    part.total = columns.size();
    part.indices.resize(columns.size());
    std::iota(part.indices.begin(), part.indices.end(), 0);
    part.positions = gather(elements_.positions, columns);
    if (elements_.colours.size() > 0)
      part.colours = gather(elements_.colours, columns);
    part.spacing = elements_.spacing;
    part.extent = elements_.extent;
    part.choice = kernels_.choice;
    return part;
  }

  // Moves the origin of the positions into the tile, and adds their remainders.
  void
  refinePositions(const ElementTile& tile, const pcl::Indices& columns,
                  CRFElements& part) const
  {
    const Eigen::VectorXf origin = medianOf(elements_.positions, tile.own);
#pragma omp parallel for schedule(static)
    for (std::size_t k = 0; k < columns.size(); ++k) {
      auto position = part.positions.col(Eigen::Index(k));
      position = (position.cast<double>() - origin.cast<double>() +
                  elements_.remainders.col(columns[k]).cast<double>())
                     .cast<float>();
    }
    moveOrigin(terms_, elements_, origin, *part.choice);
  }

  const CRFTerms& terms_;
  CRFElements& elements_;
  const ResultOptions& options_;
  CRFReport& report_;
  LabelDistributions& distributions_;
  const KernelChoice kernels_;
  TileLimits limits_;
  std::vector<Use> uses_; // by element
  SavedColumns saved_;
};

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
  terms.checkInterruption();
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
      (elements.indices.size() > elements.tile_size || elements.remainders.size() > 0))
    TileRefinement(terms, elements, options, report, distributions).run();
  else
    refineWhole(terms, cliques, elements, options, report, distributions);
  return report;
}

} // namespace pcl_semantic
