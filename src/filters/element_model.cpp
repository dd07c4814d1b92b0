// SPDX-License-Identifier: BSD-3-Clause
#include "element_model.h"

#include "core/fail.h"
#include "core/parallel_guard.h"
#include "crf/lattice_kernel.h"
#include "negative_logs.h"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <utility>

namespace pcl_semantic {

namespace {

// Costs -log p, eq. (4), of some columns of measurements, L x N at any positive scale.
// An all-zero column has equal costs.
Eigen::MatrixXf
unaryCosts(const Eigen::MatrixXf& measured, const std::vector<std::int32_t>& columns)
{
  constexpr std::size_t block = 64; // for vectorised logarithms
  Eigen::MatrixXf costs(measured.rows(), Eigen::Index(columns.size()));
#pragma omp parallel for schedule(static)
  for (std::size_t begin = 0; begin < columns.size(); begin += block) {
    const std::size_t end = std::min(columns.size(), begin + block);
    for (std::size_t k = begin; k < end; ++k) {
      const auto column = measured.col(columns[k]);
      double sum = 0.0; // fixed order, independent of alignment
      for (const float value : column)
        sum += double(value);
      if (sum > 0.0)
        costs.col(Eigen::Index(k)) = (column.cast<double>() / sum).cast<float>();
      else
        costs.col(Eigen::Index(k)).setOnes(); // equal costs: -log 1 = 0
    }
    negateLogs(costs.data() + Eigen::Index(begin) * costs.rows(),
               (end - begin) * std::size_t(costs.rows()), smallest_probability);
  }
  return costs;
}

GaussianKernelOptions
kernelOptions(const SemanticCRFParameters& parameters)
{
  return {parameters.kernel_method, float(parameters.radius), parameters.normalization};
}

// Eq. (6). Without colours the second kernel becomes a kernel over positions, to keep
// its weight: otherwise a single wrong label outvotes its neighbours.
std::vector<GaussianTerm>
makeTerms(double smoothness_weight, double smoothness_deviation,
          double appearance_weight, double appearance_deviation,
          const Eigen::MatrixXf& colours, double colour_deviation)
{
  std::vector<GaussianTerm> terms;
  if (smoothness_weight > 0.0)
    terms.push_back(
        {float(smoothness_weight), float(smoothness_deviation), Eigen::MatrixXf()});
  if (appearance_weight > 0.0 && colours.size() > 0)
    terms.push_back({float(appearance_weight), float(appearance_deviation),
                     colours / float(colour_deviation)});
  else if (appearance_weight > 0.0 && !terms.empty() &&
           appearance_deviation == smoothness_deviation)
    terms[0].weight += float(appearance_weight); // the same kernel
  else if (appearance_weight > 0.0)
    terms.push_back(
        {float(appearance_weight), float(appearance_deviation), Eigen::MatrixXf()});
  return terms;
}

std::vector<float>
deviationsOf(const std::vector<GaussianTerm>& terms)
{
  std::vector<float> deviations;
  for (const GaussianTerm& term : terms)
    deviations.push_back(term.position_deviation);
  return deviations;
}

// The outer tenth of a lattice's weights changes labels in a tile less than one in
// 100,000 (doc/crf.md#large-clouds).
constexpr double lattice_radius = 2.0; // [position deviations]

// Mean columns of the members; empty if there are no values.
Eigen::MatrixXf
meansOf(const Eigen::MatrixXf& values,
        const std::vector<std::vector<std::int32_t>>& cliques)
{
  if (values.size() == 0)
    return {};
  Eigen::MatrixXf means(values.rows(), Eigen::Index(cliques.size()));
  for (std::size_t c = 0; c < cliques.size(); ++c) {
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(values.rows());
    for (const std::int32_t i : cliques[c])
      sum += values.col(i).cast<double>();
    means.col(Eigen::Index(c)) = (sum / double(cliques[c].size())).cast<float>();
  }
  return means;
}

std::vector<GaussianTerm>
gaussianTerms(const SemanticCRFParameters& parameters, const Eigen::MatrixXf& colours)
{
  return makeTerms(parameters.smoothness_weight, parameters.smoothness_deviation,
                   parameters.appearance_weight, parameters.appearance_deviation,
                   colours, parameters.colour_deviation);
}

GaussianKernels
makeKernels(const CRFElements& elements, const SemanticCRFParameters& parameters)
{
  const std::vector<float> deviations =
      deviationsOf(gaussianTerms(parameters, elements.colours));
  const GaussianKernelOptions options = kernelOptions(parameters);
  return elements.choice ? GaussianKernels(elements.positions, deviations, options,
                                           *elements.choice)
                         : GaussianKernels(elements.positions, deviations, options);
}

class ModelBuilder {
public:
  /** \brief Sorts the elements into an order that suits the kernels.
   * \param[in] measured of all elements */
  ModelBuilder(const CRFTerms& terms, const Cliques* cliques, CRFElements& elements,
               const LabelDistributions& measured)
      : terms_(terms), cliques_(cliques),
        parameters_(resolvedFor(elements, terms.parameters)), elements_(elements),
        measured_(measured), gaussian_kernels_(makeKernels(elements, parameters_))
  {
    if (!gaussian_kernels_.fastestOrder().empty())
      reorder(gaussian_kernels_.fastestOrder());
  }

