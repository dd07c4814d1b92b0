// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/stereo/disparity_to_cloud.h>

#include "core/cloud_size.h"
#include "core/fail.h"
#include "images/grey_image.h"

#include <cmath>
#include <limits>

namespace pcl_semantic {

namespace {

void
checkImages(const cv::Mat& disparity, const cv::Mat& image, const StereoCamera& camera)
{
  if (disparity.empty() || disparity.type() != CV_32FC1)
    badInput("disparity image: expected one channel of 32-bit floats");
  if (image.type() != CV_8UC1 && image.type() != CV_8UC3)
    badInput("image of a disparity: expected 8-bit grey or 8-bit colour");
  if (image.size() != disparity.size())
    badInput("image is ", image.cols, " x ", image.rows, " pixels, its disparity ",
             disparity.cols, " x ", disparity.rows);
  const bool known = camera.width != 0 || camera.height != 0;
  if (known && (camera.width != image.cols || camera.height != image.rows))
    badInput("image is ", image.cols, " x ", image.rows, " pixels, the camera's ",
             camera.width, " x ", camera.height);
}

} // namespace

pcl::PointCloud<pcl::PointXYZRGB>::Ptr
disparityToCloud(const cv::Mat& disparity, const cv::Mat& image,
                 const StereoCamera& camera)
{
  camera.validate();
  checkImages(disparity, image, camera);
  const cv::Mat bgr = colourImage(image);
  pcl::PointCloud<pcl::PointXYZRGB>::Ptr cloud(new pcl::PointCloud<pcl::PointXYZRGB>(
      static_cast<std::uint32_t>(image.cols), static_cast<std::uint32_t>(image.rows)));
  cloud->is_dense = false;
  for (int v = 0; v < image.rows; ++v)
    for (int u = 0; u < image.cols; ++u) {
      pcl::PointXYZRGB& point = cloud->at(u, v);
      const cv::Vec3b& colour = bgr.at<cv::Vec3b>(v, u);
      point.b = colour[0];
      point.g = colour[1];
      point.r = colour[2];
      const float d = disparity.at<float>(v, u);
      if (!std::isfinite(d) || d < 0.0f)
        badInput("disparity of pixel (", u, ", ", v, ") is ", d,
                 ", expected 0 or more");
      if (d > 0.0f)
        point.getVector3fMap() = camera.unproject(u, v, camera.depth(d)).cast<float>();
      else
        point.getVector3fMap().setConstant(std::numeric_limits<float>::quiet_NaN());
    }
  return cloud;
}

cv::Mat
imageOfCloud(const pcl::PointCloud<pcl::PointXYZRGB>& cloud)
{
  requireCloudSize(cloud);
  cv::Mat3b image(int(cloud.height), int(cloud.width));
  for (std::size_t i = 0; i < cloud.size(); ++i)
    image(int(i / cloud.width), int(i % cloud.width)) = {cloud[i].b, cloud[i].g,
                                                         cloud[i].r};
  return image;
}

std::vector<float>
distanceDeviations(const pcl::PointCloud<pcl::PointXYZRGB>& cloud,
                   const StereoCamera& camera, const cv::Mat& disparity_deviation,
                   double scale)
{
  requireCloudSize(cloud);
  if (disparity_deviation.type() != CV_32FC1 ||
      disparity_deviation.cols != int(cloud.width) ||
      disparity_deviation.rows != int(cloud.height))
    badInput("the deviations of the disparities are no 32-bit image of ", cloud.width,
             " x ", cloud.height, " pixels");
  if (!(scale >= 0.0 && std::isfinite(scale)))
    badParameter("the scale of deviations is ", scale, ", expected 0 or more");
  const float fraction = float(scale / (camera.fx * camera.baseline));
  std::vector<float> deviations(cloud.size(), 0.0f);
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (cloud[i].getVector3fMap().allFinite())
      deviations[i] =
          cloud[i].getVector3fMap().norm() * cloud[i].z * fraction *
          disparity_deviation.at<float>(int(i / cloud.width), int(i % cloud.width));
  return deviations;
}

} // namespace pcl_semantic
