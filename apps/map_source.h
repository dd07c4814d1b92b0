// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cloud_doubts.h"
#include "map_arguments.h"
#include "messages.h"

#include <pcl_semantic/images/sensor_frame.h>
#include <pcl_semantic/labelling/label_calibration.h>
#include <pcl_semantic/labelling/label_predictor.h>
#include <pcl_semantic/odometry/pose_source.h>
#include <pcl_semantic/pipeline/mapping_output.h>
#include <pcl_semantic/pipeline/run_description.h>
#include <pcl_semantic/pipeline/semantic_mapper.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace pcl_semantic::tool {

/** \brief Where the frames of a map come from: stereo or RGB-D images, or labelled
 * clouds. */
class MapSource {
public:
  virtual ~MapSource() = default;

  /** \brief The inputs of the map. */
  const MappingRun&
  run() const
  {
    return run_;
  }

  /** \brief The output that --also asks for. */
  const ExtraOptions&
  extras() const
  {
    return extras_;
  }

  /** \brief The frames that will be mapped, as `run().frames`; none if that is not
   * known, of a live camera. */
  virtual std::vector<FrameTime> times() const = 0;

  /** \param[out] doubts of the file of poses, a line each, are added to it */
  virtual std::unique_ptr<PoseSource>
  openPoses(std::vector<std::string>& doubts) const = 0;

  /** \brief Once. \throws InvalidParameterException if the parameters do not fit */
  std::unique_ptr<SemanticMapper> makeMapper(std::unique_ptr<PoseSource> poses,
                                             std::shared_ptr<BlockStore> store);

  /** \brief Reads the next frame; none at the end.
   * \throws BadInputException that names the file */
  virtual std::optional<SensorFrame> next() = 0;

  /** \brief Leaves out the first frames, which are mapped already; before makeMapper().
   * \param[in] mapped their records, which are compared with what is there now
   * \throws BadInputException if a frame is not what it was */
  virtual void skip(const std::vector<FrameRecord>& mapped) = 0;

  /** \brief Figures of the frames that were read, for the results. */
  virtual Results
  figures() const
  {
    return {};
  }

  /** \brief Compares all frames that are mapped already with what is there now; before
   * makeMapper(). \return the first difference, for a message; empty if there is none
   * \throws BadInputException if a frame cannot be read */
  virtual std::string
  changeSince(const std::vector<FrameRecord>& mapped)
  {
    return mapped.empty() ? "" : "its frames are not kept";
  }

protected:
  using Inputs = std::vector<std::pair<std::string, std::string>>;

  /** \brief Takes from the arguments what all sources have. */
  explicit MapSource(const MapArguments& arguments);

  /** \brief Sets run_.inputs: those of the sequence, \a more, and the calibrations. */
  void setInputs(const Inputs& more);

  /** \brief Reads the calibrations that are given, for run_.label_set. */
  void readCalibrations();

  MapArguments arguments_;
  MappingRun run_;
  ExtraOptions extras_;
  std::unique_ptr<LabelPredictor> predictor_; ///< for the mapper; null: clouds
  MappingWatch watch_of_mapping_;

private:
  std::optional<LabelCalibration> label_calibration_, clique_calibration_;
};

/** \brief Opens the sequence or the clouds that the arguments name.
 *
 * Of clouds, `--sensor` says what took them: "own", any sensor whose own poses in a
 * world with z up are given; "camera" or "grey", the left camera of a calibrated pair,
 * and "laser", the scanner of KITTI's `Tr`, with the poses of camera 0.
 * \throws InvalidParameterException, BadInputException, BadModelException */
std::unique_ptr<MapSource> openMapSource(const MapArguments& arguments);

} // namespace pcl_semantic::tool
