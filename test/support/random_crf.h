// SPDX-License-Identifier: BSD-3-Clause

// Random CRFs of every model, small enough for the plain implementations.

#pragma once

#include "support/brute_force_crf.h"
#include "support/plain_crf.h"

#include <numeric>
#include <ostream>
#include <random>
#include <string>
#include <vector>

namespace pcl_semantic {

/** A model with a name, for parameterised tests. */
struct NamedCrf {
  std::string name;
  PlainCrf crf;
};

/** Symmetric, 0 or more, with a diagonal, like a Gaussian kernel with weights. */
inline Eigen::MatrixXf
makeSymmetricKernel(Eigen::Index size, float weight, unsigned seed)
{
  const Eigen::MatrixXf half =
      makeRandomMatrix(size, size, 0.0f, weight / float(size), seed);
  return half + half.transpose();
}

/** Cliques of 1 to \a largest of \a variables, with overlaps and gaps. */
inline std::vector<std::vector<std::int32_t>>
makeCliques(int count, int largest, int variables, unsigned seed)
{
  std::mt19937 random(seed);
  std::vector<std::int32_t> order(static_cast<std::size_t>(variables));
  std::iota(order.begin(), order.end(), 0);
  std::vector<std::vector<std::int32_t>> cliques;
  for (int c = 0; c < count; ++c) {
    std::shuffle(order.begin(), order.end(), random);
    cliques.emplace_back(order.begin(), order.begin() + 1 + int(random() % largest));
  }
  return cliques;
}

/** CRFs of \a variables variables and \a labels labels: every model, every option.
 * \param[in] strength of all couplings */
inline std::vector<NamedCrf>
makeEveryModel(int variables, int labels, int cliques, float strength, unsigned seed)
{
  using Type = CliquePotential::Type;
  PlainCrf unary;
  unary.unary = makeRandomMatrix(labels, variables, 0.0f, 3.0f, seed);
  PlainCrf dense = unary;
  for (const unsigned k : {1u, 2u})
    dense.kernels.push_back(makeSymmetricKernel(variables, strength, seed + k));
  PlainCrf full = dense;
  full.compatibility = makeRandomMatrix(labels, labels, -0.3f, 1.0f, seed + 3);
  full.compatibility =
      (full.compatibility + Eigen::MatrixXf(full.compatibility.transpose())).eval();

  PlainCliques clique;
  clique.members = makeCliques(cliques, std::min(variables, 6), variables, seed + 4);
  clique.weights = Eigen::MatrixXf::Constant(1, 1, strength);
  const auto with = [](PlainCrf crf, const PlainCliques& more) {
    crf.cliques.push_back(more);
    return crf;
  };
  PlainCliques potts = clique;
  potts.type = Type::pn_potts;
  PlainCliques potts_weights = potts;
  potts_weights.weights = makeRandomMatrix(labels, cliques, 0.0f, strength, seed + 5);
  PlainCliques bound = clique;
  bound.free_label = false;
  PlainCliques linked = clique;
  for (const unsigned k : {6u, 7u})
    linked.kernels.push_back(makeSymmetricKernel(cliques, strength, seed + k));
  PlainCliques linked_bound = linked;
  linked_bound.free_label = false;
  PlainCliques by_clique = clique;
  by_clique.weights = makeRandomMatrix(1, cliques, 0.0f, strength, seed + 8);
  PlainCliques by_label = linked;
  by_label.weights = makeRandomMatrix(labels, 1, 0.0f, strength, seed + 9);
  by_label.truncation = 0.7f;
  PlainCliques by_both = clique;
  by_both.weights = makeRandomMatrix(labels, cliques, 0.0f, strength, seed + 10);
  PlainCliques others = bound;
  others.members = makeCliques(2, 3, variables, seed + 12);

  return {{"unary only", unary},
          {"dense Potts", dense},
          {"full compatibility", full},
          {"P^n Potts", with(unary, potts)},
          {"dense and P^n Potts, weights of cliques and labels",
           with(dense, potts_weights)},
          {"robust", with(unary, clique)},
          {"dense and robust", with(dense, clique)},
          {"robust without free label", with(dense, bound)},
          {"kernels between cliques", with(dense, linked)},
          {"kernels between cliques, no free label", with(dense, linked_bound)},
          {"weights of cliques", with(dense, by_clique)},
          {"weights of labels, kernels between cliques", with(dense, by_label)},
          {"weights of both, unary of cliques", with(dense, by_both)},
          {"full compatibility and robust", with(full, linked)},
          {"three potentials", with(with(with(dense, linked), potts), others)}};
}

inline void
PrintTo(const NamedCrf& model, std::ostream* stream)
{
  *stream << model.name;
}

} // namespace pcl_semantic
