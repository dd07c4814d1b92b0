// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/evaluation/voxel_lookup.h>
#include <pcl_semantic/pipeline/mapping_output.h>
#include <pcl_semantic/pipeline/semantic_mapper.h>

#include <optional>
#include <string>
#include <vector>

namespace pcl_semantic {

/** \brief Writes what ExtraOptions ask for, into folders of its own beside those of
 * MappingOutput:
 *
 * `measured_labels`, `measured_labels_at_depth`, `final_measured_labels` are the images
 * of the same name without the CRF. `depth` is the stereo depth (16-bit PNG),
 * `probabilities_at_depth` the class probabilities of labels_at_depth (.npy, float16).
 * Each point of a scan has the label of its voxel in `scan_labels`, as the map stood at
 * that frame, and in `final_scan_labels` (`.label`, 0 = no occupied voxel), without CRF
 * in `measured_scan_labels` and `final_measured_scan_labels`; in `network_scan_labels`
 * that of the pixel it falls on, hidden or not, or its own, as it was read. With \a
 * within there are four more, `near_scan_labels` and so on, of the nearest voxels, see
 * VoxelLookup::nearest(). */
class ExtraOutput {
public:
  /** \param[in] camera that takes the frames; none = only scans are labelled
   * \throws OutputException if a folder cannot be made */
  ExtraOutput(const std::string& folder, const std::optional<StereoCamera>& camera,
              double max_depth, ExtraOptions options);

  /** \brief All folders that any run may write. */
  static const std::vector<std::string>& names();

  /** \brief Removes what an earlier run left in the folder of a map.
   * \param[in] kept frames whose files at a frame stay, in order */
  static void removeEarlier(const std::string& folder, const std::vector<int>& kept);

  /** \brief Files of a frame.
   * \param[in] rendered the map as it stood at that frame; without a camera none
   * \throws BadInputException if its scan is missing or damaged */
  void writeFrame(const MappedFrame& mapped, const RenderedLabels& rendered) const;

  /** \brief Files of a frame in the finished map. */
  void writeFinal(int frame, const Eigen::Isometry3d& T_world_camera,
                  const MapLabels& labels, const RenderedLabels& rendered) const;

  /** \brief Whether MapLabels are needed at all. */
  bool
  needsLabels() const
  {
    return options_.measured || options_.probabilities || options_.scan;
  }

private:
  std::string path(const std::string& name, int frame, const char* extension) const;

  void writeScan(int frame, std::vector<Eigen::Vector3d> points,
                 const Eigen::Isometry3d& T_world_camera, const MapLabels& labels,
                 const std::string& prefix) const;

  void writePoints(int frame, const std::vector<std::int32_t>& indices,
                   const MapLabels& labels, const std::string& prefix,
                   const std::string& name) const;

  // Voxels at the pixels' own depths, VoxelLookup::none without one.
  cv::Mat indicesAtDepth(const MappedFrame& mapped, const MapLabels& labels) const;

  void writeProbabilities(const MappedFrame& mapped, const MapLabels& labels) const;

  void writeNetworkScan(const MappedFrame& mapped,
                        const std::vector<Eigen::Vector3d>& points) const;

  std::string folder_;
  std::optional<StereoCamera> camera_;
  double max_depth_;
  ExtraOptions options_;
};

} // namespace pcl_semantic
