// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/dataset/frame_sequence.h>
#include <pcl_semantic/dataset/kitti_calibration.h>

#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief A sequence of the KITTI odometry benchmark.
 *
 * A folder with `calib.txt`, the images `image_2`, `image_3` (colour) or `image_0`,
 * `image_1` (grey) named by frame number (`000012.png`), and optionally `times.txt` and
 * `poses.txt`. The images define the frames, so numbers may have gaps. Row n of
 * `times.txt` and `poses.txt` belongs to frame n, also if frame n is missing. */
class KittiSequence : public FrameSequence {
public:
  /** \brief Checks all files, except the content of the images after the first.
   * \param[in] folder the sequence
   * \param[in] cameras pair to read
   * \throws BadInputException if there are no images, an image has no partner, the
   * calibration is invalid, or `times.txt` is damaged or too short */
  explicit KittiSequence(const std::string& folder,
                         KittiCameras cameras = KittiCameras::automatic);

  std::size_t
  size() const override
  {
    return frames_.size();
  }

  int
  frameNumber(std::size_t i) const override
  {
    return frames_.at(i).number;
  }

  /** \brief Path of the i-th left image. */
  const std::string&
  leftPath(std::size_t i) const
  {
    return frames_.at(i).left;
  }

  /** \brief Time in `times.txt` or, without the file, 0.1 s times the frame number. */
  double
  timestamp(std::size_t i) const override
  {
    return frames_.at(i).timestamp;
  }

  StereoFrame frame(std::size_t i) const override;

  const StereoCamera&
  camera() const override
  {
    return calibration_.camera;
  }

  const Eigen::Isometry3d&
  T_camera0_camera() const override
  {
    return calibration_.T_camera0_camera;
  }

  /** \brief Whether the calibration has the pose of the laser scanner. */
  bool
  hasVelodyne() const
  {
    return calibration_.T_camera0_velodyne.has_value();
  }

  /** \brief Pose of the laser scanner in camera 0 [m].
   * \throws BadInputException if the calibration does not have it */
  const Eigen::Isometry3d& T_camera0_velodyne() const;

  /** \brief Path of `poses.txt`; empty if there is none. */
  std::string posesPath() const override;

  const std::string&
  folder() const
  {
    return folder_;
  }

private:
  struct Entry {
    int number = 0;
    double timestamp = 0.0; ///< [s]
    std::string left;       ///< path
    std::string right;      ///< path
  };

  void findFrames(const std::string& left_folder, const std::string& right_folder);

  void readTimes();

  std::string folder_;
  std::vector<Entry> frames_;
  KittiCalibration calibration_;
};

} // namespace pcl_semantic
