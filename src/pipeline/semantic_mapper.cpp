// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/pipeline/semantic_mapper.h>

#include "core/fail.h"
#include "filters/crf_region.h"
#include "frame_calibration.h"
#include "map_cliques.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/no_return.h>
#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/filters/semantic_crf.h>
#include <pcl_semantic/map/seen_through.h>
#include <pcl_semantic/stereo/disparity_engines.h>
#include <pcl_semantic/stereo/disparity_to_cloud.h>

#include <pcl/common/io.h>

#include <algorithm>

namespace pcl_semantic {

namespace {

MapperConfig
validated(MapperConfig config, const LabelSet& label_set)
{
  config.things = config.things && label_set.hasThings();
  config.map.fusion.occupy_dynamic = config.things;
  config.validate();
  return config;
}

// Refuses parameters of stereo pairs.
void
requireNothingOfStereo(const MapperConfig& config)
{
  if (config.deviation_scale > 0.0 || config.max_deviation > 0.0)
    badParameter("max_deviation and deviation_scale are for stereo: clouds have no "
                 "deviations");
}

// Refuses parameters of camera frames.
void
requireNothingOfCamera(const MapperConfig& config, bool has_camera)
{
  if (!has_camera && config.min_hit_ratio > 0.0 &&
      config.min_hit_ratio != MapperConfig().min_hit_ratio)
    badParameter(
        "min_hit_ratio is for images: it counts pixels that see through a voxel");
  if (!has_camera && config.crf == CRFModelType::hierarchical &&
      namesCliques(config.cliques, "superpixel"))
    badParameter("superpixels are for clouds of a camera");
}

} // namespace

SemanticMapper::SemanticMapper(const LabelSet& label_set, MapperConfig config,
                               std::unique_ptr<PoseSource> poses,
                               const std::optional<StereoCamera>& camera,
                               std::unique_ptr<LabelPredictor> predictor,
                               std::shared_ptr<BlockStore> store)
    : camera_(camera), config_(validated(std::move(config), label_set)),
      predictor_(std::move(predictor)), poses_(std::move(poses)),
      map_(label_set, config_.map, std::move(store)),
      cliques_(std::make_unique<MapCliques>(config_))
{
  if (!poses_)
    badParameter("a mapper needs a source of poses");
  if (config_.things)
    objects_ = std::make_unique<ObjectTracker>(label_set, config_.objects);
  if (camera_)
    camera_->validate();
  if (predictor_ && !camera_)
    badParameter("a predictor is for images, which need their camera");
  if (predictor_)
    stereo_ = makeDisparityEstimator(config_.stereo, config_.disparities);
  else {
    requireNothingOfStereo(config_);
    requireNothingOfCamera(config_, camera_.has_value());
  }
}

SemanticMapper::~SemanticMapper() = default;

void
SemanticMapper::setLabelCalibration(LabelCalibration calibration)
{
  calibration.validate();
  if (!camera_)
    badParameter("a label calibration is for frames of a camera");
  if (calibration.classes() != map_.labelSet().size())
    badParameter("label calibration of ", calibration.classes(),
                 " classes for a map of ", map_.labelSet().size());
  calibration_ = std::move(calibration);
}

void
SemanticMapper::resume(int frames, bool finished, const Eigen::Vector3d& cloud_origin,
                       std::optional<MapObjects> objects)
{
  if (objects_ && objects)
    objects_->restore(std::move(*objects));
  frames_ = frames;
  refined_ = finished || isRefinedAt(frames - 1);
  map_.setCloudOrigin(cloud_origin);
}

// Whether the CRF runs at this frame, counted from 0.
bool
SemanticMapper::isRefinedAt(int frame) const
{
  return config_.crf == CRFModelType::unary || frame % config_.crf_every == 0;
}

// Whether the labels of this frame are used, counted from 0.
bool
SemanticMapper::isLabelledAt(int frame) const
{
  return frame % config_.network_every == 0;
}

MappedFrame
SemanticMapper::process(const SensorFrame& frame)
{
  const ThreadScope threads(config_.threads);
  MappedFrame mapped;
  mapped.frame = timeOf(frame);
  mapped.T_world_camera =
      mapped.times.measure("pose", [&] { return poses_->pose(frame); });
  std::visit([&](const auto& each) { read(each, mapped); }, frame);
  setDepthError(frame);
  fuse(mapped);
  return mapped;
}

// Makes a labelled cloud from a pair of images.
void
SemanticMapper::read(const StereoFrame& frame, MappedFrame& mapped)
{
  requireImages();
  StageTimes& times = mapped.times;
  mapped.image = frame.left;
  mapped.disparity = times.measure(
      "stereo", [&] { return stereo_->estimate(frame.left, frame.right); });
  eraseUnsure(mapped.disparity, config_.max_deviation);
  mapped.cloud = times.measure("cloud", [&] {
    return disparityToCloud(mapped.disparity.disparity, frame.left, *camera_);
  });
  labelImage(mapped);
}

// Makes a labelled cloud from an image with depths.
void
SemanticMapper::read(const RgbdFrame& frame, MappedFrame& mapped)
{
  requireImages();
  requireNothingOfStereo(config_);
  if (!frame.cloud)
    badParameter("frame ", frame.number, ": has no cloud");
  requireSizeOfCamera(*frame.cloud, frame.number);
  mapped.image = frame.image;
  mapped.cloud = frame.cloud;
  labelImage(mapped);
}

// Requires a mapper with a predictor.
void
SemanticMapper::requireImages() const
{
  if (!predictor_)
    badParameter("this mapper was made for clouds alone");
}

void
SemanticMapper::labelImage(MappedFrame& mapped)
{
  if (isLabelledAt(frames_))
    mapped.network = mapped.times.measure("labelling", [&] {
      return predictor_->predict(mapped.image, mapped.frame.number);
    });
}

void
SemanticMapper::requireSizeOfCamera(const pcl::PointCloud<pcl::PointXYZRGB>& cloud,
                                    int frame) const
{
  if (int(cloud.width) != camera_->width || int(cloud.height) != camera_->height)
    badInput("frame ", frame, ": the cloud is ", cloud.width, " x ", cloud.height,
             ", expected that of the camera, ", camera_->width, " x ", camera_->height);
}

void
SemanticMapper::read(const CloudFrame& frame, MappedFrame& mapped)
{
  if (!frame.cloud)
    badParameter("frame ", frame.number, ": has no cloud");
  const pcl::PointCloud<pcl::PointXYZRGB>& cloud = *frame.cloud;
  if (camera_ && cloud.empty()) { // a frame without depth
    mapped.cloud = pcl::make_shared<pcl::PointCloud<pcl::PointXYZRGB>>(
        std::uint32_t(camera_->width), std::uint32_t(camera_->height));
    eraseZeros(*mapped.cloud);
    mapped.image = imageOfCloud(*mapped.cloud);
    return;
  }
  if (camera_) {
    requireSizeOfCamera(cloud, frame.number);
    mapped.image = imageOfCloud(cloud);
  }
  mapped.cloud = frame.cloud;
  if (std::any_of(cloud.begin(), cloud.end(), isAtZero<pcl::PointXYZRGB>)) {
    mapped.cloud = pcl::make_shared<pcl::PointCloud<pcl::PointXYZRGB>>(cloud);
    eraseZeros(*mapped.cloud);
  }
  mapped.has_colour = frame.has_colour;
  if (isLabelledAt(frames_))
    mapped.network = frame.distributions;
}

// Adds a labelled cloud with its pose to the map.
void
SemanticMapper::fuse(MappedFrame& mapped)
{
  StageTimes& times = mapped.times;
  if (calibration_ && !mapped.network.empty())
    times.measure("calibration", [&] { calibrateLabels(mapped); });
  mapped.counts = times.measure("map", [&] { return integrate(mapped); });
  mapped.voxels = times.measure("voxels", [&] { return map_.occupied(); });
  refined_ = isRefinedAt(frames_);
  cliques_->setFrame(mapped.cloud, mapped.T_world_camera); // finish() may need it
  if (config_.crf != CRFModelType::unary && refined_)
    times.measure("crf", [&] {
      refineVoxels(mapped.voxels);
      map_.setRefined(mapped.voxels, mapped.voxels.refined, config_.crf_write_back);
    });
  if (objects_)
    times.measure("things", [&] {
      objects_->update(mapped.voxels, map_.window(), mapped.frame);
      numberObjects(mapped.voxels);
    });
  ++frames_;
  if (callback_)
    callback_(mapped, map_);
}

void
SemanticMapper::numberObjects(VoxelCloud& voxels)
{
  has_new_labels_ = false;
  if (!objects_->leftVoxels().empty()) {
    map_.setFree(objects_->leftVoxels());
    voxels = map_.occupied();
  }
  voxels.objects = objects_->numbers(voxels);
}

void
SemanticMapper::finish()
{
  const ThreadScope threads(config_.threads);
  if (!refined_) {
    VoxelCloud voxels = map_.occupied();
    refineVoxels(voxels);
    map_.setRefined(voxels, voxels.refined);
    refined_ = has_new_labels_ = true;
  }
  if (objects_ && has_new_labels_) {
    VoxelCloud voxels = map_.occupied();
    objects_->updateLabels(voxels, map_.window());
    numberObjects(voxels);
  }
}

void
SemanticMapper::calibrateLabels(MappedFrame& mapped) const
{
  const auto features =
      frameFeatures(*mapped.cloud, mapped.network, calibration_->ground);
  mapped.domain_shift = domainShift(*calibration_, mapped.network, features);
  mapped.calibrated = calibrate(*calibration_, mapped.network, features);
}

void
SemanticMapper::addLabels(const MappedFrame& earlier, LabelDistributions labels)
{
  const ThreadScope threads(config_.threads);
  if (std::size_t(labels.size()) != earlier.cloud->size())
    badParameter("labels of ", labels.size(), " pixels, expected ",
                 earlier.cloud->size());
  MappedFrame frame;
  frame.cloud = earlier.cloud;
  frame.network = std::move(labels);
  frame.T_world_camera = earlier.T_world_camera;
  if (calibration_)
    calibrateLabels(frame);
  std::size_t erased = 0;
  const auto cloud = withoutSeenThrough(frame, erased);
  map_.addLabels(*cloud, frame.T_world_camera,
                 calibration_ ? frame.calibrated : frame.network);
  refined_ = config_.crf == CRFModelType::unary;
  has_new_labels_ = true;
}

// Returns the points to add to the map.
pcl::PointCloud<pcl::PointXYZRGB>::Ptr
SemanticMapper::withoutSeenThrough(const MappedFrame& mapped, std::size_t& erased) const
{
  if (!camera_ || config_.min_hit_ratio <= 0.0)
    return mapped.cloud;
  auto cloud = pcl::make_shared<pcl::PointCloud<pcl::PointXYZRGB>>(*mapped.cloud);
  erased = eraseSeenThrough(*cloud, *camera_, mapped.T_world_camera,
                            map_.parameters().voxel_size, config_.min_hit_ratio);
  return cloud;
}

// Of a stereo pair; RGB-D and lidar are exact enough.
void
SemanticMapper::setDepthError(const SensorFrame& frame)
{
  const bool is_stereo = camera_ && !std::holds_alternative<RgbdFrame>(frame);
  map_.setDepthError(is_stereo ? camera_->depthError() : 0.0);
}

ScanCounts
SemanticMapper::integrate(const MappedFrame& mapped)
{
  std::vector<float> deviations;
  if (config_.deviation_scale > 0.0)
    deviations = distanceDeviations(*mapped.cloud, *camera_, mapped.disparity.deviation,
                                    config_.deviation_scale);
  const LabelDistributions& labels = calibration_ ? mapped.calibrated : mapped.network;
  try {
    std::size_t erased = 0;
    const auto cloud = withoutSeenThrough(mapped, erased);
    ScanCounts counts;
    if (mapped.has_colour)
      counts = map_.integrate(*cloud, mapped.T_world_camera, labels, deviations);
    else {
      pcl::PointCloud<pcl::PointXYZ> positions;
      pcl::copyPointCloud(*cloud, positions);
      counts = map_.integrate(positions, mapped.T_world_camera, labels, deviations);
    }
    counts.invalid -= erased; // seen-through points had a depth
    counts.seen_through = erased;
    return counts;
  }
  catch (const BadInputException& error) { // the map does not number frames
    badInput("frame ", mapped.frame.number, ": ", error.what());
  }
}

void
SemanticMapper::refineVoxels(VoxelCloud& voxels)
{
  if (config_.crf_write_back)
    voxels.is_refined.clear(); // a run changes the prior of all later ones
  SemanticCRFParameters parameters = config_.crf_parameters;
  if (parameters.sensor == PointSensor::automatic && map_.depthError() > 0.0)
    parameters.sensor = PointSensor::stereo;
  const CrfRegion region = crfRegion(voxels, crfReach(parameters, voxels.voxel_size));
  if (region.updated.empty())
    return;
  SemanticCRF<pcl::PointXYZRGBL> crf;
  crf.setModel(config_.crf);
  if (config_.crf != CRFModelType::dense) {
    crf.setCliques(cliques_->generate(voxels));
  }
  if (config_.crf_write_back)
    parameters.temperature = 1.0; // tempering would weaken the next prior
  crf.setParameters(parameters);
  refineRegion(crf, map_.labelSet(), region, voxels);
}

} // namespace pcl_semantic