  /** \param[in,out] report receives the numbers of cliques */
  CrfModel
  build(CRFReport& report)
  {
    CrfModel model;
    model.kernels = kernels(); // first: construction needs most memory
    model.unary = unaryCosts(measured_.matrix(), elements_.indices);
    model.compatibility = terms_.compatibility;
    model.self_interaction = parameters_.self_interaction;
    if (terms_.usesCliques())
      addCliques(model, report);
    return model;
  }

private:
  void
  reorder(const std::vector<std::int32_t>& order)
  {
    pcl::Indices indices(order.size());
    for (std::size_t k = 0; k < order.size(); ++k)
      indices[k] = elements_.indices[std::size_t(order[k])];
    elements_.indices.swap(indices);
    elements_.positions = gather(elements_.positions, order);
    if (elements_.colours.size() > 0)
      elements_.colours = gather(elements_.colours, order);
  }

  GaussianKernels::List
  kernels() const
  {
    GaussianKernels::List kernels = gaussian_kernels_.make(
        elements_.positions, gaussianTerms(parameters_, elements_.colours),
        terms_.check_interruption);
    for (const GaussianTerm& kernel : terms_.kernels) {
      if (std::size_t(kernel.features.cols()) != elements_.total)
        badParameter("a kernel has features of ", kernel.features.cols(),
                     " points, expected ", elements_.total);
      if (kernel.weight > 0.0f)
        kernels.push_back(
            std::make_shared<LatticeKernel>(gather(kernel.features, elements_.indices),
                                            kernel.weight, parameters_.normalization));
    }
    return kernels;
  }

  void
  addCliques(CrfModel& model, CRFReport& report)
  {
    if (!cliques_)
      badParameter("this model needs cliques: set them, or a generator");
    const auto cliques = cliquesOfElements();
    report.cliques = cliques.size();
    report.skipped_cliques = cliques_->size() - cliques.size();
    if (cliques.empty())
      return;
    CliquePotential potential;
    potential.cliques =
        std::make_shared<CliqueSet>(cliques, std::size_t(model.unary.cols()));
    potential.weights.setConstant(1, 1, float(parameters_.clique_weight));
    potential.type = CliquePotential::Type::pn_potts;
    if (terms_.model == CRFModelType::hierarchical) {
      potential.type = CliquePotential::Type::robust;
      potential.free_label = parameters_.free_label;
      potential.truncation = float(parameters_.clique_truncation);
      potential.kernels = cliqueKernels(cliques);
    }
    model.cliques.push_back(std::move(potential));
    model.start_from_cliques = parameters_.clique_start;
  }

  // Cliques as columns of elements that take part.
  std::vector<std::vector<std::int32_t>>
  cliquesOfElements() const
  {
    std::vector<std::int32_t> columns(elements_.total, -1);
    for (std::size_t k = 0; k < elements_.indices.size(); ++k)
      columns[std::size_t(elements_.indices[k])] = std::int32_t(k);
    std::vector<std::vector<std::int32_t>> cliques;
    std::vector<std::int32_t> last_clique(elements_.total, -1); // by index
    for (std::size_t c = 0; c < cliques_->size(); ++c) {
      std::vector<std::int32_t> members;
      for (const pcl::index_t index : (*cliques_)[c].indices) {
        if (index < 0 || std::size_t(index) >= elements_.total)
          badParameter("clique ", c, " has the index ", index, ", expected 0 to ",
                       std::int64_t(elements_.total) - 1);
        if (last_clique[std::size_t(index)] == std::int32_t(c))
          badParameter("clique ", c, " has the index ", index, " twice");
        last_clique[std::size_t(index)] = std::int32_t(c);
        if (columns[std::size_t(index)] >= 0)
          members.push_back(columns[std::size_t(index)]);
      }
      if (!members.empty())
        cliques.push_back(std::move(members));
    }
    return cliques;
  }

