// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/stereo_camera.h>
#include <pcl_semantic/evaluation/voxel_lookup.h>

#include <Eigen/Geometry>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief What MapGeometry counts. The window covers the gaps between the beams of a
 * 64-beam scanner in KITTI's images. */
struct GeometryParameters {
  std::vector<double> bands = {0.0, 10.0, 20.0, 40.0}; ///< borders, camera z [m]
  double behind = 2.0;    ///< so far behind a return a voxel is judged [m]
  int window_columns = 3; ///< half width of the window around a voxel's pixel [px]
  int window_rows = 7;    ///< half height of it [px]
  double within = 0.3;    ///< of the widest of the three fractions of the surface [m]
};

/** \brief How much of the lidar surface of one band is in the map. */
struct SurfaceCounts {
  std::uint64_t points = 0;   ///< seen by the camera
  std::uint64_t at = 0;       ///< in an occupied voxel
  std::uint64_t adjacent = 0; ///< there, or one of the 26 voxels around is occupied
  std::uint64_t within = 0;   ///< an occupied cube is within GeometryParameters::within
};

/** \brief What is measured of maps; pooling is appending. */
struct GeometrySamples {
  std::uint64_t voxels = 0;           ///< occupied
  std::vector<float> distances;       ///< of those judged, to the nearest return [m]
  std::vector<SurfaceCounts> surface; ///< by band

  GeometrySamples& operator+=(const GeometrySamples& other);
};

/** \brief The geometry of a map against laser scans.
 *
 * *How far voxels lie off*: the distance from the point of an occupied voxel to the
 * nearest return of any scan. Only voxels that the lidar could have met are judged:
 * those that, in some frame, fall into the image between returns (within the window
 * around the voxel's pixel there are returns at or above and at or below its row), and
 * lie no more than \a behind farther than the farthest of these returns (what is deeper
 * is hidden from the scanner), nor beyond the last band.
 *
 * *How much of the surface is mapped*: of the returns that the camera sees, see
 * seenDepths(), by the band of their depth. */
class MapGeometry {
public:
  /** \param[in] voxels of the map, with their points
   * \throws InvalidParameterException unless the bands' borders grow from 0 or more */
  MapGeometry(const VoxelCloud& voxels, GeometryParameters parameters = {});

  /** \brief Takes in a scan.
   * \param[in] scan points in the scanner's frame [m]
   * \param[in] camera pinhole with its image size
   * \param[in] T_world_camera pose of the camera in the map
   * \param[in] T_camera_scanner pose of the scanner in the camera */
  void addScan(const pcl::PointCloud<pcl::PointXYZI>& scan, const StereoCamera& camera,
               const Eigen::Isometry3d& T_world_camera,
               const Eigen::Isometry3d& T_camera_scanner);

  /** \brief The same of a scanner without a camera: returns count by their distance,
   * and voxels no farther than the last band are judged.
   * \param[in] points in the scanner's frame [m]; others than finite ones are none
   * \param[in] T_world_scanner its pose in the map */
  void addScan(const std::vector<Eigen::Vector3d>& points,
               const Eigen::Isometry3d& T_world_scanner);

  /** \brief After the last scan. */
  GeometrySamples samples() const;

private:
  void judgeVoxels(const std::vector<Eigen::Vector3d>& camera_points,
                   const StereoCamera& camera, const Eigen::Isometry3d& T_camera_world);

  void addReturn(const Eigen::Vector3d& point);

  void countSurface(const Eigen::Vector3d& point, float depth);

  GeometryParameters parameters_;
  VoxelLookup lookup_;
  std::vector<Eigen::Vector3d> positions_;           ///< of voxels, world frame [m]
  std::vector<std::uint8_t> judged_;                 ///< by voxel
  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero(); ///< of returns_, world frame [m]
  pcl::PointCloud<pcl::PointXYZ>::Ptr returns_{new pcl::PointCloud<pcl::PointXYZ>};
  std::vector<SurfaceCounts> surface_;
};

/** \brief Figures from samples; NaN where there is nothing to say. */
struct GeometryScores {
  static constexpr std::array<double, 3> limits{{0.1, 0.2, 0.5}}; ///< [m]

  std::uint64_t voxels = 0, judged = 0;
  double mean = 0.0, median = 0.0, percentile_90 = 0.0; ///< of the distances [m]
  std::array<double, 3> fractions{}; ///< of the judged voxels within the limits, 0..1
};

GeometryScores scoreGeometry(const GeometrySamples& samples);

/** \brief The geometry of maps as text, a figure a line. */
std::string geometryTable(const GeometrySamples& samples,
                          const GeometryParameters& parameters);

/** \brief The two header lines that belong to geometryMarkdownRow. */
std::string geometryMarkdownHeader(const GeometryParameters& parameters);

/** \brief One row of a Markdown table: name, distances [cm], fractions of the judged
 * voxels and, by band, of the surface [%]. */
std::string geometryMarkdownRow(const GeometrySamples& samples,
                                const GeometryParameters& parameters,
                                const std::string& name);

/** \brief The same as JSON, metres and ratios 0..1; null where there is none. */
std::string geometryJson(const GeometrySamples& samples,
                         const GeometryParameters& parameters);

} // namespace pcl_semantic
