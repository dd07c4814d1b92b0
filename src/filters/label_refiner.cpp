// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/filters/label_refiner.h>

#include "core/fail.h"
#include "crf/lattice_kernel.h"
#include "negative_logs.h"

#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/crf/crf_model.h>
#include <pcl_semantic/crf/mean_field.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace pcl_semantic {

namespace {

constexpr float smallest_probability = 1e-6f; // of a measurement, eq. (4)

// Costs -log p, eq. (4), of some columns of measurements, L x N of any positive scale;
// one that is all zero has no preference.
Eigen::MatrixXf
unaryCosts(const Eigen::MatrixXf& measured, const std::vector<std::int32_t>& columns)
{
  constexpr std::size_t block = 64; // logarithms are quicker many at a time
  Eigen::MatrixXf costs(measured.rows(), Eigen::Index(columns.size()));
#pragma omp parallel for schedule(static)
  for (std::size_t begin = 0; begin < columns.size(); begin += block) {
    const std::size_t end = std::min(columns.size(), begin + block);
    for (std::size_t k = begin; k < end; ++k) {
      const auto column = measured.col(columns[k]);
      double sum = 0.0; // in this order, wherever the column lies
      for (const float value : column)
        sum += double(value);
      if (sum > 0.0)
        costs.col(Eigen::Index(k)) = (column.cast<double>() / sum).cast<float>();
      else
        costs.col(Eigen::Index(k)).setOnes(); // no cost
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

// Columns of a matrix.
template <typename Index>
Eigen::MatrixXf
gather(const Eigen::MatrixXf& matrix, const std::vector<Index>& columns)
{
  Eigen::MatrixXf result(matrix.rows(), Eigen::Index(columns.size()));
#pragma omp parallel for schedule(static)
  for (Eigen::Index i = 0; i < result.cols(); ++i)
    result.col(i) = matrix.col(Eigen::Index(columns[std::size_t(i)]));
  return result;
}

void
requireLabels(const std::vector<Label>& labels, int classes)
{
  for (const Label label : labels)
    if (label == kUnlabelled || int(label) > classes)
      badParameter("thin labels: ", int(label), ", expected 1 to ", classes);
}

// The parameters with the deviations that suit the elements.
SemanticCRFParameters
resolved(SemanticCRFParameters parameters, double spacing)
{
  for (double* const deviation :
       {&parameters.smoothness_deviation, &parameters.appearance_deviation})
    if (*deviation == 0.0)
      *deviation = SemanticCRFParameters::automaticDeviation(spacing);
  return parameters;
}

// Eq. (6). Without colours the second kernel is one of positions: what the first lacks
// then is the weight, without which a single wrong label outvotes its neighbours.
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

// Means of the columns of the members; empty if there are no values.
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

// The costs of the cliques that take part.
Eigen::MatrixXf
keptCosts(const Eigen::MatrixXf& costs, std::size_t cliques,
          const std::vector<int>& kept)
{
  if (costs.size() > 0 && std::size_t(costs.cols()) != cliques)
    badParameter("there are clique costs of ", costs.cols(), " cliques, expected ",
                 cliques);
  return costs.size() > 0 ? gather(costs, kept) : costs;
}

} // namespace

/** \brief Makes the CrfModel of a LabelRefiner over elements. */
class LabelRefiner::Builder {
public:
  /** \brief Brings the elements into the order that suits the kernels.
   * \param[in] measured of all elements */
  Builder(LabelRefiner& refiner, Elements& elements, const LabelDistributions& measured)
      : refiner_(refiner), parameters_(resolved(refiner.parameters_, elements.spacing)),
        elements_(elements), measured_(measured),
        gaussian_kernels_(elements.positions, deviationsOf(terms()),
                          kernelOptions(parameters_))
  {
    if (!gaussian_kernels_.fastestOrder().empty())
      reorder(gaussian_kernels_.fastestOrder());
  }

  /** \throws as LabelRefiner::refine() */
  CrfModel
  build()
  {
    CrfModel model;
    model.kernels = kernels(); // first: they need the most memory while they are made
    model.unary = unaryCosts(measured_.matrix(), elements_.indices);
    model.compatibility = refiner_.compatibility_;
    model.self_interaction = parameters_.self_interaction;
    if (refiner_.usesCliques())
      addCliques(model);
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

  std::vector<GaussianTerm>
  terms() const
  {
    return makeTerms(parameters_.smoothness_weight, parameters_.smoothness_deviation,
                     parameters_.appearance_weight, parameters_.appearance_deviation,
                     elements_.colours, parameters_.colour_deviation);
  }

  GaussianKernels::List
  kernels() const
  {
    GaussianKernels::List kernels =
        gaussian_kernels_.make(elements_.positions, terms());
    for (const GaussianTerm& kernel : refiner_.kernels_) {
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
  addCliques(CrfModel& model)
  {
    if (!refiner_.has_cliques_)
      badParameter("this model needs cliques: set them, or a generator");
    std::vector<int> kept;
    const auto cliques = cliquesOfElements(kept);
    refiner_.report_.cliques = cliques.size();
    refiner_.report_.skipped_cliques = refiner_.cliques_.size() - cliques.size();
    if (cliques.empty())
      return;
    CliquePotential potential;
    potential.cliques =
        std::make_shared<CliqueSet>(cliques, std::size_t(model.unary.cols()));
    potential.weights.setConstant(1, 1, float(parameters_.clique_weight));
    potential.type = CliquePotential::Type::pn_potts;
    if (refiner_.model_ == CRFModelType::hierarchical) {
      potential.type = CliquePotential::Type::robust;
      potential.free_label = parameters_.free_label;
      potential.truncation = float(parameters_.clique_truncation);
      potential.update_from_members = parameters_.update_from_members;
      potential.unary =
          keptCosts(refiner_.clique_costs_, refiner_.cliques_.size(), kept);
      potential.kernels = cliqueKernels(cliques);
    }
    model.cliques.push_back(std::move(potential));
  }

  // The cliques in the elements that take part, and which ones are left.
  std::vector<std::vector<std::int32_t>>
  cliquesOfElements(std::vector<int>& kept) const
  {
    std::vector<std::int32_t> columns(elements_.total, -1);
    for (std::size_t k = 0; k < elements_.indices.size(); ++k)
      columns[std::size_t(elements_.indices[k])] = std::int32_t(k);
    std::vector<std::vector<std::int32_t>> cliques;
    std::vector<std::int32_t> last_clique(elements_.total, -1); // that an index was in
    for (std::size_t c = 0; c < refiner_.cliques_.size(); ++c) {
      std::vector<std::int32_t> members;
      for (const pcl::index_t index : refiner_.cliques_[c].indices) {
        if (index < 0 || std::size_t(index) >= elements_.total)
          badParameter("clique ", c, " has the index ", index, ", expected 0 to ",
                       std::int64_t(elements_.total) - 1);
        if (last_clique[std::size_t(index)] == std::int32_t(c))
          badParameter("clique ", c, " has the index ", index, " twice");
        last_clique[std::size_t(index)] = std::int32_t(c);
        if (columns[std::size_t(index)] >= 0)
          members.push_back(columns[std::size_t(index)]);
      }
      if (members.empty())
        continue;
      cliques.push_back(std::move(members));
      kept.push_back(int(c));
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

  LabelRefiner& refiner_;
  const SemanticCRFParameters parameters_;
  Elements& elements_;
  const LabelDistributions& measured_;
  GaussianKernels gaussian_kernels_;
};

namespace {

constexpr float greatest_weight = 1e9f; // as that of the parameters

bool
isDistribution(const Eigen::Ref<const Eigen::VectorXf>& column)
{
  return column.minCoeff() >= 0.0f &&
         (std::isfinite(column.sum()) || column.allFinite());
}

// Refuses what is no distribution; counts the unlabelled ones.
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

struct ResultOptions {
  double temperature;
  std::vector<Label> kept; // what was measured as one of these mostly stays so
};

// The marginals, tempered, for the measurements. An element that is unlabelled and
// receives no message has a uniform one, of which the first class would be the largest:
// it stays unlabelled.
void
writeResult(const MeanField::Marginals& marginals, const pcl::Indices& indices,
            const ResultOptions& options, LabelDistributions& distributions)
{
  // Unless messages outvote it by more than e^6; doc/crf.md.
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
    auto column = distributions.matrix().col(indices[std::size_t(k)]);
    const auto marginal = marginals.col(k);
    if (column.isZero(0.0f) && !(marginal.minCoeff() < marginal.maxCoeff()))
      continue;
    if (!isKept(column, marginal))
      column = marginal;
    else
      column /= column.sum();
    if (options.temperature == 1.0)
      continue;
    const auto winner = Eigen::Index(mapLabel(column.data(), classes)) - 1;
    negateLogs(column.data(), std::size_t(classes), 1e-30f);
    column *= float(-1.0 / options.temperature);
    distributionFromLog(column.data(), classes, column.data());
    if (winner >= 0 && mapLabel(column.data(), classes) != winner + 1) // rounding
      column[winner] = std::nextafter(column.maxCoeff(), 1.0f);
  }
}

} // namespace

void
LabelRefiner::setParameters(const SemanticCRFParameters& parameters)
{
  parameters.validate();
  parameters_ = parameters;
}

void
LabelRefiner::setCompatibility(const Eigen::MatrixXf& costs)
{
  compatibility_ = costs.size() > 0 ? LabelCompatibility(costs) : LabelCompatibility();
}

void
LabelRefiner::addKernel(const Eigen::MatrixXf& features, float weight)
{
  if (!(weight >= 0.0f && weight <= greatest_weight))
    badParameter("kernel weight is ", weight, ", expected 0 to ", greatest_weight);
  if (features.rows() < 1 || !features.allFinite())
    badParameter("the features of a kernel are ",
                 (features.rows() < 1 ? "missing" : "not all finite"));
  kernels_.push_back({weight, 1.0f, features});
}

void
LabelRefiner::setCliques(const std::vector<pcl::PointIndices>& cliques)
{
  for (std::size_t c = 0; c < cliques.size(); ++c)
    if (cliques[c].indices.empty())
      badParameter("clique ", c, " is empty");
  cliques_ = cliques;
  has_cliques_ = true;
}

void
LabelRefiner::setCliqueCosts(const Eigen::MatrixXf& costs)
{
  if (!costs.allFinite())
    badParameter("a clique cost is not finite");
  clique_costs_ = costs;
}

void
LabelRefiner::refine(Elements& elements, LabelDistributions& distributions)
{
  const ThreadScope threads(threads_);
  report_ = CRFReport();
  report_.spacing = elements.spacing;
  report_.unlabelled = checkMeasurements(distributions, elements.indices);
  if (elements.indices.empty())
    return;
  requireLabels(thin_labels_, distributions.classes());
  if (model_ == CRFModelType::unary)
    return normalize(elements.indices, distributions);
  Builder builder(*this, elements, distributions);
  MeanField inference(builder.build());
  inference.run(parameters_.iterations);
  report_.updates = parameters_.iterations;
  writeResult(inference.marginals(), elements.indices,
              {parameters_.temperature,
               parameters_.keep_thin ? thin_labels_ : std::vector<Label>()},
              distributions);
}

} // namespace pcl_semantic