  GaussianKernels::List
  cliqueKernels(const std::vector<std::vector<std::int32_t>>& cliques) const
  {
    const std::vector<GaussianTerm> terms = makeTerms(
        0.0, 1.0, parameters_.clique_appearance_weight,
        parameters_.clique_appearance_deviation, meansOf(elements_.colours, cliques),
        parameters_.clique_colour_deviation);
    if (terms.empty())
      return {};
    const Eigen::MatrixXf positions = meansOf(elements_.positions, cliques);
    return GaussianKernels(positions, deviationsOf(terms), kernelOptions(parameters_))
        .make(positions, terms);
  }

  const CRFTerms& terms_;
  const Cliques* cliques_; // null = none
  const SemanticCRFParameters parameters_;
  CRFElements& elements_;
  const LabelDistributions& measured_;
  GaussianKernels gaussian_kernels_;
};

} // namespace

Eigen::MatrixXf
gather(const Eigen::Ref<const Eigen::MatrixXf>& matrix, const pcl::Indices& columns)
{
  Eigen::MatrixXf result(matrix.rows(), Eigen::Index(columns.size()));
#pragma omp parallel for schedule(static)
  for (Eigen::Index i = 0; i < result.cols(); ++i)
    result.col(i) = matrix.col(Eigen::Index(columns[std::size_t(i)]));
  return result;
}

Eigen::VectorXf
medianOf(const Eigen::Ref<const Eigen::MatrixXf>& matrix, const pcl::Indices& columns)
{
  Eigen::VectorXf median(matrix.rows());
  ParallelGuard guard;
#pragma omp parallel for schedule(static, 1)
  for (Eigen::Index row = 0; row < matrix.rows(); ++row)
    guard.run([&] {
      std::vector<float> values;
      values.reserve(columns.size());
      for (const pcl::index_t i : columns)
        values.push_back(matrix(row, i));
      const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
      std::nth_element(values.begin(), middle, values.end());
      median[row] = *middle;
    });
  guard.rethrow();
  return median;
}

KernelChoice
chooseKernels(const CRFTerms& terms, const CRFElements& elements, double density)
{
  const SemanticCRFParameters parameters = resolvedFor(elements, terms.parameters);
  const std::vector<GaussianTerm> gaussians =
      gaussianTerms(parameters, elements.colours);
  KernelChoice kernels;
  kernels.choice = GaussianKernels::choose(elements.positions, gaussians,
                                           kernelOptions(parameters), density);
  if (elements.choice)
    kernels.choice.methods = elements.choice->methods;
  for (std::size_t m = 0; m < gaussians.size(); ++m) {
    const double radius = kernels.choice.methods[m] == KernelMethod::lattice
                              ? lattice_radius
                              : parameters.radius;
    kernels.reach =
        std::max(kernels.reach, radius * double(gaussians[m].position_deviation));
  }
  return kernels;
}

GaussianKernels::Choice
choiceFor(const SemanticCRFParameters& resolved,
          const std::vector<KernelMethod>& methods, const Eigen::MatrixXf& low,
          const Eigen::MatrixXf& colour_low)
{
  GaussianKernels::Choice choice = GaussianKernels::choose(
      low, gaussianTerms(resolved, colour_low), kernelOptions(resolved));
  choice.methods = methods;
  return choice;
}

void
moveOrigin(const CRFTerms& terms, const CRFElements& elements,
           const Eigen::VectorXf& origin, GaussianKernels::Choice& choice)
{
  const std::vector<float> deviations = deviationsOf(
      gaussianTerms(resolvedFor(elements, terms.parameters), elements.colours));
  for (std::size_t m = 0; m < deviations.size(); ++m)
    choice.lows[m].head(origin.size()) -= origin / deviations[m];
}

double
haloOf(std::size_t unlabelled, std::size_t elements, int updates)
{
  // Labels spread into unlabelled points by one reach an update. One more reach than
  // updates is exact for truncated kernels, but can make the halo larger than the tile.
  constexpr std::size_t few = 10000; // elements for each unlabelled one
  return updates > 3 || unlabelled > elements / few ? updates + 1.0 : 1.5;
}

CrfModel
buildModel(const CRFTerms& terms, const Cliques* cliques, CRFElements& elements,
           const LabelDistributions& measured, CRFReport& report)
{
  return ModelBuilder(terms, cliques, elements, measured).build(report);
}

} // namespace pcl_semantic
