// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/files/trajectory_file.h>
#include <pcl_semantic/pipeline/run_description.h>

#include <Eigen/Core>

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Output of a run beside the map, for evaluation. */
struct ExtraOptions {
  bool images = true;         ///< of each frame, if a camera takes them
  bool centres = false;       ///< the points of the map are the centres of its voxels
  bool measured = false;      ///< labels of the fused measurements, before the CRF
  bool depth = false;         ///< measured depth of the pixels
  bool probabilities = false; ///< of the classes, where labels_at_depth has labels
  /// Points of a frame's scan, which is to be labelled, in the frame of the sensor
  /// whose poses the map has [m]; null = no scans. May throw BadInputException.
  std::function<std::vector<Eigen::Vector3d>(int frame)> scan;
  double within = 0.0; ///< also: a point takes the nearest voxel so far away [m]
};

class ExtraOutput;
class FolderLock;

/** \brief Writes what mapping a sequence leaves behind into a folder: pictures and
 * label images a frame, the map and its summary at the end (README, "What it writes").
 */
class MappingOutput {
public:
  /** \brief Makes the folders. What an earlier run left in them stays until the first
   * frame is written; a finished map then lies in `previous` until the new one is
   * whole.
   *
   * \param[in] run what is mapped; without a camera there are no images. Its inputs
   * go to the summary
   * \param[in] records of the frames that are in the map already, of a run that goes
   * on: images of others are removed with the first frame that is written
   * \param[in] extra what is written beside the map
   *
   * \throws InvalidParameterException if \a extra asks for measured labels, depth or
   * probabilities, but not for images
   * \throws BadInputException if images of those frames are missing
   * \throws OutputException also if images lie there that no run of ours has left, or
   * another run is writing there */
  MappingOutput(const std::string& folder, const MappingRun& run,
                std::vector<FrameRecord> records = {}, ExtraOptions extra = {});

  ~MappingOutput();

  /** \brief Names of the files and folders in the output folder. */
  static const std::vector<std::string>& names();

  /** \brief labels, labels_at_depth, network_labels and overlay of a frame, if there
   * are images.
   * \throws OutputException */
  void writeFrame(const MappedFrame& mapped, const SemanticVoxelMap& map);

  /** \brief The map as it is around the sensor now, for programs that look on while it
   * is made: `live`, a map folder of its own (map.pcd, label_set.yaml, trajectory.txt,
   * summary.json, which is written last), until finish(). Its points are centres if
   * those of the map will be. After writeFrame(). \throws OutputException */
  void writeLive(const MappedFrame& mapped) const;

  /** \brief map.pcd, map_classes.pcd, label_set.yaml, final_labels, top_view.png,
   * trajectory.txt, summary.json.
   * \param[in] is_whole false if an error has ended the run: the summary then says
   * that it is not finished, and an earlier map stays in `previous`
   * \throws OutputException */
  void finish(const SemanticVoxelMap& map, bool is_whole = true);

  /** \brief How far the frames are from what their label calibration was learned from,
   * the median of domainShift(); NaN = not known. */
  double domainShift() const;

private:
  std::string path(const std::string& name) const;

  void writeImages(const MappedFrame& mapped, const SemanticVoxelMap& map) const;

  void writeFinalImages(const VoxelCloud& voxels) const;

  void refuseForeignImages() const;

  void requireImages() const;

  void replaceEarlierRun();

  Trajectory trajectory() const;

  void writeSummary(const VoxelCloud& voxels, bool is_whole) const;

  std::string folder_;
  MappingRun run_;
  std::vector<FrameRecord> frames_;
  bool has_images_; // of the frames
  bool centres_;
  std::unique_ptr<ExtraOutput> extra_;
  std::unique_ptr<FolderLock> lock_;
  bool replaced_ = false; // an earlier run's files are gone
};

} // namespace pcl_semantic
