// SPDX-License-Identifier: BSD-3-Clause
#include "label_carrier.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/dataset/kitti_sequence.h>
#include <pcl_semantic/files/trajectory_file.h>
#include <pcl_semantic/labelling/carried_labels.h>

#include <map>

namespace pcl_semantic::tool {

namespace {

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
    images_.emplace(images.files.left, readPinholeCamera(images.files.calibration));
  else {
    const KittiSequence kitti(images.folder);
    std::map<int, std::string> paths;
    for (std::size_t i = 0; i < kitti.size(); ++i)
      paths[kitti.frameNumber(i)] = kitti.leftPath(i);
    images_.emplace(std::move(paths), kitti.camera(), images.folder);
    if (sensor_pose.empty())
      T_camera_sensor_ =
          kitti.T_camera0_camera().inverse() * kitti.T_camera0_velodyne();
  }
  if (!sensor_pose.empty())
    T_camera_sensor_ = readSensorPose(sensor_pose);
}

void
LabelCarrier::requireImage(const std::string& cloud, int frame) const
{
  if (!images_->has(frame))
    PCL_THROW_EXCEPTION(BadInputException,
                        cloud << ": the camera has no image of frame " << frame);
}

LabelDistributions
LabelCarrier::label(const pcl::PointCloud<pcl::PointXYZRGBL>& cloud, int frame,
                    LabelPredictor& predictor) const
{
  StereoFrame seen;
  seen.number = frame;
  seen.left = images_->image(frame);
  return carryLabels(predictor.predict(seen), images_->camera(),
                     seenPoints(pointsInCamera(cloud, T_camera_sensor_),
                                images_->camera(), visibility_));
}

} // namespace pcl_semantic::tool
