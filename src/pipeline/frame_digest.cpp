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

void
addData(const StereoFrame& pair, Digest& digest)
{
  addImage(pair.left, digest);
  addImage(pair.right, digest);
}

template <typename Frame>
void
addData(const Frame& frame, Digest& digest)
{
  for (const pcl::PointXYZRGB& point : *frame.cloud) {
    digest.add(point.data, 3 * sizeof(float));
    digest.addWord(point.rgba);
  }
}

} // namespace

FrameDigest
digestOf(const SensorFrame& frame, const LabelDistributions& labels)
{
  Digest digest;
  std::visit([&](const auto& each) { addData(each, digest); }, frame);
  return {digest.value(), digestOf(labels)};
}

} // namespace pcl_semantic
