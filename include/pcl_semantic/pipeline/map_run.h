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

/** \brief The files that a map run writes. */
struct MapOutputs {
  std::string folder; ///< for MappingOutput; empty = none
  MappingArchive::Options archive;
  /// Additional files for evaluation, separated by commas: measured, depth,
  /// probabilities, scans; see ExtraOptions.
  std::string also;
  /// Radius to search for the voxel nearest to a point of a scan [m], 0 to 2.
  double scan_within = 0.0;
  bool images = true;   ///< write images of the frames, if they are from a camera
  bool centres = false; ///< the points of the map are voxel centres
  NamedValues summary;  ///< additional inputs listed in the summary
};

/** \brief Observes a map run. The run calls all functions in the thread of its caller.
 */
class MapRunObserver {
public:
  virtual ~MapRunObserver() = default;

  /** \brief Whether the run should end now. Called before each frame. */
  virtual bool
  isInterrupted()
  {
    return false;
  }

  /** \brief Whether the run should write the current map for viewers, see
   * MappingOutput::writeLive(). Called after each frame. */
  virtual bool
  isWatched()
  {
    return false;
  }

  /** \brief Called before the first frame.
   * \param[in] frames number of frames to map, without those of a resumed archive; 0 =
   * unknown */
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

  /** \brief Called with a doubt: a warning about the inputs or the map, in one line. */
  virtual void
  onDoubt(const std::string& /*doubt*/)
  {}

  /** \brief Called with a note for a log, in one line. */
  virtual void
  onNote(const std::string& /*note*/)
  {}
};

/** \brief Makes one map from the frames of a source and writes its archive and files.
 */
class MapRun {
public:
  /** \param[in] inputs result of openInputs()
   * \param[in] config parameters of the mapper
   * \param[in] observer null = none; must outlive the run
   * \throws InvalidParameterException if a parameter is out of range, an output is
   * unknown, or an output needs images, scans or stored poses that the inputs lack
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

  /** \brief Whether the archive contains the finished map of these inputs.
   *
   * Reads all frames and compares them with the archive. Removes an archive that is
   * damaged or contains the map of another run. Keeps an unfinished archive of this
   * run, for run() to resume.
   * \throws BadInputException if a frame cannot be read
   * \throws OutputException if the archive cannot be removed */
  bool isMade();

  /** \brief Labels the frames in a separate thread, see LateLabels. Must be called
   * before run(). */
  void
  labelLate()
  {
    labels_late_ = true;
  }

  /** \brief Maps the frames until their end or an interrupt and writes the outputs.
   *
   * If a live source fails after its first frame, the outputs are written for the
   * mapped frames, and the error is thrown afterwards.
   * \throws BadInputException if a frame or label cannot be read, or no frame could be
   * tracked
   * \throws BadInputException if the frames of a resumed archive have changed
   * \throws BadModelException if the network fails
   * \throws OutputException if an output cannot be written */
  void run();

  /** \brief The map; valid after run(). */
  const SemanticVoxelMap&
  map() const
  {
    return mapper_->map();
  }

  /** \brief The objects of the map, valid after run(); null without objects. */
  const ObjectTracker*
  objects() const
  {
    return mapper_->objects();
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

  void fitWindow();

  void doubtWindow(const MappedFrame& mapped);

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
  bool has_points_ = false;
  std::optional<Eigen::Vector3d> last_position_;
  bool has_doubted_distance_ = false;
  std::optional<double> fitted_reach_; // of the window around the sensor [m]
};

/** \brief Removes an archive and the log files that SQLite keeps beside it, if they
 * exist.
 * \throws OutputException if a file cannot be removed */
void removeArchive(const std::string& path);

} // namespace pcl_semantic
