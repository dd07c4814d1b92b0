// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/dataset/image_pair_sequence.h>
#include <pcl_semantic/dataset/rectifier.h>

#include <memory>
#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief A stereo camera, or what plays its part, whose pairs come by themselves: at
 * their own time, without a known end. */
class LiveCamera {
public:
  virtual ~LiveCamera() = default;

  /** \brief Waits for the next pairs, without decoding them: of a folder or a video not
   * longer than a twentieth of a second, of a camera or a stream as long as these do.
   * \return how many came; 0 = none
   * \throws BadInputException if no more can come, and why */
  virtual int grab() = 0;

  /** \brief Whether no more will come. */
  virtual bool hasEnded() const = 0;

  /** \brief The newest of the pairs that came last, rectified; its time is that since
   * the camera was opened [s]. \throws BadInputException if it is damaged, or of
   * another size */
  virtual StereoFrame retrieve() = 0;

  /** \brief The rectified pair, its size filled in. */
  const StereoCamera&
  camera() const
  {
    return pair_.camera;
  }

  /** \brief As FrameSequence::T_camera0_camera(). */
  const Eigen::Isometry3d&
  T_camera0_camera() const
  {
    return pair_.T_camera0_camera;
  }

protected:
  RectifiedPair pair_; ///< set by the constructors
};

/** \brief Whether a name is that of a camera or a stream instead of a file: a number
 * (`0`), a device (`/dev/video0`) or an address (`rtsp://...`). */
bool isCapture(const std::string& name);

/** \brief Opens two cameras or streams; two videos, which are played at their own rate;
 * or, if left and right are the same, one whose images have both sides next to each
 * other.
 * \param[in] files `left` and `right` by name, and the calibration; `times` is not used
 * \throws BadInputException if one cannot be opened, gives no image, both differ in
 * size, or the calibration does not fit */
std::unique_ptr<LiveCamera> openCaptures(const ImagePairFiles& files);

/** \brief Whether the first pair lies in a folder; see openLiveFolder(). */
bool holdsPair(const std::string& folder);

/** \brief Opens a folder in KITTI's layout (calib.txt, image_2 and image_3 or image_0
 * and image_1) that another program fills: grabs the newest pair of which both images
 * are whole, which is a PNG that ends as one. What has a lower number came before it,
 * whole or not. Other files are passed over.
 * \throws BadInputException as KittiSequence, also if there is no pair yet */
std::unique_ptr<LiveCamera> openLiveFolder(const std::string& folder);

} // namespace pcl_semantic
