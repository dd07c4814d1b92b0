// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/images/image_file.h>
#include <pcl_semantic/stereo/disparity_engines.h>
#include <pcl_semantic/superpixels/slic.h>

int
main()
{
  const cv::Mat image(20, 30, CV_8UC3, cv::Scalar(0, 0, 0));
  return pcl_semantic::slicSuperpixels(image, {}).size() == image.size() ? 0 : 1;
}
