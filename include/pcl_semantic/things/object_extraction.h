// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_set.h>

#include <Eigen/Core>
#include <pcl/PointIndices.h>
#include <pcl/pcl_base.h>

#include <cmath>
#include <cstddef>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Settings of ObjectExtraction, and its method for any container of points. */
class ObjectExtractionBase {
public:
  static constexpr double default_gap = 0.7; ///< [m]

  /** \brief Sets the classes whose points become objects: those marked `thing`, with
   * the gaps of the label set. Without this call, every label but 0 is such a class.
   * \throws InvalidParameterException if no class is a thing */
  void setLabelSet(const LabelSet& label_set);

  /** \brief Sets the maximum distance between neighbouring points of an object [m], for
   * all classes without a gap of their own. Default: default_gap.
   * \throws InvalidParameterException unless finite and positive */
  void setGap(double gap);

  double
  getGap() const
  {
    return gap_;
  }

  /** \brief Sets the minimum number of points of an object. Default: 1. */
  void
  setMinClusterSize(std::size_t points)
  {
    min_size_ = points;
  }

  std::size_t
  getMinClusterSize() const
  {
    return min_size_;
  }

protected:
  /** \brief A point with its label. */
  struct Point {
    Eigen::Vector3d position; ///< [m]
    Label label;
    pcl::index_t index; ///< in the cloud
  };

  ObjectExtractionBase() = default;
  ~ObjectExtractionBase() = default;

  bool
  isThing(Label label) const
  {
    return label != kUnlabelled && gaps_[label] > 0.0;
  }

  std::vector<pcl::PointIndices> group(std::vector<Point> points) const;

private:
  // By label [m]: 0 = no thing, infinite = gap_.
  std::vector<double> gaps_ = std::vector<double>(256, HUGE_VAL);
  double gap_ = default_gap;
  std::size_t min_size_ = 1;
};

/** \brief Extracts the objects of a labelled cloud: for each class that is a thing, the
 * groups of points in which every point is at most a gap from another one. It is used
 * as pcl::EuclideanClusterExtraction and works on scans, on any other labelled cloud,
 * and on the clouds of a map.
 *
 * Points of different classes are never in one object. Points that are not finite, and
 * points without a label, are in none.
 * \tparam PointT has x, y, z [m] and `label` */
template <typename PointT>
class ObjectExtraction : public pcl::PCLBase<PointT>, public ObjectExtractionBase {
public:
  /** \brief Extracts the objects of the input cloud and indices.
   * \param[out] objects with increasing indices. Objects are in the order of their
   * lowest points (by z, y, x), so their numbers do not depend on the order of points
   * \throws InvalidParameterException if there is no input cloud, an index is out of
   * range or a label exceeds 255
   * \throws BadInputException as connectedComponents() */
  void extract(std::vector<pcl::PointIndices>& objects);

private:
  using pcl::PCLBase<PointT>::input_;
  using pcl::PCLBase<PointT>::indices_;
};

} // namespace pcl_semantic

#include <pcl_semantic/things/impl/object_extraction.hpp>
