// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/crf/clique_potential.h>

#include <cmath>

namespace pcl_semantic {

namespace {

void
validateWeights(const Eigen::MatrixXf& weights, Eigen::Index labels,
                Eigen::Index cliques)
{
  if ((weights.rows() != 1 && weights.rows() != labels) ||
      (weights.cols() != 1 && weights.cols() != cliques))
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "clique weights are " << weights.rows() << " x "
                                              << weights.cols() << ", expected 1 or "
                                              << labels << " labels x 1 or " << cliques
                                              << " cliques");
  for (Eigen::Index c = 0; c < weights.cols(); ++c)
    for (Eigen::Index l = 0; l < weights.rows(); ++l)
      if (!(weights(l, c) >= 0.0f && weights(l, c) <= 1e9f))
        PCL_THROW_EXCEPTION(InvalidParameterException,
                            "the weight of clique " << c << " is " << weights(l, c)
                                                    << ", expected 0 to 1e9");
}

void
validateUnary(const Eigen::MatrixXf& unary, Eigen::Index labels, Eigen::Index cliques)
{
  if (unary.rows() != labels || unary.cols() != cliques)
    PCL_THROW_EXCEPTION(InvalidParameterException, "the unary costs of the cliques are "
                                                       << unary.rows() << " x "
                                                       << unary.cols() << ", expected "
                                                       << labels << " x " << cliques);
  for (Eigen::Index c = 0; c < cliques; ++c)
    if (!unary.col(c).allFinite())
      PCL_THROW_EXCEPTION(InvalidParameterException,
                          "a unary cost of clique " << c << " is not finite");
}

} // namespace

void
CliquePotential::validate(Eigen::Index labels, Eigen::Index variables) const
{
  if (!cliques)
    PCL_THROW_EXCEPTION(InvalidParameterException, "a clique potential has no cliques");
  const auto count = Eigen::Index(cliques->size());
  if (Eigen::Index(cliques->variables()) != variables)
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "cliques are over " << cliques->variables()
                                            << " variables, expected " << variables);
  validateWeights(weights, labels, count);
  if (!(truncation > 0.0f && truncation <= 1.0f))
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "truncation is " << truncation
                                         << ", expected more than 0 and up to 1");
  if (type == Type::pn_potts && (unary.size() > 0 || !kernels.empty()))
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "P^n Potts cliques have no variables: unary costs of them and "
                        "kernels between them need the robust potential");
  if (!hears_members && !kernels.empty())
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "cliques that do not hear their members do not hear each other "
                        "either: kernels between them need cliques that do");
  if (unary.size() > 0)
    validateUnary(unary, labels, count);
  for (const auto& kernel : kernels)
    if (!kernel || kernel->size() != count)
      PCL_THROW_EXCEPTION(InvalidParameterException,
                          "a kernel between cliques is "
                              << (kernel ? "over " + std::to_string(kernel->size())
                                         : std::string("missing"))
                              << ", expected one over " << count << " cliques");
}

} // namespace pcl_semantic
