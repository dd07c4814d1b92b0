// SPDX-License-Identifier: BSD-3-Clause
#include "label_carrier.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/dataset/camera_images.h>
#include <pcl_semantic/dataset/kitti_sequence.h>
#include <pcl_semantic/files/trajectory_file.h>
#include <pcl_semantic/labelling/carried_labels.h>

#include <algorithm>

namespace pcl_semantic::tool {

class SeeingCamera {
public:
  virtual ~SeeingCamera() = default;

  virtual const StereoCamera& camera() const = 0;

  /** \brief The frames that have an image. */
  virtual std::vector<int> frames() const = 0;

  virtual StereoFrame image(int frame) const = 0;
};

namespace {

class SequenceCamera : public SeeingCamera {
public:
  explicit SequenceCamera(const std::string& folder) : sequence_(folder) {}

  const KittiSequence&
  sequence() const
  {
    return sequence_;
  }

  const StereoCamera&
  camera() const override
  {
    return sequence_.camera();
  }

  std::vector<int>
  frames() const override
  {
    std::vector<int> numbers;
    for (std::size_t i = 0; i < sequence_.size(); ++i)
      numbers.push_back(sequence_.frameNumber(i));
    return numbers;
  }

  StereoFrame
  image(int frame) const override
  {
    const std::vector<int> numbers = frames();
    const auto found = std::find(numbers.begin(), numbers.end(), frame);
    return sequence_.frame(std::size_t(found - numbers.begin()));
  }

private:
  KittiSequence sequence_;
};

class OwnCamera : public SeeingCamera {
public:
  explicit OwnCamera(const ImagePairFiles& files)
      : images_(files.left, readPinholeCamera(files.calibration))
  {}

  const StereoCamera&
  camera() const override
  {
    return images_.camera();
  }

  std::vector<int>
  frames() const override
  {
    return images_.numbers();
  }

  StereoFrame
  image(int frame) const override
  {
    StereoFrame found;
    found.number = frame;
    found.left = images_.image(frame);
    return found;
  }

private:
  CameraImages images_;
};

Eigen::Isometry3d
readSensorPose(const std::string& path)
{
  const Trajectory poses = readKittiTrajectory(path);
  if (poses.size() != 1)
    PCL_THROW_EXCEPTION(BadInputException,
                        path << ": holds " << poses.size() << " poses, expected one");
  return poses.front();
}

} // namespace

LabelCarrier::LabelCarrier(const SequenceOptions& images,
                           const std::string& sensor_pose,
                           const VisibilityParameters& visibility)
    : visibility_(visibility)
{
  visibility.validate();
  if (!images.files.left.empty())
    camera_ = std::make_unique<OwnCamera>(images.files);
  else {
    auto camera = std::make_unique<SequenceCamera>(images.folder);
    const KittiSequence& kitti = camera->sequence();
    if (sensor_pose.empty())
      T_camera_sensor_ =
          kitti.T_camera0_camera().inverse() * kitti.T_camera0_velodyne();
    camera_ = std::move(camera);
  }
  if (!sensor_pose.empty())
    T_camera_sensor_ = readSensorPose(sensor_pose);
}

LabelCarrier::~LabelCarrier() = default;

void
LabelCarrier::requireImage(const std::string& cloud, int frame) const
{
  const std::vector<int> frames = camera_->frames();
  if (!std::count(frames.begin(), frames.end(), frame))
    PCL_THROW_EXCEPTION(BadInputException,
                        cloud << ": the camera has no image of frame " << frame);
}

LabelDistributions
LabelCarrier::label(const pcl::PointCloud<pcl::PointXYZRGBL>& cloud, int frame,
                    LabelPredictor& predictor) const
{
  std::vector<Eigen::Vector3d> points;
  points.reserve(cloud.size());
  for (const pcl::PointXYZRGBL& point : cloud)
    points.push_back(T_camera_sensor_ * point.getVector3fMap().cast<double>());
  return carryLabels(predictor.predict(camera_->image(frame)), camera_->camera(),
                     seenPoints(points, camera_->camera(), visibility_));
}

} // namespace pcl_semantic::tool
