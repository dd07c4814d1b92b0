// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "map_arguments.h"

#include <pcl_semantic/core/sensor_frame.h>
#include <pcl_semantic/dataset/frame_sequence.h>
#include <pcl_semantic/labelling/label_calibration.h>
#include <pcl_semantic/labelling/label_predictor.h>
#include <pcl_semantic/odometry/pose_source.h>
#include <pcl_semantic/odometry/stereo_odometry.h>
#include <pcl_semantic/pipeline/mapping_output.h>
#include <pcl_semantic/pipeline/run_description.h>
#include <pcl_semantic/pipeline/semantic_mapper.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace pcl_semantic::tool {

/** \brief What --also asks for.
 * \param[in] sequence null for clouds, which have no scans beside them
 * \throws InvalidParameterException at a word that it does not know, or a value of
 * --scan-within that makes no sense
 * \throws BadInputException if a frame has no scan, or nobody knows the scanner's pose
 */
ExtraOptions makeExtras(const MapArguments& arguments, const FrameSequence* sequence,
                        const std::vector<std::size_t>& frames);

/** \brief Where the labels of a run come from. */
struct Labelling {
  LabelSet label_set;
  std::unique_ptr<LabelPredictor> predictor;
  std::string model; ///< path; empty without a network
};

/** \throws BadInputException, BadModelException */
Labelling makeLabelling(const MapArguments& arguments);

/** \brief What labels and cliques are worth, as far as it is given. */
struct Calibrations {
  std::optional<LabelCalibration> labels, cliques;
};

/** \throws BadInputException */
Calibrations readCalibrations(const MapArguments& arguments, const LabelSet& label_set);

void setCalibrations(const Calibrations& calibrations, SemanticMapper& mapper);

/** \brief Where the poses of a run come from: the path of a trajectory, or "odometry".
 * \throws BadInputException if the sequence shall have a trajectory and has none
 * \throws InvalidParameterException if the run is archived and has no trajectory */
std::string choosePoses(const MapArguments& arguments, const FrameSequence& sequence);

/** \brief Opens what choosePoses() has chosen. */
std::unique_ptr<PoseSource> makePoses(const std::string& chosen,
                                      const FrameSequence& sequence);

/** \brief Where the frames of a map come from: stereo images or labelled clouds. */
class MapSource {
public:
  virtual ~MapSource() = default;

  /** \brief What the map depends on. */
  const MappingRun&
  run() const
  {
    return run_;
  }

  /** \brief Path of the trajectory, or "odometry". */
  const std::string&
  poses() const
  {
    return poses_;
  }

  /** \brief The frames that are mapped, as `run().frames`. */
  virtual std::vector<FrameTime> times() const = 0;

  virtual std::unique_ptr<PoseSource> openPoses() const = 0;

  /** \brief Once. \throws InvalidParameterException if the parameters do not fit */
  std::unique_ptr<SemanticMapper> makeMapper(std::unique_ptr<PoseSource> poses,
                                             std::shared_ptr<BlockStore> store);

  /** \brief What --also asks for. */
  const ExtraOptions&
  extras() const
  {
    return extras_;
  }

  /** \brief Reads the next frame; none at the end.
   * \throws BadInputException that names the file */
  virtual std::optional<SensorFrame> next() = 0;

  /** \brief Leaves out the next frames, which are mapped already. */
  void
  skip(std::size_t count)
  {
    next_ += count;
  }

protected:
  MappingRun run_;
  std::string poses_;
  ExtraOptions extras_;
  Calibrations calibrations_;
  std::unique_ptr<LabelPredictor>
      predictor_;        // for the mapper; null if frames are clouds
  std::size_t next_ = 0; // of the frames
};

/** \brief Opens the sequence or the clouds that the arguments name.
 * \throws InvalidParameterException, BadInputException, BadModelException */
std::unique_ptr<MapSource> openMapSource(const MapArguments& arguments);

/** \brief Of an RGB-D sequence, whose images are labelled as those of pairs are. */
std::unique_ptr<MapSource> openRgbdSource(const MapArguments& arguments);

/** \brief Of labelled clouds.
 *
 * `--sensor` says what took them: "own", any sensor whose own poses in a world with z
 * up are given; "camera" or "grey", the left camera of a calibrated pair, and "laser",
 * the scanner of KITTI's `Tr`, with the poses of camera 0. */
std::unique_ptr<MapSource> openCloudSource(const MapArguments& arguments);

} // namespace pcl_semantic::tool
