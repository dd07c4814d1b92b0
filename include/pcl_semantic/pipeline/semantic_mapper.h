// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/sensor_frame.h>
#include <pcl_semantic/core/stereo_camera.h>
#include <pcl_semantic/labelling/label_calibration.h>
#include <pcl_semantic/labelling/label_predictor.h>
#include <pcl_semantic/map/semantic_voxel_map.h>
#include <pcl_semantic/odometry/pose_source.h>
#include <pcl_semantic/pipeline/mapped_frame.h>
#include <pcl_semantic/pipeline/mapper_config.h>
#include <pcl_semantic/stereo/disparity_estimator.h>

#include <functional>
#include <memory>
#include <optional>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

class MapCliques;

/** \brief The whole pipeline: stereo frames go in, or labelled clouds of any sensor,
 * and a semantic map grows. */
class SemanticMapper {
public:
  /** \brief Called after each frame. */
  using Callback = std::function<void(const MappedFrame&, const SemanticVoxelMap&)>;

  /** \param[in] label_set the classes of the map
   * \param[in] poses of the sensor: the left camera's, if a camera takes the frames
   * \param[in] camera that takes the frames, if one does. Clouds are then organized as
   * its images, in its frame, so that `min_hit_ratio`, calibrations and superpixels can
   * be used
   * \param[in] predictor class probabilities of the pixels of stereo pairs, which also
   * need the camera; null = frames are clouds, which bring theirs
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
   * cloud is not as the camera's images are \throws InvalidParameterException at a pair
   * if the mapper was made for clouds */
  MappedFrame process(const SensorFrame& frame);

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

  void readPair(const StereoFrame& frame, MappedFrame& mapped);

  void readCloud(const CloudFrame& frame, MappedFrame& mapped) const;

  void fuse(MappedFrame& mapped);

  ScanCounts integrate(const MappedFrame& mapped);

  void refine(MappedFrame& mapped);

  void setFrameOfCliques(const MappedFrame& mapped);

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
