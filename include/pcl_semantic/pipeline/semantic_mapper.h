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
#include <pcl_semantic/things/object_tracker.h>

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

/** \brief Wall times of the stages of one frame. */
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

  /** \brief Name and wall time [s] of each stage, in the order of execution. */
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
      catch (const std::bad_alloc&) { // loses the time, keeps the stage's result
      }
    }
  };

  std::vector<std::pair<std::string, double>> seconds_;
};

/** \brief Result of processing one frame. */
struct MappedFrame {
  FrameTime frame;
  /// Left image, colour image, or the colours of an organized cloud; empty without a
  /// camera.
  cv::Mat image;
  DisparityImage disparity; ///< disparities of a stereo pair; else empty
  /// Sensor frame [m]. If there is a camera, this is the camera frame, and the cloud is
  /// organized as its images.
  pcl::PointCloud<pcl::PointXYZRGB>::Ptr cloud;
  bool has_colour = true; ///< whether the cloud has valid colours
  /// Labels before calibration, L x points of the cloud. Empty if the frame has no
  /// labels or MapperConfig::network_every skips them.
  LabelDistributions network;
  /// Calibrated labels, L x points of the cloud. The map fuses them instead of the
  /// labels in \a network. Empty without calibration or labels.
  LabelDistributions calibrated;
  /// domainShift() of the label calibration; NaN = unknown.
  double domain_shift = std::numeric_limits<double>::quiet_NaN();
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  ScanCounts counts; ///< counts of the scan added to the map
  VoxelCloud voxels; ///< the occupied voxels of the window, after the CRF of this frame
  StageTimes times;
};

class MapCliques;

/** \brief The whole pipeline: builds a semantic map from stereo pairs, RGB-D frames or
 * labelled clouds. */
class SemanticMapper {
public:
  /** \brief Called after each frame with its results and the map. */
  using Callback = std::function<void(const MappedFrame&, const SemanticVoxelMap&)>;

  /** \param[in] label_set the classes of the map
   * \param[in] poses source of the sensor's poses. The sensor of stereo pairs is the
   * left camera
   * \param[in] camera rectified camera of the frames; none for clouds of another
   * sensor. If it is given, clouds must be organized like its images and in its frame.
   * It enables `min_hit_ratio`, calibrations and superpixels
   * \param[in] predictor predicts the classes of stereo pairs and RGB-D images and
   * requires the camera; null = the frames are labelled clouds
   * \param[in] store for voxels that leave the window; null = memory
   * \throws InvalidParameterException if a parameter is out of range or does not apply
   * to these frames, if \a poses is null, or if there is a predictor without a camera
   */
  SemanticMapper(const LabelSet& label_set, MapperConfig config,
                 std::unique_ptr<PoseSource> poses,
                 const std::optional<StereoCamera>& camera = std::nullopt,
                 std::unique_ptr<LabelPredictor> predictor = nullptr,
                 std::shared_ptr<BlockStore> store = nullptr);

  ~SemanticMapper();

  /** \brief Resumes the map in the store. Must be called before the first frame.
   * \param[in] frames number of frames in this map
   * \param[in] finished whether finish() was called after these frames
   * \param[in] cloud_origin SemanticVoxelMap::cloudOrigin() of this map
   * \param[in] objects of the map, if it has objects() */
  void resume(int frames, bool finished, const Eigen::Vector3d& cloud_origin,
              std::optional<MapObjects> objects = std::nullopt);

  /** \brief Sets a function to call at the end of process(). */
  void
  setCallback(Callback callback)
  {
    callback_ = std::move(callback);
  }

  /** \brief Calibrates the labels of each frame before fusion.
   * \throws InvalidParameterException if the calibration is invalid or does not have
   * the map's classes, or there is no camera */
  void setLabelCalibration(LabelCalibration calibration);

  /** \brief Processes one frame: computes the pose, the cloud and the labels, adds them
   * to the map, and runs the CRF.
   * \throws BadInputException or BadModelException that names the frame, also if a
   * cloud does not match the camera's images
   * \throws InvalidParameterException if the frame is a pair or an image and there is
   * no predictor, if the frame has no cloud, or if stereo parameters are set and
   * the frame is no stereo pair */
  MappedFrame process(const SensorFrame& frame);

  /** \brief Fuses the labels of a frame that was processed without labels. The next run
   * of the CRF uses them.
   * \param[in] earlier result of process(); only its cloud and pose are used
   * \param[in] labels L x points of the cloud
   * \throws InvalidParameterException if the labels have other classes or another
   * number of points
   * \throws BadInputException if a probability is negative or not finite */
  void addLabels(const MappedFrame& earlier, LabelDistributions labels);

  /** \brief Runs the CRF over the window if measurements were added after its last run
   * (`crf_every`, addLabels()). The finished map is then completely refined. */
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

  /** \brief The objects of the map; null without MapperConfig::things, and if no class
   * is marked `thing`. */
  const ObjectTracker*
  objects() const
  {
    return objects_.get();
  }

  /** \brief See ObjectTracker::takeChanges(); nothing without objects. */
  std::optional<MapObjects>
  takeObjectChanges()
  {
    return objects_ ? std::optional(objects_->takeChanges()) : std::nullopt;
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

  void setDepthError(const SensorFrame& frame);

  ScanCounts integrate(const MappedFrame& mapped);

  void refineVoxels(VoxelCloud& voxels);

  void numberObjects(VoxelCloud& voxels);

  std::optional<StereoCamera> camera_;
  MapperConfig config_;
  std::unique_ptr<DisparityEstimator> stereo_;
  std::unique_ptr<LabelPredictor> predictor_;
  std::unique_ptr<PoseSource> poses_;
  std::optional<LabelCalibration> calibration_;
  SemanticVoxelMap map_;
  std::unique_ptr<MapCliques> cliques_;
  std::unique_ptr<ObjectTracker> objects_;
  Callback callback_;
  int frames_ = 0;
  bool refined_ = true; // no measurement was added after the last run of the CRF
  bool has_new_labels_ = false; // since the last search for objects
};

} // namespace pcl_semantic
