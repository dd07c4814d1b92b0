// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/dataset/rgbd_frame.h>

#include "core/fail.h"
#include "images/grey_image.h"

#include <pcl/memory.h>

#include <cmath>
#include <cstdint>
#include <limits>

namespace pcl_semantic {

RgbdFrame
rgbdFrameOf(const cv::Mat& image, const cv::Mat1d& depths, const StereoCamera& camera,
            double max_depth)
{
  const cv::Size size(camera.width, camera.height);
  if (image.size() != size || depths.size() != size)
    badParameter("the image has ", image.cols, " x ", image.rows,
                 " pixels and the depths ", depths.cols, " x ", depths.rows,
                 ", expected ", size.width, " x ", size.height, " as the camera's");
  if (image.type() != CV_8UC3 && image.type() != CV_8UC1)
    badParameter("the image is neither 8-bit grey nor 8-bit colour");
  RgbdFrame frame;
  frame.image = colourImage(image);
  frame.cloud = pcl::make_shared<pcl::PointCloud<pcl::PointXYZRGB>>(
      std::uint32_t(size.width), std::uint32_t(size.height));
  frame.cloud->is_dense = false;
  constexpr float none = std::numeric_limits<float>::quiet_NaN();
  for (int v = 0; v < size.height; ++v)
    for (int u = 0; u < size.width; ++u) {
      pcl::PointXYZRGB& point = (*frame.cloud)(u, v);
      const double z = depths(v, u);
      const bool is_measured = std::isfinite(z) && z > 0.0;
      frame.unmeasured += !is_measured;
      if (is_measured && (max_depth == 0.0 || z <= max_depth))
        point.getVector3fMap() << float((u - camera.cx) / camera.fx * z),
            float((v - camera.cy) / camera.fy * z), float(z);
      else
        point.getVector3fMap().setConstant(none);
      const auto& bgr = frame.image.at<cv::Vec3b>(v, u);
      point.b = bgr[0];
      point.g = bgr[1];
      point.r = bgr[2];
    }
  return frame;
}

} // namespace pcl_semantic
