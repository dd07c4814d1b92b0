// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/pipeline/frame_digest.h>

#include "core/digest.h"

namespace pcl_semantic {

namespace {

void
addImage(const cv::Mat& image, Digest& digest)
{
  digest.addWord(std::uint64_t(image.type()));
  for (int row = 0; row < image.rows; ++row)
    digest.add(image.ptr(row), std::size_t(image.cols) * image.elemSize());
}

std::uint64_t
digestOf(const LabelDistributions& labels)
{
  if (labels.empty())
    return 0;
  Digest digest;
  digest.add(labels.matrix().data(),
             std::size_t(labels.matrix().size()) * sizeof(float));
  return digest.value();
}

} // namespace

FrameDigest
digestOf(const StereoFrame& pair, const LabelDistributions& labels)
{
  Digest digest;
  addImage(pair.left, digest);
  addImage(pair.right, digest);
  return {digest.value(), digestOf(labels)};
}

FrameDigest
digestOf(const pcl::PointCloud<pcl::PointXYZRGB>& cloud,
         const LabelDistributions& labels)
{
  Digest digest;
  for (const pcl::PointXYZRGB& point : cloud) {
    digest.add(point.data, 3 * sizeof(float));
    digest.addWord(point.rgba);
  }
  return {digest.value(), digestOf(labels)};
}

} // namespace pcl_semantic
