// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/abi_check.h>
#include <pcl_semantic/core/export.h>

#include <Eigen/Core>
#include <pcl/PointIndices.h>
#include <pcl/pcl_base.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <memory>
#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Groups points that are likely to have one label: the cliques of the paper's
 * eq. (7).
 *
 * Callers with another point type copy xyz and, if present, colour (pcl::copyPointCloud
 * does). A generator that needs an image besides a map (superpixels) takes it in its
 * own setters. Not thread-safe.
 *
 * Used as PCL's segmentations are: setInputCloud(), setIndices(), extract(). */
class CliqueGenerator : public pcl::PCLBase<pcl::PointXYZRGB> {
public:
  using Ptr = std::shared_ptr<CliqueGenerator>;
  using ConstPtr = std::shared_ptr<const CliqueGenerator>;
  using Cloud = pcl::PointCloud<pcl::PointXYZRGB>;

  /** \brief Groups the points of the input cloud, or only those of setIndices().
   * Generators that need an organized cloud refuse indices.
   * \param[out] cliques lists of indices into the input cloud
   * \throws InvalidParameterException if there is no input cloud, or an index exceeds
   * it
   * \throws BadInputException as generate() */
  void extract(std::vector<pcl::PointIndices>& cliques);

  /** \brief Whether the result depends on colours: callers whose points have none
   * should refuse such a generator. */
  virtual bool
  usesColour() const
  {
    return false;
  }

  /** \brief Sets the origin that was subtracted from the clouds' positions, see
   * localOrigin(). Generators that divide space into cells align these cells with the
   * original positions. Without this call, these generators warn by PCL_WARN if single
   * precision has degraded the positions, see doubtOfSteps().
   * \param[in] origin [m]; zero by default */
  void
  setOrigin(const Eigen::Vector3d& origin)
  {
    origin_ = origin;
    judges_steps_ = false;
  }

  /** \brief Sets the mean positions of voxels for clouds of voxel centres. Generators
   * that fit surfaces use them.
   * \param[in] means as many points as the clouds; not copied. null = use the clouds
   * \param[in] voxel_size [m]; 0 = unknown */
  void
  setMeanPositions(const Cloud::ConstPtr& means, double voxel_size)
  {
    means_ = means;
    voxel_size_ = voxel_size;
  }

  /** \brief Groups the points of a cloud; the result does not depend on the number of
   * threads.
   * \param[in] cloud organized or not; non-finite points belong to no clique, but their
   * colour may be used
   * \return lists of indices into \a cloud, none of them empty, each ascending; they
   * may overlap and need not cover every point
   * \throws BadInputException if the generator cannot use the cloud */
  virtual std::vector<pcl::PointIndices> generate(const Cloud& cloud) = 0;

protected:
  /** \brief Warns by PCL_WARN if single precision has degraded the positions and
   * setOrigin() was not called.
   * \param[in] generator name of the calling class, for the warning */
  void judgeSteps(const std::string& generator, const Cloud& cloud) const;

  /** \brief Passes the settings of this generator to another one. */
  void configure(CliqueGenerator& other) const;

  /** \brief The mean positions, or the cloud if there are none.
   * \throws InvalidParameterException if their number is not that of the points */
  const Cloud& meansOr(const Cloud& cloud) const;

  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero(); ///< [m]
  double voxel_size_ = 0.0;                          ///< [m]; 0 = unknown

private:
  bool judges_steps_ = true;
  Cloud::ConstPtr means_;
};

} // namespace pcl_semantic
