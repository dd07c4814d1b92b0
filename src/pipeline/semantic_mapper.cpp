/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/filters/semantic_crf.h>
#include <pcl_semantic/map/seen_through.h>
#include <pcl_semantic/pipeline/frame_calibration.h>
#include <pcl_semantic/pipeline/semantic_mapper.h>
#include <pcl_semantic/stereo/disparity_engines.h>
#include <pcl_semantic/stereo/disparity_to_cloud.h>

namespace pcl_semantic {

namespace {

MapperConfig
validated(MapperConfig config)
{
  config.validate();
  return config;
}

} // namespace

SemanticMapper::SemanticMapper(const StereoCamera& camera, const LabelSet& label_set,
                               MapperConfig config,
                               std::unique_ptr<LabelPredictor> predictor,
                               std::unique_ptr<PoseSource> poses,
                               std::shared_ptr<BlockStore> store)
    : camera_(camera), config_(validated(std::move(config))),
      stereo_(makeDisparityEstimator(config_.stereo, config_.disparities)),
      predictor_(std::move(predictor)), poses_(std::move(poses)),
      map_(label_set, config_.map, std::move(store)), cliques_(config_, label_set)
{
  camera_.validate();
  setNumberOfThreads(config_.threads);
}

void
SemanticMapper::setLabelCalibration(LabelCalibration calibration)
{
  calibration.validate();
  if (calibration.classes() != map_.labelSet().size())
    PCL_THROW_EXCEPTION(InvalidParameterException, "label calibration of "
                                                       << calibration.classes()
                                                       << " classes for a map of "
                                                       << map_.labelSet().size());
  calibration_ = std::move(calibration);
}

void
SemanticMapper::setCliqueCalibration(LabelCalibration calibration)
{
  if (config_.crf != "hierarchical")
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "a clique calibration is for the model hierarchical, not "
                            << config_.crf);
  cliques_.setCalibration(std::move(calibration));
}

void
SemanticMapper::resume(int frames, bool finished, const Eigen::Vector3d& cloud_origin)
{
  frames_ = frames;
  refined_ = finished || isRefinedAt(frames - 1);
  map_.setCloudOrigin(cloud_origin);
}

// Whether the CRF has seen the frame, which counts from 0.
bool
SemanticMapper::isRefinedAt(int frame) const
{
  return config_.crf == "none" || frame % config_.crf_every == 0;
}

MappedFrame
SemanticMapper::process(const StereoFrame& frame)
{
  MappedFrame result;
  result.frame = frame;
  StageTimes& times = result.times;
  result.T_world_camera = times.measure("pose", [&] { return poses_->pose(frame); });
  result.disparity = times.measure(
      "stereo", [&] { return stereo_->estimate(frame.left, frame.right); });
  eraseUnsure(result.disparity, config_.max_deviation);
  result.cloud = times.measure("cloud", [&] {
    return disparityToCloud(result.disparity.disparity, frame.left, camera_);
  });
  result.network =
      times.measure("labelling", [&] { return predictor_->predict(frame); });
  if (calibration_)
    result.calibrated = times.measure("calibration", [&] {
      return calibrate(
          *calibration_, result.network,
          frameFeatures(*result.cloud, result.network, calibration_->ground));
    });
  result.counts = times.measure("map", [&] { return integrate(result); });
  result.voxels = times.measure("voxels", [&] { return map_.occupied(); });
  refined_ = isRefinedAt(frames_);
  if (config_.crf != "none" && refined_)
    times.measure("crf", [&] {
      refine(result);
      map_.setRefined(result.voxels, result.voxels.refined, config_.crf_write_back);
    });
  else
    setFrameOfCliques(result); // for finish()
  ++frames_;
  if (callback_)
    callback_(result, map_);
  return result;
}

void
SemanticMapper::finish()
{
  if (refined_)
    return;
  VoxelCloud voxels = map_.occupied();
  refineVoxels(voxels);
  map_.setRefined(voxels, voxels.refined);
  refined_ = true;
}

ScanCounts
SemanticMapper::integrate(const MappedFrame& mapped)
{
  std::vector<float> deviations;
  if (config_.deviation_scale > 0.0)
    deviations = distanceDeviations(*mapped.cloud, camera_, mapped.disparity.deviation,
                                    config_.deviation_scale);
  try {
    auto cloud = mapped.cloud; // stays as it was measured
    std::size_t erased = 0;
    if (config_.hit_share > 0.0) {
      cloud = pcl::make_shared<pcl::PointCloud<pcl::PointXYZRGB>>(*cloud);
      erased = eraseSeenThrough(*cloud, camera_, mapped.T_world_camera,
                                map_.parameters().voxel_size, config_.hit_share);
    }
    ScanCounts counts =
        map_.integrate(*cloud, mapped.T_world_camera,
                       calibration_ ? mapped.calibrated : mapped.network, deviations);
    counts.invalid -= erased; // they had a depth
    counts.seen_through = erased;
    return counts;
  }
  catch (const BadInputException& error) { // a map knows nothing of frames
    PCL_THROW_EXCEPTION(BadInputException,
                        "frame " << mapped.frame.number << ": " << error.what());
  }
}

void
SemanticMapper::setFrameOfCliques(const MappedFrame& mapped)
{
  cliques_.setFrame(mapped.cloud, mapped.network, mapped.T_world_camera);
}

void
SemanticMapper::refine(MappedFrame& mapped)
{
  setFrameOfCliques(mapped);
  if (config_.crf != "none")
    refineVoxels(mapped.voxels);
}

void
SemanticMapper::refineVoxels(VoxelCloud& voxels)
{
  SemanticCRF<pcl::PointXYZRGBL> crf;
  crf.setModel(config_.crfModel());
  if (config_.crf != "dense") {
    const MapCliques::Result groups = cliques_.generate(voxels);
    crf.setCliques(groups.cliques);
    crf.setCliqueCosts(groups.costs);
  }
  crf.setParameters(config_.crf_parameters);
  crf.setVoxels(voxels.indices, voxels.voxel_size);
  crf.setInputCloud(voxels.cloud);
  crf.setLabelDistributions(voxels.measured);
  crf.filter(*voxels.cloud);
  voxels.refined = crf.getLabelDistributions();
}

} // namespace pcl_semantic
