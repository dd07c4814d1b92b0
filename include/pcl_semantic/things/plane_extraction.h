// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <Eigen/Core>
#include <pcl/ModelCoefficients.h>
#include <pcl/PointIndices.h>
#include <pcl/pcl_base.h>

#include <cstddef>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief A plane of a cloud and its points. */
struct ExtractedPlane {
  Eigen::Vector3d normal; ///< length 1; its largest component is positive
  double offset = 0.0;    ///< normal . p + offset = 0 [m]
  double radius = 0.0;    ///< of the search that found it [m]
  pcl::Indices indices;   ///< of its points, ascending
};

/** \brief Parameters of PlaneExtraction. Values of 0 are automatic: resolved(). */
struct PlaneParameters {
  /// Of the surroundings of a point, for its normal, in the first search [m]. 0 = three
  /// times the spacing of the points, at least 0.15 m.
  double radius = 0.0;
  double angle = 0.0;    ///< maximum angle between the normals of a plane [rad]
  double distance = 0.0; ///< maximum distance of a point that joins a plane [m]
  double gap = 0.0;      ///< maximum distance between parts of a plane [m]
  double min_area = 0.0; ///< minimum area of a plane [m^2]

  /** \throws InvalidParameterException that names the parameter and its range */
  void validate() const;

  /** \brief The automatic radius [m].
   * \param[in] spacing of the points, or edge of their voxels [m] */
  static double automaticRadius(double spacing);

  /** \brief Replaces automatic values by those for a radius r and a deviation of
   * the points from their planes: three deviations as distance (0.1 r to 0.4 r) and,
   * over r, as angle (0.15 to 0.5 rad); a gap of 5 r; an area of 5 r^2.
   * \param[in] deviation [m] */
  PlaneParameters resolved(double deviation) const;
};

/** \brief Settings of PlaneExtraction, and its method for any container of points. */
class PlaneExtractionBase {
public:
  /** \throws InvalidParameterException as PlaneParameters::validate() */
  void setParameters(const PlaneParameters& parameters);

  const PlaneParameters&
  getParameters() const
  {
    return parameters_;
  }

  /** \brief The parameters of the last extraction, without automatic values; those of
   * its first search. */
  const PlaneParameters&
  getResolvedParameters() const
  {
    return resolved_;
  }

protected:
  PlaneExtractionBase() = default;
  ~PlaneExtractionBase() = default;

  std::vector<ExtractedPlane> extract(const std::vector<Eigen::Vector3d>& points,
                                      const pcl::Indices& indices);

private:
  PlaneParameters parameters_;
  PlaneParameters resolved_;
};

/** \brief Extracts the planes of a cloud by region growing. It is used as
 * pcl::OrganizedMultiPlaneSegmentation, for clouds of any order: scans, maps and
 * others. Labels are not used: a plane may have several classes.
 *
 * Points are sorted into cubes of half the radius. The normal of a cube is that of the
 * plane of least squares through the means of the cubes within the radius. A plane
 * grows from the flattest cube over neighbouring cubes whose normal and mean fit, and
 * is fitted again until it stops growing. Coplanar parts with small gaps are merged.
 * Each point joins the nearest plane that passes within the distance and has a cube
 * within the radius. Points neither in a plane nor next to one are searched once more
 * with twice the radius, because the noise of distant points may be wider than the
 * radius; planes found then join coplanar ones of the first search. The result depends
 * neither on the order of the points nor on the number of threads.
 *
 * \tparam PointT has x, y, z [m] */
template <typename PointT>
class PlaneExtraction : public pcl::PCLBase<PointT>, public PlaneExtractionBase {
public:
  /** \brief Extracts the planes of the input cloud and indices. Points that are not
   * finite are in none.
   * \return planes in the order of their lowest points (by z, y, x)
   * \throws InvalidParameterException if there is no input cloud or an index is out of
   * range
   * \throws BadInputException if the points have more than 2^21 cubes along an axis,
   * without the gaps between distant points */
  std::vector<ExtractedPlane> extract();

  /** \brief Does the same with PCL's types.
   * \param[out] coefficients a, b, c, d of a x + b y + c z + d = 0
   * \param[out] inliers of each plane */
  void segment(std::vector<pcl::ModelCoefficients>& coefficients,
               std::vector<pcl::PointIndices>& inliers);

private:
  using pcl::PCLBase<PointT>::input_;
  using pcl::PCLBase<PointT>::indices_;
};

} // namespace pcl_semantic

#include <pcl_semantic/things/impl/plane_extraction.hpp>
