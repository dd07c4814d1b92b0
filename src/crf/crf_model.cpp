// SPDX-License-Identifier: BSD-3-Clause
#include "finite.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/crf/crf_model.h>

#include <algorithm>

namespace pcl_semantic {

namespace {

// The first variable with a cost that is not finite; N if there is none.
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
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "unary costs are of " << labels
                                              << " classes, expected 1 to 255");
  const Eigen::Index bad = firstNotFinite(unary);
  if (bad < variables)
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "a unary cost of variable " << bad << " is not finite");
  if (compatibility.labels() != 0 && compatibility.labels() != labels)
    PCL_THROW_EXCEPTION(InvalidParameterException, "the label compatibility is of "
                                                       << compatibility.labels()
                                                       << " classes, expected "
                                                       << labels);
  for (const auto& kernel : kernels)
    if (!kernel || kernel->size() != variables)
      PCL_THROW_EXCEPTION(InvalidParameterException,
                          "a kernel is "
                              << (kernel ? "over " + std::to_string(kernel->size())
                                         : std::string("missing"))
                              << ", expected one over " << variables << " variables");
  for (const CliquePotential& potential : cliques)
    potential.validate(labels, variables);
}

} // namespace pcl_semantic
