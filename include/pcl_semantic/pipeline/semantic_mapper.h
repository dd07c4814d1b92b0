// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_distributions.h>
#include <pcl_semantic/core/stereo_camera.h>
#include <pcl_semantic/core/voxel_cloud.h>
#include <pcl_semantic/images/sensor_frame.h>
#include <pcl_semantic/labelling/label_calibration.h>
#include <pcl_semantic/labelling/label_predictor.h>
#include <pcl_semantic/map/scan.h>
#include <pcl_semantic/map/semantic_voxel_map.h>
#include <pcl_semantic/odometry/pose_source.h>
#include <pcl_semantic/pipeline/mapper_config.h>
#include <pcl_semantic/stereo/disparity_engines.h>

#include <Eigen/Geometry>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <chrono>
#include <functional>
#include <limits>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Seconds of each stage of one frame, in order. */
class StageTimes {
public:
  /** \brief Runs a stage and stores its wall time. \return the result of \a stage */
  template <typename Stage>
  auto
  measure(const std::string& name, Stage&& stage)
  {
    const Stopwatch stopwatch{*this, name, Clock::now()};
    return stage();
  }

  const std::vector<std::pair<std::string, double>>&
  seconds() const
  {
    return seconds_;
  }

private:
  using Clock = std::chrono::steady_clock;

  struct Stopwatch {
    StageTimes& times;
    const std::string& name;
    Clock::time_point start;

    ~Stopwatch()
    {
      try {
        times.seconds_.emplace_back(
            name, std::chrono::duration<double>(Clock::now() - start).count());
      }
      catch (const std::bad_alloc&) { // keep the result of the stage
      }
    }
  };

  std::vector<std::pair<std::string, double>> seconds_;
};

/** \brief Result of processing one frame. */
struct MappedFrame {
  FrameTime frame;          ///< its number and time
  cv::Mat image;            ///< the left or the camera's image; empty: no camera
  DisparityImage disparity; ///< with deviations; empty for a cloud
  pcl::PointCloud<pcl::PointXYZRGB>::Ptr cloud; ///< camera frame [m], organized
  bool has_colour = true;                       ///< whether the cloud has valid colours
  LabelDistributions network;    ///< L x pixels (or points), before calibration;
                                 ///< empty for unlabelled frames (network_every)
  LabelDistributions calibrated; ///< L x pixels, fused instead; empty without
                                 ///< calibration or labels
  double domain_shift =
      std::numeric_limits<double>::quiet_NaN(); ///< domainShift() of
                                                ///< the calibration; NaN = unknown
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  ScanCounts counts; ///< of the scan added to the map
  VoxelCloud voxels; ///< the occupied voxels of the window after this frame
  StageTimes times;
};

class MapCliques;

/** \brief The whole pipeline: builds a semantic map from stereo or RGB-D frames, or
 * from labelled clouds of any sensor. */
class SemanticMapper {
public:
  /** \brief Called after each frame. */
  using Callback = std::function<void(const MappedFrame&, const SemanticVoxelMap&)>;

  /** \param[in] label_set the classes of the map
   * \param[in] poses of the sensor: of the left camera, if frames are from a camera
   * \param[in] camera of the frames, if any. Clouds must then be organized like its
   * images, in its frame, which enables `min_hit_ratio`, calibrations and superpixels
   * \param[in] predictor class probabilities of the pixels of stereo pairs and RGB-D
   * images, which require the camera; null = frames are labelled clouds
   * \param[in] store for voxels that leave the window; null = memory
   * \throws InvalidParameterException */
  SemanticMapper(const LabelSet& label_set, MapperConfig config,
                 std::unique_ptr<PoseSource> poses,
                 const std::optional<StereoCamera>& camera = std::nullopt,
                 std::unique_ptr<LabelPredictor> predictor = nullptr,
                 std::shared_ptr<BlockStore> store = nullptr);

  ~SemanticMapper();

  /** \brief Resumes the map in the store. Call it before the first frame.
   * \param[in] frames number of frames in it
   * \param[in] finished whether finish() was called after them
   * \param[in] cloud_origin of the map, see SemanticVoxelMap::cloudOrigin */
  void resume(int frames, bool finished, const Eigen::Vector3d& cloud_origin);

  void
  setCallback(Callback callback)
  {
    callback_ = std::move(callback);
  }

  /** \brief Calibrates the labels of each frame before fusion.
   * \throws InvalidParameterException unless the calibration has the map's classes */
  void setLabelCalibration(LabelCalibration calibration);

  /** \brief Computes cliques' costs psi_c(l), eq. (7), by a calibration of clique
   * features instead of the members' mean.
   * \throws InvalidParameterException unless the calibration has the map's classes and
   * the model has clique costs */
  void setCliqueCalibration(LabelCalibration calibration);

  /** \brief Processes one frame: cloud (for a stereo pair: disparity, cloud, labels),
   * pose, map, CRF.
   * \throws BadInputException or BadModelException that names the frame, also if a
   * cloud does not match the camera's images
   * \throws InvalidParameterException for images, if the mapper was created for
   * clouds */
  MappedFrame process(const SensorFrame& frame);

  /** \brief Fuses late labels of a frame that was processed without labels. The CRF
   * uses them with the next frame.
   * \param[in] earlier result of process(); only its cloud and pose are used
   * \param[in] labels L x pixels
   * \throws InvalidParameterException if they have other classes or another number of
   * pixels */
  void addLabels(const MappedFrame& earlier, LabelDistributions labels);

  /** \brief Runs the CRF over the window if the last frame skipped it (crf_every), so
   * that the finished map is completely refined. */
  void finish();

  /** \brief Writes changes in the window to the store. */
  void
  flush()
  {
    map_.flush();
  }

  const SemanticVoxelMap&
  map() const
  {
    return map_;
  }

private:
  bool isRefinedAt(int frame) const;

  bool isLabelledAt(int frame) const;

  void read(const StereoFrame& frame, MappedFrame& mapped);

  void read(const RgbdFrame& frame, MappedFrame& mapped);

  void read(const CloudFrame& frame, MappedFrame& mapped);

  void requireImages() const;

  void requireSizeOfCamera(const pcl::PointCloud<pcl::PointXYZRGB>& cloud,
                           int frame) const;

  void labelImage(MappedFrame& mapped);

  void fuse(MappedFrame& mapped);

  void calibrateLabels(MappedFrame& mapped) const;

  pcl::PointCloud<pcl::PointXYZRGB>::Ptr withoutSeenThrough(const MappedFrame& mapped,
                                                            std::size_t& erased) const;

  ScanCounts integrate(const MappedFrame& mapped);

  void refineVoxels(VoxelCloud& voxels);

  std::optional<StereoCamera> camera_;
  MapperConfig config_;
  std::unique_ptr<DisparityEstimator> stereo_;
  std::unique_ptr<LabelPredictor> predictor_;
  std::unique_ptr<PoseSource> poses_;
  std::optional<LabelCalibration> calibration_;
  SemanticVoxelMap map_;
  std::unique_ptr<MapCliques> cliques_;
  Callback callback_;
  int frames_ = 0;
  bool refined_ = true; // by the CRF, after the last frame
};

} // namespace pcl_semantic
