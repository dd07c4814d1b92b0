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

/** \brief Additional output of a run, for evaluation. */
struct ExtraOptions {
  bool images = true;         ///< images of each frame, if it is from a camera
  bool centres = false;       ///< use voxel centres as points of the map
  bool measured = false;      ///< labels of the fused measurements, before the CRF
  bool depth = false;         ///< measured depth of the pixels, and the labels of the
                              ///< finished map there
  bool probabilities = false; ///< class probabilities for the labels in labels_at_depth
  /// Points of a frame's scan to label, in the frame of the sensor of the poses [m];
  /// null = no scans. May throw BadInputException.
  std::function<std::vector<Eigen::Vector3d>(int frame)> scan;
  double within = 0.0; ///< radius to search for a point's nearest voxel [m]
};

class ExtraOutput;
class FolderLock;

/** \brief Writes the result of mapping a sequence to a folder: images and label images
 * per frame, and the map and its summary at the end (see the README). */
class MappingOutput {
public:
  /** \brief Creates the folders. Files of an earlier run are kept until the first frame
   * is written. Then a finished map is moved to `previous` until the new one is
   * complete.
   *
   * \param[in] run mapped inputs; without a camera there are no images. The summary
   * lists the inputs
   * \param[in] records of the frames already in the map of a resumed run; images of
   * other frames are removed when the first frame is written
   * \param[in] extra additional output
   *
   * \throws InvalidParameterException if \a extra requests measured labels, depth or
   * probabilities, but no images
   * \throws BadInputException if images of these frames are missing
   * \throws OutputException also if the folder contains images of no run, or another
   * run writes to it */
  MappingOutput(const std::string& folder, const MappingRun& run,
                std::vector<FrameRecord> records = {}, ExtraOptions extra = {});

  ~MappingOutput();

  /** \brief Names of the files and folders in the output folder. */
  static const std::vector<std::string>& names();

  /** \brief Writes labels, labels_at_depth, network_labels and overlay of a frame, if
   * images are enabled.
   * \throws OutputException if a file cannot be written */
  void writeFrame(const MappedFrame& mapped, const SemanticVoxelMap& map);

  /** \brief Writes the current map around the sensor for viewers: `live`, a separate
   * map folder (map.pcd, label_set.yaml, trajectory.txt, and summary.json last) that
   * exists until finish(). Its points are centres if those of the final map will be.
   * Call it after writeFrame().
   * \throws OutputException if a file cannot be written */
  void writeLive(const MappedFrame& mapped) const;

  /** \brief Writes map.pcd, map_classes.pcd, label_set.yaml, final_labels,
   * top_view.png, trajectory.txt, summary.json and, with objects, objects.json and
   * boxes.ply.
   * \param[in] objects of the map; null = none
   * \param[in] is_whole false if an error has ended the run: the summary then marks it
   * as unfinished, and an earlier map stays in `previous`
   * \throws OutputException if a file cannot be written */
  void finish(const SemanticVoxelMap& map, const ObjectTracker* objects = nullptr,
              bool is_whole = true);

  /** \brief Median of domainShift() over the frames: their distance from the training
   * data of the label calibration. NaN = unknown. */
  double domainShift() const;

private:
  std::string path(const std::string& name) const;

  void writeImages(const MappedFrame& mapped, const SemanticVoxelMap& map) const;

  void writeFinalImages(const VoxelCloud& voxels) const;

  void writeThings(const std::vector<ObjectSummary>& objects) const;

  void refuseForeignImages() const;

  void requireImages() const;

  void replaceEarlierRun();

  Trajectory trajectory() const;

  void writeSummary(const VoxelCloud& voxels, bool is_whole) const;

  std::string folder_;
  MappingRun run_;
  std::vector<FrameRecord> frames_;
  bool has_images_; // writes images of the frames
  bool centres_;
  std::unique_ptr<ExtraOutput> extra_;
  std::unique_ptr<FolderLock> lock_;
  bool replaced_ = false; // files of an earlier run are removed
};

} // namespace pcl_semantic
