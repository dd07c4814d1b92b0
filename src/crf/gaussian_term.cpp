// SPDX-License-Identifier: BSD-3-Clause
#include "finite.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/crf/gaussian_term.h>

#include <cmath>

namespace pcl_semantic {

void
GaussianTerm::validate(Eigen::Index points) const
{
  if (!(position_deviation > 0.0f) || !std::isfinite(position_deviation))
    PCL_THROW_EXCEPTION(InvalidParameterException, "position deviation is "
                                                       << position_deviation
                                                       << ", expected more than 0");
  if (!(weight >= 0.0f) || !std::isfinite(weight))
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "kernel weight is " << weight << ", expected 0 or more");
  if (features.size() > 0 && features.cols() != points)
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "features have " << features.cols() << " columns, expected "
                                         << points);
  if (!areFinite(features))
    PCL_THROW_EXCEPTION(InvalidParameterException, "a feature is not finite");
}

} // namespace pcl_semantic
