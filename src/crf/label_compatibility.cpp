// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/crf/label_compatibility.h>

namespace pcl_semantic {

LabelCompatibility::LabelCompatibility(Eigen::MatrixXf costs) : costs_(std::move(costs))
{
  if (costs_.rows() != costs_.cols() || costs_.rows() == 0)
    PCL_THROW_EXCEPTION(InvalidParameterException, "the label compatibility is "
                                                       << costs_.rows() << " x "
                                                       << costs_.cols()
                                                       << ", expected L x L");
  for (Eigen::Index k = 0; k < labels(); ++k)
    for (Eigen::Index l = 0; l < labels(); ++l) {
      // Beyond that sums of messages would leave the range of floats.
      if (!(std::abs(costs_(l, k)) <= 1e9f))
        PCL_THROW_EXCEPTION(InvalidParameterException,
                            "the compatibility of labels "
                                << l << " and " << k << " (from 0) is " << costs_(l, k)
                                << ", expected -1e9 to 1e9");
      is_potts_ = is_potts_ && costs_(l, k) == float(l != k);
      is_symmetric_ = is_symmetric_ && costs_(l, k) == costs_(k, l);
    }
}

} // namespace pcl_semantic
