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
 * A pcl::Filter that removes no points: the output is the input with the `label` of the
 * points of setIndices() rewritten. The organization is kept, and the filter works in
 * place. Points outside the indices keep their label and distribution, exchange no
 * messages and are removed from cliques. Points that are not finite remain, with label
 * 0, and are counted. Two or more points at exactly 0 0 0, the no-returns of a scanner,
 * are counted and treated like points outside the indices. An empty cloud is returned
 * unchanged.
 *
 * Works for every registered point type with the fields x, y, z (float) and label.
 * Types with rgb or rgba have colour kernels. */
template <typename PointT>
class SemanticCRF : public CheckedFilter<PointT>, public CloudCRF {
public:
  using Ptr = std::shared_ptr<SemanticCRF<PointT>>;
  using ConstPtr = std::shared_ptr<const SemanticCRF<PointT>>;
  using typename CheckedFilter<PointT>::PointCloud;

  SemanticCRF() { this->filter_name_ = "SemanticCRF"; }

protected:
  /** \throws InvalidParameterException if a setting does not fit the cloud
   * \throws BadInputException at an invalid label or distribution */
  void applyFilter(PointCloud& output) override;

private:
  CloudFields readFields(const PointCloud& cloud) const;
};

/** \brief The same filter for clouds whose fields are found by name: x y z, label and,
 * if present, rgb or rgba, probability (COUNT L) and clique (0 = none). Other fields
 * are kept.
 *
 * Unless setLabelDistributions() or setLabelConfidence() was called, the measurements
 * are the field `probability`. Unless cliques or a generator were set, the cliques are
 * the field `clique`. The output is the input with `label` and, if present,
 * `probability` rewritten in their own types. doc/formats.md lists the accepted names
 * of both. */
template <>
class PCL_SEMANTIC_INSTANCE SemanticCRF<pcl::PCLPointCloud2>
    : public CheckedFilter<pcl::PCLPointCloud2>, public CloudCRF {
public:
  using Ptr = std::shared_ptr<SemanticCRF<pcl::PCLPointCloud2>>;
  using ConstPtr = std::shared_ptr<const SemanticCRF<pcl::PCLPointCloud2>>;

  SemanticCRF() { this->filter_name_ = "SemanticCRF"; }

protected:
  /** \throws InvalidParameterException if the cloud has no `label`, if it has no
   * `probability` and no measurements were set, if `probability` has another number of
   * classes than these, if a model needs cliques and there are none, or if a setting
   * does not fit the cloud
   * \throws BadInputException at an invalid value of a field, or labels of another name
   * in an unknown encoding */
  void applyFilter(pcl::PCLPointCloud2& output) override;
};

} // namespace pcl_semantic

#include <pcl_semantic/filters/impl/semantic_crf.hpp>

/// \cond
namespace PCL_SEMANTIC_EXPORT pcl_semantic {

// Instantiated in the library, so that programs need not compile them.
extern template class PCL_SEMANTIC_INSTANCE SemanticCRF<pcl::PointXYZL>;
extern template class PCL_SEMANTIC_INSTANCE SemanticCRF<pcl::PointXYZRGBL>;
extern template class PCL_SEMANTIC_INSTANCE SemanticCRF<pcl::PointXYZLNormal>;

} // namespace pcl_semantic
/// \endcond
