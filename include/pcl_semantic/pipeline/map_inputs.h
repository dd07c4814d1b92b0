// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/config_parameter.h>
#include <pcl_semantic/core/export.h>
#include <pcl_semantic/dataset/rgbd_sequence.h>
#include <pcl_semantic/dataset/sequence_files.h>
#include <pcl_semantic/files/stored_poses.h>
#include <pcl_semantic/pipeline/mapper_config.h>

#include <set>
#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief The inputs of a map: a stereo sequence, an RGB-D sequence or clouds, with
 * labels and poses. See doc/map.md. */
struct MapInputs {
  SequenceFiles sequence;
  /// Folder or pattern of clouds instead of the sequence, see CloudSequence.
  std::string clouds;
  RgbdFiles rgbd; ///< RGB-D sequence, instead of the sequence
  /// Sensor of the clouds: `own` (any), `camera` or `grey` (left camera of KITTI's
  /// colour or grey pair) or `laser` (KITTI's Tr). Empty = own, or camera with a
  /// calibration.
  std::string sensor;
  std::string scan_columns; ///< columns of `.bin` clouds, see parseScanColumns()
  std::string labels;       ///< folder, see StoredPredictor
  std::string label_set;    ///< file of the classes (.yaml); empty = KITTI's 11 classes
  /// Mapping from the numbers in label files to labels; empty = the numbers are labels.
  std::string label_mapping;
  std::string network;           ///< description (.yaml), instead of labels
  std::string model;             ///< network (.onnx); empty = from the description
  std::string engine;            ///< engine of the network, see parseEngine()
  std::string label_calibration; ///< see readCalibration()
  /// Source of the poses: a trajectory file; `sequence` (the sequence's trajectory);
  /// `odometry`; `viewpoint` (the viewpoint in each cloud's file); or `auto`.
  /// `auto` uses the sequence's trajectory if it exists, else odometry.
  std::string poses = "auto";
  /// Maximum gap between two timed poses that are interpolated [s], see StoredPoses.
  double pose_gap = StoredPoses::default_gap;
  std::string frames = ":"; ///< see parseFrameRange()
  bool reads_scans = false; ///< also read scans beside the images of a sequence
  /// Names of the options and parameters that the user has set, with dashes.
  /// validate() refuses those without an effect.
  std::set<std::string> given;

  /** \brief The sensor of the clouds: \a sensor, or its default. */
  std::string cloudSensor() const;

  /** \brief Whether the images have labels, or a network. */
  bool hasImageLabels() const;

  /** \brief Whether the frames are from a camera. */
  bool hasCamera() const;

  /** \brief Path of the RGB-D sequence, the clouds or the sequence, for messages. */
  const std::string& name() const;

  /** \brief Checks that the inputs are complete and consistent.
   * \throws InvalidParameterException that names the options, if an input is missing,
   * contradicts another one or has no effect */
  void validate(const MapperConfig& config) const;
};

/** \brief The inputs with the names that they have as options and in fleet plans. */
ConfigParameters parametersOf(MapInputs& inputs);

} // namespace pcl_semantic
