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
  /// Further files for evaluation, with commas between them: measured, depth,
  /// probabilities, scans; see ExtraOptions.
  std::string also;
  double scan_within = 0.0; ///< ExtraOptions::within [m]
  bool images = true;       ///< of the frames, if a camera takes them
  bool centres = false;     ///< ExtraOptions::centres
  NamedValues summary;      ///< further inputs that the summary lists
};

/** \brief Follows a map run. */
class MapRunObserver {
public:
  virtual ~MapRunObserver() = default;

  /** \brief Whether the run ends before the next frame. */
  virtual bool
  isInterrupted()
  {
    return false;
  }

  /** \brief Whether MappingOutput::writeLive() is to be called after this frame. */
  virtual bool
  isWatched()
  {
    return false;
  }

  /** \brief A frame was read, and is mapped next. */
  virtual void
  onFrame(const SensorFrame& /*frame*/)
  {}

  /** \brief The frame is in the map. */
  virtual void
  onMapped(const SensorFrame& /*frame*/, const MappedFrame& /*mapped*/)
  {}

  /** \brief A doubt about the inputs or the map, in one line. */
  virtual void
  onDoubt(const std::string& /*doubt*/)
  {}

  /** \brief A step that is of interest if something goes wrong, in one line. */
  virtual void
  onNote(const std::string& /*note*/)
  {}
};

/** \brief Makes one map of the frames of a source: mapper, archive and output files. */
class MapRun {
public:
  /** \param[in] inputs as openInputs() has opened them
   * \param[in] config its values are valid
   * \param[in] observer null = none; has to live as long as the run
   * \throws InvalidParameterException if outputs do not fit the inputs
   * \throws BadInputException before anything is written, if a frame lacks a pose or
   * stored labels */
  MapRun(OpenedInputs inputs, const MapperConfig& config, MapOutputs outputs = {},
         MapRunObserver* observer = nullptr);

  ~MapRun();

  /** \brief Everything that the map depends on. */
  const MappingRun&
  description() const
  {
    return run_;
  }

  /** \brief Whether the archive exists and holds the finished map of these inputs:
   * reads all frames and compares them. Removes the archive of another run, or a
   * damaged one. \return also false if it holds a part of that map \throws
   * OutputException if it cannot be removed */
  bool isMade();

  /** \brief Labels frames in a thread of its own, see LateLabels; before run(). */
  void
  labelLate()
  {
    labels_late_ = true;
  }

  /** \brief Maps the frames until their end or an interrupt and writes the outputs. An
   * error after the first live frame ends the run, but not without the map so far.
   * \throws BadInputException, BadModelException, OutputException */
  void run();

  /** \brief After run(). */
  const SemanticVoxelMap&
  map() const
  {
    return mapper_->map();
  }

  /** \brief Frames that the archive held already. */
  std::size_t
  framesBefore() const
  {
    return frames_before_;
  }

  /** \brief Frames that run() has mapped. */
  std::size_t
  framesMapped() const
  {
    return frames_mapped_;
  }

  /** \brief Frames whose labels came late and are in the map. */
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
  const PoseSource* poses_ = nullptr; // that the mapper has
  std::unique_ptr<SemanticMapper> mapper_;
  std::optional<LateLabels> late_labels_;
  std::size_t frames_before_ = 0, frames_mapped_ = 0;
  bool is_empty_ = true; // the map
  std::optional<Eigen::Vector3d> last_position_;
  bool has_doubted_distance_ = false;
};

/** \brief Removes an archive and the files that SQLite has put beside it, if they
 * exist. \throws OutputException */
void removeArchive(const std::string& path);

} // namespace pcl_semantic
