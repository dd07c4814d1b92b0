/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/label_distributions.h>
#include <pcl_semantic/crf/mean_field.h>

namespace pcl_semantic {

MeanField::MeanField(CrfModel model) : model_(std::move(model))
{
  for (const auto& kernel : model_.kernels)
    if (kernel->size() != model_.unary.cols())
      PCL_THROW_EXCEPTION(InvalidParameterException, "a kernel is over "
                                                         << kernel->size()
                                                         << " variables, expected "
                                                         << model_.unary.cols());
  if (!model_.unary.allFinite())
    PCL_THROW_EXCEPTION(InvalidParameterException, "a unary cost is not finite");
  messages_ = -model_.unary;
  marginals_.resizeLike(messages_);
  const int labels = static_cast<int>(messages_.rows());
#pragma omp parallel for schedule(static)
  for (Eigen::Index i = 0; i < messages_.cols(); ++i)
    distributionFromLog(messages_.col(i).data(), labels, marginals_.col(i).data());
}

void
MeanField::update()
{
  messages_ = -model_.unary;
  for (const auto& kernel : model_.kernels)
    kernel->addProduct(marginals_, messages_, {});
  const int labels = static_cast<int>(messages_.rows());
#pragma omp parallel for schedule(static)
  for (Eigen::Index i = 0; i < messages_.cols(); ++i)
    distributionFromLog(messages_.col(i).data(), labels, marginals_.col(i).data());
}

} // namespace pcl_semantic
