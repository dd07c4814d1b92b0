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

/** \brief Seconds of each stage of one frame, in the order they ran. */
class StageTimes {
public:
  /** \brief Runs a stage and keeps its wall time. \return what \a stage returns */
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
      catch (const std::bad_alloc&) { // the stage has done its work
      }
    }
  };

  std::vector<std::pair<std::string, double>> seconds_;
};

/** \brief Result of processing one frame. */
struct MappedFrame {
  FrameTime frame;          ///< its number and time
  cv::Mat image;            ///< the left one, or that of the camera; empty: no camera
  DisparityImage disparity; ///< of each pixel, and how sure it is; of a cloud: empty
  pcl::PointCloud<pcl::PointXYZRGB>::Ptr cloud; ///< camera frame [m], organized
  bool has_colour = true;                       ///< whether its colours mean anything
  LabelDistributions network;    ///< L x pixels (or points), as they were labelled;
                                 ///< empty where they were not (network_every)
  LabelDistributions calibrated; ///< L x pixels, what the map gets instead; empty if
                                 ///< there is no calibration, or no labels
  double domain_shift =
      std::numeric_limits<double>::quiet_NaN(); ///< domainShift() of
                                                ///< the calibration; NaN = not known
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  ScanCounts counts; ///< of the scan that went into the map
  VoxelCloud voxels; ///< the occupied voxels of the window after this frame
  StageTimes times;
};

class MapCliques;

/** \brief The whole pipeline: stereo or RGB-D frames go in, or labelled clouds of any
 * sensor, and a semantic map grows. */
class SemanticMapper {
public:
  /** \brief Called after each frame. */
  using Callback = std::function<void(const MappedFrame&, const SemanticVoxelMap&)>;

  /** \param[in] label_set the classes of the map
   * \param[in] poses of the sensor: the left camera's, if a camera takes the frames
   * \param[in] camera that takes the frames, if one does. Clouds are then organized as
   * its images, in its frame, so that `min_hit_ratio`, calibrations and superpixels can
   * be used
   * \param[in] predictor class probabilities of the pixels of stereo pairs and RGB-D
   * images, which also need the camera; null = frames are clouds, which bring theirs
   * \param[in] store where voxels go that leave the window; null = memory
   * \throws InvalidParameterException */
  SemanticMapper(const LabelSet& label_set, MapperConfig config,
                 std::unique_ptr<PoseSource> poses,
                 const std::optional<StereoCamera>& camera = std::nullopt,
                 std::unique_ptr<LabelPredictor> predictor = nullptr,
                 std::shared_ptr<BlockStore> store = nullptr);

  ~SemanticMapper();

  /** \brief Goes on with the map that the store holds. Only before the first frame.
   * \param[in] frames that are in it
   * \param[in] finished whether finish() was called after them
   * \param[in] cloud_origin of the map, see SemanticVoxelMap::cloudOrigin */
  void resume(int frames, bool finished, const Eigen::Vector3d& cloud_origin);

  void
  setCallback(Callback callback)
  {
    callback_ = std::move(callback);
  }

  /** \brief Calibrates the labels of each frame before they go into the map.
   * \throws InvalidParameterException if it is not one of the map's classes */
  void setLabelCalibration(LabelCalibration calibration);

  /** \brief Has cliques' costs psi_c(l), eq. (7), from what they are instead of the
   * mean of their members'.
   * \throws InvalidParameterException if it is not one of the map's classes, or the
   * model has no such costs */
  void setCliqueCalibration(LabelCalibration calibration);

  /** \brief Takes in one frame: its cloud (of a stereo pair: disparity, cloud, labels),
   * pose, map, CRF.
   * \throws BadInputException or BadModelException that names the frame, also if a
   * cloud is not as the camera's images are \throws InvalidParameterException at images
   * if the mapper was made for clouds */
  MappedFrame process(const SensorFrame& frame);

  /** \brief Fuses the labels of a frame that was processed without them: its predictor
   * gave none, since they were not ready. The CRF sees them with the next frame.
   * \param[in] earlier what process() returned of it; of this the cloud and the pose
   * \param[in] labels L x pixels
   * \throws InvalidParameterException if they are of other classes or pixels */
  void addLabels(const MappedFrame& earlier, LabelDistributions labels);

  /** \brief Runs the CRF over the window if the last frame had none (crf_every), so
   * that the finished map is refined throughout. */
  void finish();

  /** \brief Puts what has changed in the window into the store. */
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
  bool refined_ = true; // the CRF has seen the last frame
};

} // namespace pcl_semantic
