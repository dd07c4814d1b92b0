// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/images/sensor_frame.h>
#include <pcl_semantic/pipeline/late_labels.h>
#include <pcl_semantic/pipeline/mapping_archive.h>
#include <pcl_semantic/pipeline/mapping_output.h>
#include <pcl_semantic/pipeline/opened_inputs.h>
#include <pcl_semantic/pipeline/run_description.h>
#include <pcl_semantic/pipeline/semantic_mapper.h>

#include <Eigen/Core>

#include <cstddef>
#include <memory>
#include <optional>
#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief The outputs of a map run. */
struct MapOutputs {
  std::string folder; ///< of MappingOutput; empty = none
  MappingArchive::Options archive;
  /// Additional files for evaluation, separated by commas: measured, depth,
  /// probabilities, scans; see ExtraOptions.
  std::string also;
  double scan_within = 0.0; ///< ExtraOptions::within [m]
  bool images = true;       ///< write images of the frames, if they are from a camera
  bool centres = false;     ///< ExtraOptions::centres
  NamedValues summary;      ///< additional inputs listed in the summary
};

/** \brief Observes a map run. */
class MapRunObserver {
public:
  virtual ~MapRunObserver() = default;

  /** \brief Whether to end the run before the next frame. */
  virtual bool
  isInterrupted()
  {
    return false;
  }

  /** \brief Whether to call MappingOutput::writeLive() after this frame. */
  virtual bool
  isWatched()
  {
    return false;
  }

  /** \brief Called before the first frame. \param[in] frames to map; 0 = unknown */
  virtual void
  onBegin(std::size_t /*frames*/)
  {}

  /** \brief Called after reading a frame, before mapping it. */
  virtual void
  onFrame(const SensorFrame& /*frame*/)
  {}

  /** \brief Called after a frame was added to the map. */
  virtual void
  onMapped(const SensorFrame& /*frame*/, const MappedFrame& /*mapped*/)
  {}

  /** \brief Called with a doubt about the inputs or the map, in one line. */
  virtual void
  onDoubt(const std::string& /*doubt*/)
  {}

  /** \brief Called with the current step, in one line, to help find errors. */
  virtual void
  onNote(const std::string& /*note*/)
  {}
};

/** \brief Makes one map from the frames of a source: mapper, archive and output
 * files. */
class MapRun {
public:
  /** \param[in] inputs result of openInputs()
   * \param[in] config must be valid
   * \param[in] observer null = none; must outlive the run
   * \throws InvalidParameterException if outputs do not fit the inputs
   * \throws BadInputException before any output, if a frame lacks a pose or stored
   * labels */
  MapRun(OpenedInputs inputs, const MapperConfig& config, MapOutputs outputs = {},
         MapRunObserver* observer = nullptr);

  ~MapRun();

  /** \brief All inputs and parameters that affect the map. */
  const MappingRun&
  description() const
  {
    return run_;
  }

  /** \brief Whether the archive exists and contains the finished map of these inputs.
   * Reads and compares all frames. Removes a damaged archive or one of another run.
   * \return also false if the archive contains a part of the map
   * \throws OutputException if it cannot be removed */
  bool isMade();

  /** \brief Labels frames in a separate thread, see LateLabels. Call it before
   * run(). */
  void
  labelLate()
  {
    labels_late_ = true;
  }

  /** \brief Maps the frames until their end or an interrupt and writes the outputs.
   * After an error in a live source, the outputs contain the map of the previous
   * frames.
   * \throws BadInputException, BadModelException, OutputException */
  void run();

  /** \brief The map; valid after run(). */
  const SemanticVoxelMap&
  map() const
  {
    return mapper_->map();
  }

  /** \brief Number of frames in the archive before the run. */
  std::size_t
  framesBefore() const
  {
    return frames_before_;
  }

  /** \brief Number of frames with late labels in the map. */
  int
  framesLabelledLate() const
  {
    return late_labels_ ? late_labels_->frames() : 0;
  }

private:
  bool isLive() const;

  void doubt(const std::string& text);

  void doubtMapping();

  void doubtDistance(const MappedFrame& mapped);

  void doubtTracking();

  void requireLabels() const;

  void setExtras();

  std::string changeSince(const std::vector<FrameRecord>& mapped);

  std::string changeOf(std::size_t i, const FrameRecord& mapped);

  void makeMapper(std::shared_ptr<BlockStore> store);

  void mapFrames(MappingArchive& archive, MappingOutput* output);

  void finish(MappingArchive& archive, MappingOutput* output, bool is_whole);

  MapRunObserver no_observer_;
  MapRunObserver& observer_;
  OpenedInputs inputs_;
  MapOutputs outputs_;
  MappingRun run_;
  ExtraOptions extras_;
  bool labels_late_ = false;
  const PoseSource* poses_ = nullptr; // owned by the mapper
  std::unique_ptr<SemanticMapper> mapper_;
  std::optional<LateLabels> late_labels_;
  std::size_t frames_before_ = 0, frames_mapped_ = 0;
  bool is_empty_ = true; // the map
  std::optional<Eigen::Vector3d> last_position_;
  bool has_doubted_distance_ = false;
};

/** \brief Removes an archive and SQLite's files beside it, if they exist.
 * \throws OutputException */
void removeArchive(const std::string& path);

} // namespace pcl_semantic
