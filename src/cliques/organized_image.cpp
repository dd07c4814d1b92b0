// SPDX-License-Identifier: BSD-3-Clause
#include "organized_image.h"

#include <pcl_semantic/core/exceptions.h>

namespace pcl_semantic {

cv::Mat
imageOf(const CliqueGenerator::Cloud& cloud)
{
  if (!cloud.empty() && !cloud.isOrganized())
    PCL_THROW_EXCEPTION(BadInputException,
                        "superpixels need an organized cloud, an image of points; this "
                        "one is a list of "
                            << cloud.size());
  cv::Mat image(int(cloud.height), int(cloud.width), CV_8UC3);
#pragma omp parallel for schedule(static)
  for (int v = 0; v < image.rows; ++v) {
    cv::Vec3b* const row = image.ptr<cv::Vec3b>(v);
    const pcl::PointXYZRGB* const points = &cloud(0, std::size_t(v));
    for (int u = 0; u < image.cols; ++u)
      row[u] = {points[u].b, points[u].g, points[u].r};
  }
  return image;
}

} // namespace pcl_semantic
