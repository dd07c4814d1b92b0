// SPDX-License-Identifier: BSD-3-Clause
#include "matrix_kernel.h"

#include <pcl_semantic/core/exceptions.h>

#include <cmath>

namespace pcl_semantic {

MatrixKernel::MatrixKernel(Eigen::MatrixXf matrix) : matrix_(std::move(matrix))
{
  if (matrix_.rows() != matrix_.cols())
    PCL_THROW_EXCEPTION(InvalidParameterException, "a kernel matrix is "
                                                       << matrix_.rows() << " x "
                                                       << matrix_.cols()
                                                       << ", expected a square one");
  if (!matrix_.allFinite())
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "a value of a kernel matrix is not finite");
}

void
MatrixKernel::addProduct(const Eigen::Ref<const Eigen::MatrixXf>& values,
                         Eigen::Ref<Eigen::MatrixXf> result) const
{
#pragma omp parallel for schedule(dynamic, 16) if (size() > 100)
  for (Eigen::Index i = 0; i < size(); ++i)
    for (Eigen::Index j = 0; j < size(); ++j)
      if (j != i)
        result.col(i) += matrix_(i, j) * values.col(j);
}

} // namespace pcl_semantic
