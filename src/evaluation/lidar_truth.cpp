// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/evaluation/lidar_truth.h>

#include "core/fail.h"

#include <limits>

namespace pcl_semantic {

std::vector<float>
seenDepths(const pcl::PointCloud<pcl::PointXYZI>& scan, const StereoCamera& camera,
           const Eigen::Isometry3d& T_camera_scanner,
           const VisibilityParameters& parameters)
{
  std::vector<float> depths;
  depths.reserve(scan.size());
  for (const SeenPoint& p :
       seenPoints(pointsInCamera(scan, T_camera_scanner), camera, parameters))
    depths.push_back(p.depth);
  return depths;
}

LidarTruth
projectLidarTruth(const pcl::PointCloud<pcl::PointXYZI>& scan,
                  const std::vector<Label>& labels, const StereoCamera& camera,
                  const Eigen::Isometry3d& T_camera_scanner,
                  const VisibilityParameters& parameters)
{
  if (labels.size() != scan.size())
    badParameter("there are ", labels.size(), " labels for ", scan.size(), " points");
  const std::vector<SeenPoint> seen =
      seenPoints(pointsInCamera(scan, T_camera_scanner), camera, parameters);
  cv::Mat1b truth(camera.height, camera.width, kUnlabelled);
  cv::Mat1f nearest(camera.height, camera.width,
                    std::numeric_limits<float>::infinity());
  for (std::size_t i = 0; i < scan.size(); ++i) {
    const SeenPoint& p = seen[i];
    if (p.depth == 0.0f || p.depth >= nearest(p.row, p.column))
      continue; // also of equally near returns the later one
    nearest(p.row, p.column) = p.depth;
    truth(p.row, p.column) = labels[i];
  }
  cv::Mat1f depth(camera.height, camera.width, 0.0f);
  nearest.copyTo(depth, truth);
  return {truth, depth};
}

} // namespace pcl_semantic
