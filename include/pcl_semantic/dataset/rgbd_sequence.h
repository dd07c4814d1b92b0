// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/config_parameter.h>
#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/stereo_camera.h>
#include <pcl_semantic/dataset/pinhole_camera.h>
#include <pcl_semantic/dataset/undistorter.h>
#include <pcl_semantic/files/pose_doubts.h>
#include <pcl_semantic/images/sensor_frame.h>

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief An RGB-D sequence as options name it; the camera's file is separate. */
struct RgbdFiles {
  std::string folder;         ///< see RgbdSequence
  std::string intrinsics;     ///< fx,fy,cx,cy instead of the camera's file [px]
  double depth_scale = 0.0;   ///< number per metre; 0 = default of the layout
  double depth_within = 0.02; ///< between the times of colour and depth [s]

  /** \brief Requires the camera, without reading its file.
   * \param[in] calibration path of that file; empty = from \a intrinsics
   * \throws InvalidParameterException unless one of them is given, or if the
   * intrinsics are no camera */
  void requireCamera(const std::string& calibration) const;
};

/** \brief Parameters `rgbd`, `intrinsics`, `depth_scale`, `depth_within`. */
ConfigParameters parametersOf(RgbdFiles& files);

/** \brief Frames of an RGB-D camera with depth images registered to the colour images.
 *
 * | layout | files |
 * |---|---|
 * | TUM, ETH3D | `rgb.txt` and `depth.txt` list times and files |
 * | folders | `rgb/` (or `color/`) and `depth/`, with equal file names in both |
 * | 7-Scenes | `frame-N.color.png` (or `.jpg`), `frame-N.depth.png`, `frame-N.pose.txt`
 * |
 *
 * In TUM's layout each colour image gets the depth image nearest in time, and is
 * skipped if none is within a maximum difference. Depth images are 16-bit PNG or TIFF,
 * or 32-bit float TIFF; 0, 65535 and non-finite values are no depths. Poses are found
 * in `groundtruth.txt`, in the files `pose/NAME.txt` (ScanNet), or in those of
 * 7-Scenes. */
class RgbdSequence {
public:
  /** \param[in] folder see above
   * \param[in] camera of the colour images; frames are undistorted
   * \param[in] depth_scale number per metre; 0 = 5000 in TUM's layout, 1 for floats,
   * else 1000
   * \param[in] depth_within maximum difference between the times of colour and depth
   * in TUM's layout [s]
   * \throws BadInputException if the folder has no frames, or the first image does not
   * have the camera's size
   * \throws InvalidParameterException if the scale is less than 1 (probably metres per
   * number), or the difference negative or not finite */
  RgbdSequence(const std::string& folder, const PinholeCamera& camera,
               double depth_scale = 0.0,
               double depth_within = RgbdFiles().depth_within);

  /** \brief Opens a sequence.
   * \param[in] calibration the camera's file; empty = RgbdFiles::intrinsics
   * \throws as the constructor, readPinholeCamera() and pinholeCameraOf() */
  RgbdSequence(const RgbdFiles& files, const std::string& calibration);

  /** \brief The colour images of the frames of such a folder by their numbers, without
   * a camera.
   * \param[out] doubts if not null: lines about skipped images are appended
   * \throws as the constructor */
  static std::map<int, std::string>
  colourImages(const std::string& folder,
               double depth_within = RgbdFiles().depth_within,
               std::vector<std::string>* doubts = nullptr);

  std::size_t
  size() const
  {
    return frames_.size();
  }

  /** \brief Name of a frame without extension: its time [s] in TUM's layout, else the
   * name of its files. */
  const std::string&
  name(std::size_t i) const
  {
    return frames_.at(i).name;
  }

  /** \brief Number of the i-th frame: the position of its colour image in the list or
   * folder, from 0. Skipped images leave gaps. */
  int
  frameNumber(std::size_t i) const
  {
    return frames_.at(i).number;
  }

  /** \brief Whether the frames have times: in TUM's layout, or of names that are
   * seconds with a point. Otherwise they count as 0.1 s apart. */
  bool
  hasTimes() const
  {
    return has_times_;
  }

  /** \brief Whether the folder has TUM's lists. */
  bool
  isTum() const
  {
    return is_tum_;
  }

  /** \brief Time of the colour image [s], see hasTimes(). */
  double
  timestamp(std::size_t i) const
  {
    return frames_.at(i).time;
  }

  /** \brief Path of the folder's trajectory, see readTrajectory(), or of the folder of
   * its pose files; empty if there is none. */
  const std::string&
  posesPath() const
  {
    return poses_;
  }

  /** \brief Whether posesPath() is a folder with one file for each frame. */
  bool hasPoseFiles() const;

  /** \brief Reads the pose files, by the names of the frames. From then on the sequence
   * lacks frames whose pose is not finite: the camera was lost.
   * \return poses by frame number; NaN for frames without one
   * \throws BadInputException if the file of a frame is missing or invalid, or no pose
   * is finite */
  StoredTrajectory takePoseFiles();

  /** \brief The camera of the undistorted frames, with the size of the first image;
   * its baseline of 1 m is ignored. */
  const StereoCamera&
  camera() const
  {
    return undistorter_->camera();
  }

  /** \brief Whether frames are undistorted. Labels of their pixels have to be of the
   * undistorted images. */
  bool
  isDistorted() const
  {
    return undistorter_->isDistorted();
  }

  /** \brief Doubts, one per line, for a program to print: about the camera's file, and
   * a depth scale that makes the depths of the first frames implausible. Reads depth
   * images until one has depths. */
  std::vector<std::string> doubts() const;

  /** \brief Reads the i-th frame.
   * \param[in] max_depth of the points of its cloud [m]; 0 = unlimited
   * \throws InvalidParameterException if the frame does not exist or max_depth is
   * negative
   * \throws BadInputException if an image cannot be read or has another size */
  RgbdFrame frame(std::size_t i, double max_depth = 0.0) const;

private:
  struct Files {
    std::string name, colour, depth, pose;
    double time = 0.0; // [s]
    int number = 0;
  };

  RgbdSequence(const std::string& folder, double depth_scale, double depth_within);

  std::string poses_;
  PoseFrame pose_frame_ = PoseFrame::camera;
  std::optional<Undistorter> undistorter_; ///< none for colourImages()
  std::vector<std::string> doubts_;
  double depth_scale_;
  bool is_tum_ = false, has_times_ = false;
  std::vector<Files> frames_;
};

} // namespace pcl_semantic
