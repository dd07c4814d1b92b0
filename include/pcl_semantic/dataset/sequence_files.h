// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/config_parameter.h>
#include <pcl_semantic/core/export.h>
#include <pcl_semantic/dataset/frame_sequence.h>
#include <pcl_semantic/dataset/image_pair_sequence.h>

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Names of inputs and their values: ("sequence", "kitti/05"). */
using NamedValues = std::vector<std::pair<std::string, std::string>>;

/** \brief The files of a stereo sequence: a folder in KITTI's layout, or the images of
 * any stereo camera. */
struct SequenceFiles {
  /// In the layout of KITTI's odometry benchmark, or of
  /// - EuRoC (ASL): `mav0/cam0` and `cam1`, each with `data` and `sensor.yaml`. Its
  ///   poses are not read: they are those of the body;
  /// - Middlebury and ETH3D: one pair, `im0.png`, `im1.png` and `calib.txt`;
  /// - KITTI-360: `image_00/data_rect` and `image_01/data_rect`, with the calibration
  /// in
  ///   `../../calibration/perspective.txt`.
  std::string folder;
  ImagePairFiles files;
  bool strict = false; ///< refuse suspicious pairs, see checkPair()

  /** \brief Whether a file of a stereo camera is given. */
  bool hasFiles() const;

  /** \brief The folder, or the pattern of the left images, for messages. */
  const std::string& name() const;

  /** \brief \throws InvalidParameterException if a file is missing, or a folder is
   * combined with files */
  void validate() const;

  /** \brief The given files. */
  NamedValues inputs() const;
};

/** \brief Parameters `sequence`, `left`, `right`, `calibration`, `extrinsics`, `times`,
 * `strict`. */
ConfigParameters parametersOf(SequenceFiles& files);

/** \brief Opens two videos as a sequence. */
using VideoOpener =
    std::function<std::unique_ptr<FrameSequence>(const ImagePairFiles&)>;

/** \brief Opens a sequence.
 * \param[in] open_videos null = videos are refused
 * \param[out] doubts lines about the calibration are appended
 * \throws BadInputException, InvalidParameterException for refused videos */
std::unique_ptr<FrameSequence> openSequence(const SequenceFiles& files,
                                            std::vector<std::string>& doubts,
                                            const VideoOpener& open_videos = nullptr);

} // namespace pcl_semantic
