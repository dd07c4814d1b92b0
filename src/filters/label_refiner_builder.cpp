// SPDX-License-Identifier: BSD-3-Clause
#include "label_refiner_builder.h"

#include "unary_costs.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/crf/lattice_kernel.h>

#include <algorithm>

namespace pcl_semantic {

namespace {

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

// What belongs to the cliques that take part, of one column a clique.
Eigen::MatrixXf
keptColumns(const Eigen::MatrixXf& matrix, std::size_t cliques,
            const std::vector<int>& kept, const char* what)
{
  if (matrix.size() > 0 && std::size_t(matrix.cols()) != cliques)
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "there are clique " << what << " of " << matrix.cols()
                                            << " cliques, expected " << cliques);
  return matrix.size() > 0 ? gather(matrix, kept) : matrix;
}

} // namespace

LabelRefiner::Builder::Builder(LabelRefiner& refiner, Elements& elements,
                               const LabelDistributions& measured)
    : refiner_(refiner), parameters_(refiner.parameters_), elements_(elements),
      measured_(measured), gaussian_kernels_(elements.positions, deviationsOf(terms()),
                                             kernelOptions(parameters_))
{
  if (!gaussian_kernels_.fastestOrder().empty())
    reorder(gaussian_kernels_.fastestOrder());
}

std::vector<GaussianTerm>
LabelRefiner::Builder::terms() const
{
  return makeTerms(parameters_.smoothness_weight, parameters_.smoothness_deviation,
                   parameters_.appearance_weight, parameters_.appearance_deviation,
                   elements_.colours, parameters_.colour_deviation);
}

void
LabelRefiner::Builder::reorder(const std::vector<std::int32_t>& order)
{
  pcl::Indices indices(order.size());
  for (std::size_t k = 0; k < order.size(); ++k)
    indices[k] = elements_.indices[std::size_t(order[k])];
  elements_.indices.swap(indices);
  elements_.positions = gather(elements_.positions, order);
  if (hasColours())
    elements_.colours = gather(elements_.colours, order);
}

CrfModel
LabelRefiner::Builder::build()
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

GaussianKernels::List
LabelRefiner::Builder::kernels() const
{
  GaussianKernels::List kernels = gaussian_kernels_.make(elements_.positions, terms());
  for (const GaussianTerm& kernel : refiner_.kernels_) {
    if (std::size_t(kernel.features.cols()) != elements_.total)
      PCL_THROW_EXCEPTION(InvalidParameterException, "a kernel has features of "
                                                         << kernel.features.cols()
                                                         << " points, expected "
                                                         << elements_.total);
    if (kernel.weight > 0.0f)
      kernels.push_back(
          std::make_shared<LatticeKernel>(gather(kernel.features, elements_.indices),
                                          kernel.weight, parameters_.normalization));
  }
  return kernels;
}

Eigen::MatrixXf
LabelRefiner::Builder::initial() const
{
  const LabelDistributions& initial = refiner_.initial_;
  if (initial.empty())
    return {};
  if (std::size_t(initial.size()) != elements_.total ||
      initial.classes() != measured_.classes())
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "initial distributions are " << initial.classes() << " x "
                                                     << initial.size() << ", expected "
                                                     << measured_.classes() << " x "
                                                     << elements_.total);
  return gather(initial.matrix(), elements_.indices);
}

// The cliques in the elements that take part, and which ones are left.
std::vector<std::vector<std::int32_t>>
LabelRefiner::Builder::cliquesOfElements(std::vector<int>& kept) const
{
  std::vector<std::int32_t> places(elements_.total, -1);
  for (std::size_t k = 0; k < elements_.indices.size(); ++k)
    places[std::size_t(elements_.indices[k])] = std::int32_t(k);
  std::vector<std::vector<std::int32_t>> cliques;
  std::vector<std::int32_t> last_clique(elements_.total, -1); // that an index was in
  for (std::size_t c = 0; c < refiner_.cliques_.size(); ++c) {
    std::vector<std::int32_t> members;
    for (const pcl::index_t index : refiner_.cliques_[c].indices) {
      if (index < 0 || std::size_t(index) >= elements_.total)
        PCL_THROW_EXCEPTION(InvalidParameterException,
                            "clique " << c << " has the index " << index
                                      << ", expected 0 to "
                                      << std::int64_t(elements_.total) - 1);
      if (last_clique[std::size_t(index)] == std::int32_t(c))
        PCL_THROW_EXCEPTION(InvalidParameterException,
                            "clique " << c << " has the index " << index << " twice");
      last_clique[std::size_t(index)] = std::int32_t(c);
      if (places[std::size_t(index)] >= 0)
        members.push_back(places[std::size_t(index)]);
    }
    if (members.empty())
      continue;
    cliques.push_back(std::move(members));
    kept.push_back(int(c));
  }
  return cliques;
}

void
LabelRefiner::Builder::addCliques(CrfModel& model)
{
  if (!refiner_.has_cliques_)
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "this model needs cliques: set them, or a generator");
  std::vector<int> kept;
  const auto cliques = cliquesOfElements(kept);
  refiner_.report_.cliques = cliques.size();
  refiner_.report_.skipped_cliques = refiner_.cliques_.size() - cliques.size();
  if (cliques.empty())
    return;
  const std::size_t all = refiner_.cliques_.size();
  CliquePotential potential;
  potential.cliques =
      std::make_shared<CliqueSet>(cliques, std::size_t(model.unary.cols()));
  potential.weights.setConstant(1, 1, float(parameters_.clique_weight));
  if (refiner_.clique_weights_.cols() == 1) // of all cliques
    potential.weights = refiner_.clique_weights_;
  else if (refiner_.clique_weights_.size() > 0)
    potential.weights = keptColumns(refiner_.clique_weights_, all, kept, "weights");
  potential.type = CliquePotential::Type::pn_potts;
  if (refiner_.model_ == CRFModelType::hierarchical) {
    potential.type = CliquePotential::Type::robust;
    potential.free_label = parameters_.free_label;
    potential.truncation = float(parameters_.clique_truncation);
    potential.hears_members = parameters_.cliques_hear_members;
    potential.members_hear_map = parameters_.members_hear_map;
    potential.unary = keptColumns(refiner_.clique_costs_, all, kept, "costs");
    potential.kernels = cliqueKernels(cliques);
  }
  model.cliques.push_back(std::move(potential));
}

GaussianKernels::List
LabelRefiner::Builder::cliqueKernels(
    const std::vector<std::vector<std::int32_t>>& cliques) const
{
  const std::vector<GaussianTerm> terms = makeTerms(
      parameters_.clique_smoothness_weight, parameters_.clique_smoothness_deviation,
      parameters_.clique_appearance_weight, parameters_.clique_appearance_deviation,
      meansOf(elements_.colours, cliques), parameters_.clique_colour_deviation);
  if (terms.empty())
    return {};
  const Eigen::MatrixXf positions = meansOf(elements_.positions, cliques);
  return GaussianKernels(positions, deviationsOf(terms), kernelOptions(parameters_))
      .make(positions, terms);
}

} // namespace pcl_semantic
