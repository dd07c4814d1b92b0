// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/evaluation/voxel_lookup.h>
#include <pcl_semantic/pipeline/mapping_output.h>
#include <pcl_semantic/pipeline/semantic_mapper.h>

#include <optional>
#include <string>
#include <vector>

namespace pcl_semantic {

/** \brief Writes the output of ExtraOptions to separate folders beside those of
 * MappingOutput:
 *
 * `measured_labels`, `measured_labels_at_depth`, `final_measured_labels` are the images
 * of the same name without the CRF. `depth` is the stereo depth (16-bit PNG).
 * `final_labels_at_depth` contains the labels of the finished map at the depths of
 * these images, `final_measured_labels_at_depth` those without the CRF.
 * `probabilities_at_depth` contains the class probabilities of labels_at_depth (.npy,
 * float16).
 *
 * `scan_labels` (`.label`, 0 = no occupied voxel) contains the label of each scan
 * point's voxel in the map at that frame and, if objects are tracked, the number of its
 * object. `final_scan_labels` contains those in the finished map.
 * `measured_scan_labels` and `final_measured_scan_labels` are without the CRF.
 * `network_scan_labels` contains the label of the point's pixel, hidden or not, or the
 * point's input label. \a within adds four folders, `near_scan_labels` and so on, with
 * the labels of the nearest voxels, see VoxelLookup::nearest(). */
class ExtraOutput {
public:
  /** \param[in] camera of the frames; none = only scans are labelled
   * \throws OutputException if a folder cannot be created */
  ExtraOutput(const std::string& folder, const std::optional<StereoCamera>& camera,
              double max_depth, ExtraOptions options);

  /** \brief Checks that files which are read at the end exist for a frame of a resumed
   * run.
   * \throws BadInputException if one is missing */
  void requireFrame(int frame) const;

  /** \brief All folders that any run may write. */
  static const std::vector<std::string>& names();

  /** \brief Removes output of an earlier run from a map folder.
   * \param[in] kept frames whose files are kept, in order */
  static void removeEarlier(const std::string& folder, const std::vector<int>& kept);

  /** \brief Writes the files of a frame.
   * \throws BadInputException if its scan is missing or damaged */
  void writeFrame(const MappedFrame& mapped) const;

  /** \brief Writes the files of a frame in the finished map.
   * \param[in] labels of \a voxels
   * \throws BadInputException if its scan or depth image is missing or damaged */
  void writeFinal(int frame, const Eigen::Isometry3d& T_world_camera,
                  const VoxelCloud& voxels, const MapLabels& labels) const;

  /** \brief Whether writeFinal() needs MapLabels. */
  bool
  needsFinalLabels() const
  {
    return options_.measured || options_.depth || options_.scan;
  }

private:
  std::string path(const std::string& name, int frame, const char* extension) const;

  void writeScan(int frame, std::vector<Eigen::Vector3d> points,
                 const Eigen::Isometry3d& T_world_camera, const MapLabels& labels,
                 const std::string& prefix) const;

  void writePoints(int frame, const std::vector<std::int32_t>& indices,
                   const MapLabels& labels, const std::string& prefix,
                   const std::string& name) const;

  // Renders the labels before the CRF.
  void writeMeasured(const std::string& name, int frame, const VoxelCloud& voxels,
                     const std::vector<Label>& measured,
                     const Eigen::Isometry3d& T_world_camera) const;

  // Voxels at the points of an organized cloud in the camera frame; VoxelLookup::none
  // without depth.
  cv::Mat indicesAtDepth(const pcl::PointCloud<pcl::PointXYZRGB>& cloud,
                         const Eigen::Isometry3d& T_world_camera,
                         const MapLabels& labels) const;

  void writeFinalAtDepth(int frame, const Eigen::Isometry3d& T_world_camera,
                         const MapLabels& labels) const;

  void writeProbabilities(const MappedFrame& mapped, const MapLabels& labels) const;

  void writeNetworkScan(const MappedFrame& mapped,
                        const std::vector<Eigen::Vector3d>& points) const;

  std::string folder_;
  std::optional<StereoCamera> camera_;
  double max_depth_;
  ExtraOptions options_;
};

} // namespace pcl_semantic
