// SPDX-License-Identifier: BSD-3-Clause
#include "clique_frame.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/quantized_point.h>
#include <pcl_semantic/dataset/kitti_calibration.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/files/trajectory_file.h>
#include <pcl_semantic/io/labelled_cloud_file.h>
#include <pcl_semantic/odometry/pose_source.h>

#include <pcl/common/io.h>
#include <pcl/common/point_tests.h>

namespace pcl_semantic::tool {

namespace {

Eigen::Isometry3d
poseOfRow(const std::string& text, const std::string& calibration)
{
  const std::size_t colon = text.rfind(':');
  const std::string path = text.substr(0, colon);
  const double row = parseNumber(text.substr(colon + 1), "--pose '" + text + "'");
  const Trajectory trajectory = readKittiTrajectory(path);
  if (!(row >= 0.0 && row < double(trajectory.size())) || row != std::floor(row))
    PCL_THROW_EXCEPTION(BadInputException, path << ": has no pose " << row
                                                << ", but rows 0 to "
                                                << double(trajectory.size()) - 1.0);
  Eigen::Isometry3d T_camera0_camera = Eigen::Isometry3d::Identity();
  if (!calibration.empty())
    T_camera0_camera =
        readKittiCalibration(calibration, KittiCameras::colour).T_camera0_camera;
  return worldFromFirstCamera() * trajectory[std::size_t(row)] * T_camera0_camera;
}

std::vector<double>
numbersOfPose(const std::string& text)
{
  try {
    return parseNumbers(text, "--pose");
  }
  catch (const BadInputException& error) { // no file has them
    PCL_THROW_EXCEPTION(InvalidParameterException, error.what());
  }
}

} // namespace

Eigen::Isometry3d
poseOf(const std::string& text, const std::string& calibration)
{
  if (text.find(':') != std::string::npos)
    return poseOfRow(text, calibration);
  const std::vector<double> numbers = numbersOfPose(text);
  if (numbers.size() != 7)
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "--pose has " << numbers.size()
                                      << " numbers, expected x y z qx qy qz qw, or a "
                                         "trajectory and its row: FILE:N");
  const Eigen::Quaterniond turn(numbers[6], numbers[3], numbers[4], numbers[5]);
  if (!(std::abs(turn.norm() - 1.0) <= 1e-2))
    PCL_THROW_EXCEPTION(InvalidParameterException, "--pose has a quaternion of length "
                                                       << turn.norm()
                                                       << ", expected 1");
  return Eigen::Translation3d(numbers[0], numbers[1], numbers[2]) * turn.normalized();
}

void
setFrame(const CliqueFrame& frame, const std::string& name,
         const CliqueGenerator::Cloud& points, SuperpixelCliques& generator)
{
  generator.setVoxels({}, frame.voxel_size); // checks the size
  const LabelledCloud read = readLabelledCloud(frame.path);
  if (!read.has_colour)
    PCL_THROW_EXCEPTION(BadInputException,
                        frame.path << ": superpixels need points with rgb or rgba");
  if (!read.cloud->isOrganized())
    PCL_THROW_EXCEPTION(BadInputException,
                        frame.path << ": superpixels need an organized cloud");
  const auto cloud = std::make_shared<CliqueGenerator::Cloud>();
  pcl::copyPointCloud(*read.cloud, *cloud);
  Eigen::Isometry3d T_map_camera;
  if (frame.pose.empty()) {
    T_map_camera =
        Eigen::Translation3d(cloud->sensor_origin_.head<3>().cast<double>()) *
        cloud->sensor_orientation_.cast<double>().normalized();
  }
  else {
    T_map_camera = poseOf(frame.pose, frame.calibration);
    T_map_camera.pretranslate(-frame.map_origin);
  }
  std::vector<VoxelIndex> voxels;
  for (const pcl::PointXYZRGB& point : points) {
    const Eigen::Vector3d place = point.getVector3fMap().cast<double>();
    const bool is_near =
        (place.array().abs() < kMaxVoxelIndex * frame.voxel_size).all(); // not NaN
    if (pcl::isXYZFinite(point) && !is_near)
      PCL_THROW_EXCEPTION(BadInputException, name << ": point " << voxels.size()
                                                  << " lies at " << place.transpose()
                                                  << " m, in no voxel");
    voxels.push_back(is_near ? voxelOf(quantize(place, frame.voxel_size))
                             : VoxelIndex::Constant(kMaxVoxelIndex));
  }
  generator.setVoxels(voxels, frame.voxel_size);
  generator.setFrame(cloud, T_map_camera);
}

} // namespace pcl_semantic::tool
