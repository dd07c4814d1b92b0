// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/dataset/frame_source.h>
#include <pcl_semantic/dataset/sequence_files.h>
#include <pcl_semantic/labelling/label_calibration.h>
#include <pcl_semantic/labelling/label_predictor.h>
#include <pcl_semantic/labelling/opened_network.h>
#include <pcl_semantic/odometry/pose_source.h>
#include <pcl_semantic/pipeline/map_inputs.h>
#include <pcl_semantic/pipeline/mapper_config.h>

#include <Eigen/Core>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Functions to open inputs, which a program may replace. */
struct InputOpeners {
  std::function<OpenedNetwork(const std::string& description, const std::string& model,
                              const std::string& engine)>
      network = openNetwork;
  VideoOpener videos; ///< null = videos are refused
  /// If set, opens the sequence as live frames, after labels and trajectory.
  std::function<std::unique_ptr<FrameSource>(const MapInputs&)> live;
};

/** \brief Returns the points of a frame's scan, in the frame of the sensor of the poses
 * [m]. */
using ScanReader = std::function<std::vector<Eigen::Vector3d>(int frame)>;

/** \brief The inputs of a map, opened. */
struct OpenedInputs {
  std::unique_ptr<FrameSource> source;
  std::unique_ptr<PoseSource> poses;
  LabelSet label_set;
  std::unique_ptr<LabelPredictor> predictor; ///< null: labels are part of the clouds
  bool labels_are_stored = true;             ///< false: from a network
  bool has_labels = true;    ///< false: the map has depth and colour alone
  bool has_odometry = false; ///< poses are estimated from the images
  std::optional<LabelCalibration> label_calibration;
  std::string name;                       ///< for messages
  NamedValues values;                     ///< all that affects the map, for its archive
  std::function<ScanReader()> scans;      ///< opens the scans; null = none
  std::optional<LabelMapping> mapping;    ///< its copies count the numbers it lacks
  std::string mapping_name, mapping_unit; ///< for textOfLacking()
  std::vector<std::string> doubts;        ///< one per line
};

/** \brief Opens the poses of a stereo or RGB-D source, or of clouds in camera 0.
 * \param[in] trajectory path; empty = odometry
 * \param[in] pose_gap see StoredPoses [s]
 * \param[in,out] opened its source must be open
 * \throws BadInputException as readPoses() */
void openPoses(const std::string& trajectory, OpenedInputs& opened,
               double pose_gap = StoredPoses::default_gap);

/** \brief Opens the inputs of a map.
 * \param[in] config only network_every and label_confidence are used
 * \throws InvalidParameterException if inputs contradict each other or are out of range
 * \throws BadInputException if a file cannot be read or is invalid
 * \throws BadModelException if the network cannot be used */
OpenedInputs openInputs(const MapInputs& inputs, const MapperConfig& config,
                        const InputOpeners& openers = {});

} // namespace pcl_semantic
