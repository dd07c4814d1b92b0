// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/filters/checked_filter.h>
#include <pcl_semantic/filters/cloud_crf.h>

#include <pcl/PCLPointCloud2.h>
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
 * 0, and are counted; so are two or more points at exactly 0 0 0, which a scanner gives
 * for no return: they are as points outside the indices. A cloud of no points is given
 * back as it is.
 *
 * Works for every registered point type with the fields x, y, z (float) and label; the
 * kernels of colours are there for types with rgb or rgba. */
template <typename PointT>
class SemanticCRF : public CheckedFilter<PointT>, public CloudCRF {
public:
  using Ptr = std::shared_ptr<SemanticCRF<PointT>>;
  using ConstPtr = std::shared_ptr<const SemanticCRF<PointT>>;
  using typename CheckedFilter<PointT>::PointCloud;

  SemanticCRF() { this->filter_name_ = "SemanticCRF"; }

protected:
  /** \throws InvalidParameterException if something that was set does not fit the cloud
   * \throws BadInputException at a label or a distribution that cannot be */
  void applyFilter(PointCloud& output) override;

private:
  CloudFields readFields(const PointCloud& cloud) const;
};

/** \brief The same for clouds whose fields are known by name: x y z, label and, if they
 * are there, rgb or rgba, probability (COUNT L) and clique (0 = none). Other fields are
 * kept.
 *
 * Unless setLabelDistributions() or setLabelConfidence() was called, the measurements
 * are the field `probability`; unless cliques or a generator were set, the cliques are
 * the field `clique`. The output is the input with `label` and, if it is there,
 * `probability` rewritten, in their own types. Both may be spelled as doc/formats.md
 * says. */
template <>
class PCL_SEMANTIC_INSTANCE SemanticCRF<pcl::PCLPointCloud2>
    : public CheckedFilter<pcl::PCLPointCloud2>, public CloudCRF {
public:
  using Ptr = std::shared_ptr<SemanticCRF<pcl::PCLPointCloud2>>;
  using ConstPtr = std::shared_ptr<const SemanticCRF<pcl::PCLPointCloud2>>;

  SemanticCRF() { this->filter_name_ = "SemanticCRF"; }

protected:
  /** \throws InvalidParameterException if the cloud has no `label`, neither
   * `probability` nor measurements that were set, `probability` of another number of
   * classes than these, no cliques for a model that needs some, or something does not
   * fit it
   * \throws BadInputException at a value of a field that cannot be, or labels of
   * another name that are not understood */
  void applyFilter(pcl::PCLPointCloud2& output) override;
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
