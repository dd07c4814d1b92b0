// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/filters/checked_filter.h>
#include <pcl_semantic/filters/cloud_crf.h>

#include <pcl/PCLPointCloud2.h>
#include <pcl/point_types.h>

#include <memory>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Makes the labels of a cloud consistent by mean-field inference in a CRF over
 * its points (section IV of the paper; doc/crf.md).
 *
 * A pcl::Filter that rewrites the `label` of the points of setIndices(). It removes no
 * points and keeps the organization. Input and output may be the same cloud.
 *
 * Points outside the indices keep their label and distribution. They exchange no
 * messages and are removed from cliques. Two or more points at exactly 0 0 0, the
 * no-returns of a scanner, are treated like points outside the indices. Points that are
 * not finite get label 0. getSkippedPoints() counts these and the no-returns. An empty
 * cloud is returned unchanged.
 *
 * Works for every registered point type with the fields x, y, z (float or double) and
 * label. Types with rgb or rgba have colour kernels. */
template <typename PointT>
class SemanticCRF : public CheckedFilter<PointT>, public CloudCRF {
public:
  using Ptr = std::shared_ptr<SemanticCRF<PointT>>;
  using ConstPtr = std::shared_ptr<const SemanticCRF<PointT>>;
  using typename CheckedFilter<PointT>::PointCloud;

  SemanticCRF() { this->filter_name_ = "SemanticCRF"; }

protected:
  /** \throws InvalidParameterException if there are no measurements, or a setting does
   * not have the size of the cloud
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
 * `probability` rewritten. Both fields keep their types. doc/formats.md lists the
 * accepted names of the fields. */
template <>
class PCL_SEMANTIC_INSTANCE SemanticCRF<pcl::PCLPointCloud2>
    : public CheckedFilter<pcl::PCLPointCloud2>, public CloudCRF {
public:
  using Ptr = std::shared_ptr<SemanticCRF<pcl::PCLPointCloud2>>;
  using ConstPtr = std::shared_ptr<const SemanticCRF<pcl::PCLPointCloud2>>;

  SemanticCRF() { this->filter_name_ = "SemanticCRF"; }

protected:
  /** \throws InvalidParameterException if the cloud has no `label`
   * \throws InvalidParameterException if there are no measurements, neither set nor in
   * `probability`
   * \throws InvalidParameterException if the set measurements and `probability` have
   * different numbers of classes
   * \throws InvalidParameterException if the model needs cliques and there are none
   * \throws InvalidParameterException if a setting does not have the size of the cloud
   * \throws BadInputException at an invalid value of a field
   * \throws BadInputException if the labels are in a field of another name and their
   * encoding is unknown */
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
