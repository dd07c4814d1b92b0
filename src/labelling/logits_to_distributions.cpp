// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/labelling/logits_to_distributions.h>

#include "core/fail.h"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace pcl_semantic {

namespace {

// Source samples and weights of one axis of a resized image.
struct BilinearAxis {
  BilinearAxis(int from, int to) : first(to), second(to), weight(to)
  {
    for (int i = 0; i < to; ++i) {
      const double position =
          std::clamp((i + 0.5) * from / to - 0.5, 0.0, static_cast<double>(from - 1));
      first[i] = static_cast<int>(position);
      second[i] = std::min(first[i] + 1, from - 1);
      weight[i] = static_cast<float>(position - first[i]);
    }
  }

  std::vector<int> first;
  std::vector<int> second;
  std::vector<float> weight; // of second
};

// Converts one image row at a time, so that all of its channels stay in the cache.
class RowConverter {
public:
  RowConverter(const cv::Mat& logits, const cv::Size& size,
               const ChannelClasses& channels)
      : logits_(logits), channels_(channels), count_(logits.size[0]),
        width_(size.width), rows_(logits.size[1], size.height),
        columns_(logits.size[2], size.width)
  {}

  std::size_t
  bufferSize() const
  {
    return std::size_t(logits_.size[2]) + std::size_t(count_ + 1) * width_;
  }

  void
  convert(int v, float* buffer, float* distributions) const
  {
    float* const values = buffer + logits_.size[2];
    for (int c = 0; c < count_; ++c)
      resizeRow(c, v, buffer, values + std::size_t(c) * width_);
    if (channels_.softmax)
      exponentiate(values, values + std::size_t(count_) * width_);
    for (int u = 0; u < width_; ++u)
      mergeChannels(values + u, distributions + std::size_t(u) * channels_.classes);
  }

private:
  void
  resizeRow(int c, int v, float* row, float* values) const
  {
    const float* const above = logits_.ptr<float>(c, rows_.first[v]);
    const float* const below = logits_.ptr<float>(c, rows_.second[v]);
    for (int x = 0; x < logits_.size[2]; ++x)
      row[x] = above[x] + rows_.weight[v] * (below[x] - above[x]);
    for (int u = 0; u < width_; ++u) {
      const float left = row[columns_.first[u]];
      values[u] = left + columns_.weight[u] * (row[columns_.second[u]] - left);
    }
  }

  // Relative to each pixel's maximum, to avoid overflow.
  void
  exponentiate(float* values, float* largest) const
  {
    std::copy_n(values, width_, largest);
    for (int c = 1; c < count_; ++c)
      for (int u = 0; u < width_; ++u)
        largest[u] = std::max(largest[u], values[std::size_t(c) * width_ + u]);
    for (int c = 0; c < count_; ++c)
      for (int u = 0; u < width_; ++u) {
        float& value = values[std::size_t(c) * width_ + u];
        value = std::exp(value - largest[u]);
      }
  }

  void
  mergeChannels(const float* values, float* distribution) const
  {
    std::fill_n(distribution, channels_.classes, 0.0f);
    float kept = 0.0f, dropped = 0.0f;
    for (int c = 0; c < count_; ++c) {
      const float value = values[std::size_t(c) * width_];
      const Label label = channels_.labels[c];
      if (label == kUnlabelled) {
        dropped += value;
        continue;
      }
      distribution[label - 1] += value;
      kept += value;
    }
    const float scale = kept > 0.0f && kept >= dropped ? 1.0f / kept : 0.0f;
    for (int k = 0; k < channels_.classes; ++k)
      distribution[k] *= scale;
  }

  const cv::Mat& logits_;
  const ChannelClasses& channels_;
  int count_;
  int width_;
  BilinearAxis rows_;
  BilinearAxis columns_;
};

void
checkArguments(const cv::Mat& logits, const cv::Size& size,
               const ChannelClasses& channels)
{
  if (logits.dims != 3 || logits.type() != CV_32FC1 || logits.empty())
    fail<InvalidParameterException>(
        "logits: expected 32-bit floats, channels x height x width");
  if (!logits.isContinuous())
    fail<InvalidParameterException>(
        "logits: got a part of an array, expected a continuous array; clone() it");
  if (std::size_t(logits.size[0]) != channels.labels.size())
    fail<InvalidParameterException>("logits have ", logits.size[0],
                                    " channels, expected ", channels.labels.size());
  if (size.width < 1 || size.height < 1)
    fail<InvalidParameterException>("logits: the image is empty");
  for (const Label label : channels.labels)
    if (label > channels.classes)
      fail<InvalidParameterException>("a channel has label ", int(label),
                                      ", expected up to ", channels.classes);
}

// Logits must be finite; probabilities must also be non-negative.
void
checkValues(const cv::Mat& logits, bool are_logits)
{
  const auto* const values = logits.ptr<float>();
  const auto count = std::int64_t(logits.total());
  const float lowest = are_logits ? -std::numeric_limits<float>::max() : 0.0f;
  const float highest = std::numeric_limits<float>::max();
  const auto isGood = [&](float value) { return value >= lowest && value <= highest; };
  std::int64_t bad = 0;
#pragma omp parallel for schedule(static) reduction(+ : bad)
  for (std::int64_t i = 0; i < count; ++i)
    bad += !isGood(values[i]);
  if (bad == 0)
    return;
  const std::int64_t first = std::find_if_not(values, values + count, isGood) - values;
  const std::int64_t pixels = std::int64_t(logits.size[1]) * logits.size[2];
  fail<BadInputException>("holds ", values[first], ", expected ",
                          are_logits ? "finite numbers" : "probabilities", ": channel ",
                          first / pixels, ", row ", first % pixels / logits.size[2],
                          ", column ", first % logits.size[2],
                          are_logits ? "" : "; are these logits?");
}

} // namespace

LabelDistributions
distributionsFromLogits(const cv::Mat& logits, const cv::Size& size,
                        const ChannelClasses& channels)
{
  checkArguments(logits, size, channels);
  checkValues(logits, channels.softmax);
  const RowConverter converter(logits, size, channels);
  LabelDistributions distributions(channels.classes,
                                   Eigen::Index(size.width) * size.height);
  std::vector<std::vector<float>> buffers(omp_get_max_threads(),
                                          std::vector<float>(converter.bufferSize()));
#pragma omp parallel for schedule(static)
  for (int v = 0; v < size.height; ++v)
    converter.convert(v, buffers[omp_get_thread_num()].data(),
                      distributions.column(Eigen::Index(v) * size.width));
  return distributions;
}

} // namespace pcl_semantic
