// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/pipeline/frame_digest.h>

#include <cstring>

namespace pcl_semantic {

namespace {

// FNV-1a, by words of 64 bits.
class Digest {
public:
  void
  add(const void* data, std::size_t size)
  {
    const auto* const bytes = static_cast<const std::uint8_t*>(data);
    std::size_t i = 0;
    for (; i + sizeof(std::uint64_t) <= size; i += sizeof(std::uint64_t)) {
      std::uint64_t word = 0;
      std::memcpy(&word, bytes + i, sizeof(word));
      addWord(word);
    }
    for (; i < size; ++i)
      addWord(bytes[i]);
    addWord(size);
  }

  void
  addWord(std::uint64_t word)
  {
    value_ = (value_ ^ word) * 0x100000001B3ull;
    value_ ^= value_ >> 32; // high bits would never reach the low ones
  }

  // Never 0, which says that nothing is known.
  std::uint64_t
  value() const
  {
    return value_ == 0 ? 1 : value_;
  }

private:
  std::uint64_t value_ = 0xCBF29CE484222325ull;
};

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
