// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/filters/cloud_refiner.h>

#include <pcl/filters/filter.h>
#include <pcl/point_types.h>

#include <memory>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Makes the labels of a cloud consistent: mean field in a CRF over its points
 * (section IV of the paper; doc/crf.md).
 *
 * A pcl::Filter that removes nothing: the output is the input with the `label` of the
 * points of setIndices() rewritten; organization is kept, and it works in place. Points
 * outside the indices keep their label and distribution, and neither send nor receive
 * messages; cliques lose them. Points that are not finite keep their place, with label
 * 0, and are counted.
 *
 * Works for every registered point type with the fields x, y, z (float) and label; the
 * kernels of colours are there for types with rgb or rgba. */
template <typename PointT>
class SemanticCRF : public pcl::Filter<PointT>, public CloudRefiner {
public:
  using Ptr = std::shared_ptr<SemanticCRF<PointT>>;
  using ConstPtr = std::shared_ptr<const SemanticCRF<PointT>>;
  using typename pcl::Filter<PointT>::PointCloud;

  SemanticCRF() { this->filter_name_ = "SemanticCRF"; }

protected:
  /** \throws InvalidParameterException if something that was set does not fit the cloud
   * \throws BadInputException at a label or a distribution that cannot be */
  void applyFilter(PointCloud& output) override;

private:
  static Fields readFields(const PointCloud& cloud);
};

} // namespace pcl_semantic

#include <pcl_semantic/filters/impl/semantic_crf.hpp>

/// \cond
namespace PCL_SEMANTIC_EXPORT pcl_semantic {

// The library has them: programs need not compile these again.
extern template class PCL_SEMANTIC_INSTANCE SemanticCRF<pcl::PointXYZL>;
extern template class PCL_SEMANTIC_INSTANCE SemanticCRF<pcl::PointXYZRGBL>;
extern template class PCL_SEMANTIC_INSTANCE SemanticCRF<pcl::PointXYZLNormal>;

} // namespace pcl_semantic
/// \endcond
