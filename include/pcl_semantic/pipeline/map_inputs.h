// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/config_parameter.h>
#include <pcl_semantic/core/export.h>
#include <pcl_semantic/dataset/sequence_files.h>
#include <pcl_semantic/pipeline/mapper_config.h>

#include <set>
#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief The inputs of a map: a stereo sequence, an RGB-D sequence or clouds, with
 * labels and poses. See doc/map.md. */
struct MapInputs {
  SequenceFiles sequence;
  std::string clouds;       ///< instead of the sequence: folder or pattern, see
                            ///< CloudSequence
  std::string rgbd;         ///< instead of the sequence: folder of an RgbdSequence
  double depth_scale = 0.0; ///< of the RGB-D sequence; 0 = default of its layout
  std::string sensor;       ///< of the clouds: own, camera, grey or laser; empty = own,
                            ///< or camera with a calibration
  std::string scan_columns; ///< of `.bin` clouds, see parseScanColumns()
  std::string labels;       ///< folder, see StoredPredictor
  std::string label_set;    ///< of labels or clouds (.yaml); empty = KITTI's 11 classes
  std::string label_mapping; ///< of their numbers; empty = they are labels
  std::string network;       ///< description (.yaml), instead of labels
  std::string model;         ///< network (.onnx); empty = from the description
  std::string engine;        ///< see parseEngine()
  std::string label_calibration, clique_calibration; ///< see readCalibration()
  /// Trajectory file, or `sequence` (the sequence's trajectory), `odometry`,
  /// `viewpoint` (of the clouds), or `auto`: the sequence's trajectory if it exists,
  /// else odometry.
  std::string poses = "auto";
  std::string frames = ":"; ///< see parseFrameRange()
  bool reads_scans = false; ///< also read scans beside the images of a sequence
  /// Options and parameters from the user, with dashes. Each must have an effect.
  std::set<std::string> given;

  /** \brief The sensor of the clouds: \a sensor, or its default. */
  std::string cloudSensor() const;

  /** \brief Whether the frames are from a camera. */
  bool hasCamera() const;

  /** \brief Name of the frames, for messages. */
  const std::string& name() const;

  /** \brief Checks for missing and contradictory inputs.
   * \throws InvalidParameterException */
  void validate(const MapperConfig& config) const;
};

/** \brief The inputs, named as options and in fleet plans. */
ConfigParameters parametersOf(MapInputs& inputs);

} // namespace pcl_semantic
