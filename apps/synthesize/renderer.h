// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "lens.h"
#include "street.h"

#include <pcl_semantic/core/stereo_camera.h>

#include <opencv2/core/mat.hpp>

namespace pcl_semantic {

/** \brief Images of a stereo camera in the street, and their ground truth. */
struct SyntheticView {
  int frame = 0;
  cv::Mat left;      ///< CV_8UC3 (BGR), camera 2
  cv::Mat right;     ///< CV_8UC3 (BGR), camera 3
  cv::Mat disparity; ///< CV_32FC1, of the left image [px], 0 = none (sky)
  cv::Mat labels;    ///< CV_8UC1, SyntheticClass of the left image
  cv::Mat objects;   ///< CV_32SC1, number of the car or pedestrian, 0 = none
  StereoCamera camera;
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity(); ///< left camera
};

/** \brief Renders the synthetic street by casting rays, with the same bytes for any
 * number of threads. */
class SyntheticRenderer {
public:
  static constexpr double camera_2_offset = -0.06; ///< x of camera 2 in camera 0 [m]

  /** \throws InvalidParameterException unless \a width x \a height lies within
   * 64 x 32 and 4096 x 4096 */
  SyntheticRenderer(const SyntheticScene& scene, int width, int height,
                    synthetic::Lens lens = synthetic::Lens::pinhole);

  /** \brief KITTI's colour cameras, scaled to the width: baseline 0.54 m. With another
   * lens, its focal length. */
  const StereoCamera&
  camera() const
  {
    return camera_;
  }

  /** \brief T_world_camera of the left camera (camera 2). */
  Eigen::Isometry3d pose(int frame) const;

  /** \throws InvalidParameterException if the frame does not exist */
  SyntheticView render(int frame) const;

  /** \brief Renders the frame from another pose, for a pair mounted elsewhere.
   * \param[in] T_world_camera pose of its left camera
   * \throws InvalidParameterException if the frame does not exist */
  SyntheticView render(int frame, const Eigen::Isometry3d& T_world_camera) const;

private:
  SyntheticScene scene_;
  StereoCamera camera_;
  synthetic::Lens lens_;
};

} // namespace pcl_semantic
