// SPDX-License-Identifier: BSD-3-Clause
#include "labels.h"

#include "core/fail.h"
#include "noise.h"

#include <opencv2/core.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace pcl_semantic {

namespace {

using Eigen::Vector3d;
using synthetic::fractalNoise;
using synthetic::valueNoise;

/** \brief A typical mistake of networks. */
struct Confusion {
  Label truth;
  Label taken_for;
  double weight; ///< probability: shifts the threshold of its noise
};

constexpr std::array<Confusion, 16> kStreetConfusions{{
    {synthetic_sidewalk, synthetic_road, 0.34},
    {synthetic_sidewalk, synthetic_vegetation, 0.05},
    {synthetic_road, synthetic_sidewalk, 0.10},
    {synthetic_road, synthetic_car, -0.05},
    {synthetic_building, synthetic_vegetation, 0.10},
    {synthetic_building, synthetic_fence, 0.08},
    {synthetic_vegetation, synthetic_building, 0.08},
    {synthetic_vegetation, synthetic_fence, 0.10},
    {synthetic_fence, synthetic_vegetation, 0.24},
    {synthetic_fence, synthetic_building, 0.22},
    {synthetic_car, synthetic_building, 0.02},
    {synthetic_car, synthetic_road, 0.00},
    {synthetic_sign, synthetic_building, 0.30},
    {synthetic_pole, synthetic_building, 0.30},
    {synthetic_pedestrian, synthetic_vegetation, 0.25},
    {synthetic_sky, synthetic_building, -0.12},
}};

constexpr std::array<Confusion, 26> kRoomConfusions{{
    {room_bed, room_sofa, 0.10},          {room_bed, room_objects, -0.05},
    {room_books, room_objects, 0.12},     {room_books, room_furniture, 0.05},
    {room_ceiling, room_wall, -0.02},     {room_chair, room_table, 0.08},
    {room_chair, room_furniture, 0.05},   {room_floor, room_furniture, -0.04},
    {room_floor, room_objects, -0.08},    {room_furniture, room_table, 0.05},
    {room_furniture, room_wall, 0.00},    {room_furniture, room_bed, -0.05},
    {room_objects, room_furniture, 0.10}, {room_objects, room_books, 0.02},
    {room_picture, room_wall, 0.12},      {room_picture, room_window, 0.02},
    {room_sofa, room_bed, 0.10},          {room_sofa, room_chair, 0.05},
    {room_table, room_furniture, 0.10},   {room_table, room_chair, 0.00},
    {room_tv, room_window, 0.05},         {room_tv, room_picture, 0.02},
    {room_wall, room_furniture, -0.02},   {room_wall, room_window, -0.05},
    {room_window, room_wall, 0.08},       {room_window, room_picture, 0.00},
}};

/** \brief Input of the simulated network, and its typical mistakes. */
struct Seen {
  int frame = 0;
  cv::Mat image;  ///< CV_8UC3 (BGR)
  cv::Mat labels; ///< CV_8UC1, true labels
  cv::Mat depth;  ///< CV_64FC1 [m], 0 = sky
  StereoCamera camera;
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  int classes = 0;
  const Confusion* begin = nullptr; ///< typical mistakes
  const Confusion* end = nullptr;
  double fixed_scale = 1.0; ///< of the mistakes that are fixed in the world [1/m]
  double far = 1.0;         ///< depth at which labels are worst [m]
  double slope = 1.0;       ///< of the mistakes' ease with the noise
};

/** \brief Properties of a pixel that affect its mistakes. */
struct Position {
  Vector3d image;      ///< column, row [units of image width / 100], 0
  Vector3d world;      ///< [m]
  double dark = 0.0;   ///< 0 lit, 1 dark
  double border = 0.0; ///< 1 near another class
  double far = 0.0;    ///< 0 near, 1 beyond Seen::far
};

class NoisyLabels {
public:
  NoisyLabels(const Seen& view, std::uint32_t seed, double noise)
      : view_(view), seed_(synthetic::hash(seed, 0x1abe1)),
        frame_seed_(synthetic::hash(seed, 0x1abe1, view.frame + 1)), noise_(noise),
        unit_(view.labels.cols / 100.0)
  {}

  /** \brief Most probable label of every pixel, including mistakes. */
  cv::Mat
  draw() const
  {
    cv::Mat labels(view_.labels.size(), CV_8UC1);
#pragma omp parallel for schedule(dynamic, 4)
    for (int v = 0; v < labels.rows; ++v)
      for (int u = 0; u < labels.cols; ++u)
        labels.at<Label>(v, u) = mistake(wander(u, v), u, v);
    return labels;
  }

private:
  Label
  truthAt(double u, double v) const
  {
    const int column =
        std::clamp(static_cast<int>(std::lround(u)), 0, view_.labels.cols - 1);
    const int row =
        std::clamp(static_cast<int>(std::lround(v)), 0, view_.labels.rows - 1);
    return view_.labels.at<Label>(row, column);
  }

  Vector3d
  imagePosition(int u, int v) const
  {
    return {u / unit_, v / unit_, 0.0};
  }

  /** \brief The true label of a nearby pixel: borders shift by up to a hundredth of the
   * image width, more than the width of most poles. */
  Label
  wander(int u, int v) const
  {
    const Vector3d position = imagePosition(u, v);
    const double reach = 1.7 * noise_ * unit_;
    const double du = fractalNoise(position, 3.5, frame_seed_ + 10);
    const double dv = fractalNoise(position, 3.5, frame_seed_ + 20);
    return truthAt(u + reach * du, v + 0.7 * reach * dv);
  }

  Position
  positionOf(int u, int v, Label label) const
  {
    Position position;
    position.image = imagePosition(u, v);
    const double depth = view_.depth.at<double>(v, u);
    if (depth > 0.0) {
      position.world = view_.T_world_camera * view_.camera.unproject(u, v, depth);
      position.far = std::min(1.0, depth / view_.far);
    }
    else
      position.world = position.image;
    const cv::Vec3b& pixel = view_.image.at<cv::Vec3b>(v, u);
    position.dark =
        std::clamp(1.5 - (pixel[0] + pixel[1] + pixel[2]) / 160.0, 0.0, 1.0);
    for (int k = 0; k < 8; ++k) {
      constexpr std::array<int, 10> ring{2, 0, -2, 0, 2, 2, -2, -2, 2, 0};
      if (truthAt(u + unit_ * ring[k], v + 0.7 * unit_ * ring[k + 1]) != label)
        position.border += 0.125;
    }
    return position;
  }

  /** \brief Replaces the label if the noise of a mistake is high. */
  Label
  mistake(Label label, int u, int v) const
  {
    if (noise_ == 0.0)
      return label;
    const Position position = positionOf(u, v, label);
    for (int k = 0; k < view_.end - view_.begin; ++k) {
      const Confusion& confusion = view_.begin[k];
      if (confusion.truth != label)
        continue;
      const std::uint32_t number = static_cast<std::uint32_t>(100 * (k + 1));
      const double blob =
          0.75 * fractalNoise(position.image, 6.0, frame_seed_ + number) +
          0.35 * (1.0 - 0.6 * position.far) *
              valueNoise(position.world * view_.fixed_scale, seed_ + number);
      const double ease = view_.slope * (noise_ - 1.0) + confusion.weight +
                          0.12 * position.dark + 0.14 * position.border +
                          0.12 * position.far;
      if (blob + ease > 0.22)
        return confusion.taken_for;
    }
    return label;
  }

  const Seen& view_;
  std::uint32_t seed_;
  std::uint32_t frame_seed_;
  double noise_;
  double unit_; ///< hundredth of the image width [px]
};

/** \brief Blurs a plane by the binomial 1 4 6 4 1 along a direction: the output of
 * networks has a lower resolution than the image. Written explicitly for equal rounding
 * on every machine. */
void
blurAlong(int du, int dv, const cv::Mat& plane, cv::Mat& blurred)
{
  constexpr std::array<float, 5> weights{0.0625f, 0.25f, 0.375f, 0.25f, 0.0625f};
#pragma omp parallel for
  for (int v = 0; v < plane.rows; ++v)
    for (int u = 0; u < plane.cols; ++u) {
      float sum = 0.0f;
      for (int k = -2; k <= 2; ++k) {
        const int row = std::clamp(v + k * dv, 0, plane.rows - 1);
        const int column = std::clamp(u + k * du, 0, plane.cols - 1);
        sum += weights[k + 2] * plane.ptr<float>(row)[column];
      }
      blurred.ptr<float>(v)[u] = sum;
    }
}

/** \brief Distributions of certain labels, softened at borders. */
LabelDistributions
softened(const cv::Mat& labels, int classes, bool soft)
{
  const Eigen::Index count = static_cast<Eigen::Index>(labels.total());
  LabelDistributions result(classes, count);
  cv::Mat plane(labels.size(), CV_32FC1);
  cv::Mat across(labels.size(), CV_32FC1);
  for (int k = 0; k < classes; ++k) {
    for (Eigen::Index i = 0; i < count; ++i)
      plane.ptr<float>()[i] = labels.ptr<Label>()[i] == k + 1 ? 1.0f : 0.0f;
    if (soft) {
      blurAlong(1, 0, plane, across);
      blurAlong(0, 1, across, plane);
    }
    for (Eigen::Index i = 0; i < count; ++i)
      result.column(i)[k] = plane.ptr<float>()[i];
  }
  return result;
}

/** \brief Adds doubt to a column, mostly towards classes that are often confused with
 * the label.
 * \param[in] doubt fraction of the probability to move */
void
spread(const Seen& view, float* column, Label label, float doubt)
{
  float total = 0.0f;
  std::array<float, std::max(int(synthetic_classes), int(room_classes))> others;
  others.fill(0.15f);
  for (const Confusion* confusion = view.begin; confusion != view.end; ++confusion)
    if (confusion->truth == label)
      others[confusion->taken_for - 1] += 1.0f;
  for (int k = 0; k < view.classes; ++k)
    total += others[k];
  for (int k = 0; k < view.classes; ++k)
    column[k] = (1.0f - doubt) * column[k] + doubt * others[k] / total;
}

LabelDistributions
distributionsOf(const Seen& view, std::uint32_t seed, double label_noise)
{
  if (!(label_noise >= 0.0 && label_noise <= 1.0))
    fail<InvalidParameterException>("label noise ", label_noise, ", expected 0 to 1");
  const cv::Mat labels = NoisyLabels(view, seed, label_noise).draw();
  const int width = labels.cols;
  LabelDistributions result = softened(labels, view.classes, label_noise > 0.0);
  const std::uint32_t doubt_seed = synthetic::hash(seed, 0xd0b7, view.frame);
#pragma omp parallel for
  for (Eigen::Index i = 0; i < result.size(); ++i) {
    const Vector3d position(100.0 * (i % width) / width, 100.0 * (i / width) / width,
                            0.0);
    const double unsure = 0.5 + 0.5 * valueNoise(position / 5.0, doubt_seed);
    spread(view, result.column(i), labels.ptr<Label>()[i],
           static_cast<float>(0.04 + 0.5 * label_noise * unsure));
  }
  result.normalize();
  return result;
}

} // namespace

LabelDistributions
syntheticDistributions(const SyntheticView& view, std::uint32_t seed,
                       double label_noise)
{
  cv::Mat depth(view.disparity.size(), CV_64FC1, cv::Scalar(0.0));
  for (std::size_t i = 0; i < depth.total(); ++i)
    if (const float disparity = view.disparity.ptr<float>()[i]; disparity > 0.0f)
      depth.ptr<double>()[i] = view.camera.depth(disparity);
  return distributionsOf({view.frame, view.left, view.labels, depth, view.camera,
                          view.T_world_camera, synthetic_classes,
                          kStreetConfusions.begin(), kStreetConfusions.end(), 0.6, 40.0,
                          0.75},
                         seed, label_noise);
}

LabelDistributions
syntheticDistributions(const RoomView& view, std::uint32_t seed, double label_noise)
{
  cv::Mat depth;
  view.depth.convertTo(depth, CV_64FC1);
  return distributionsOf({view.frame, view.colour, view.labels, depth, view.camera,
                          view.T_world_camera, room_classes, kRoomConfusions.begin(),
                          kRoomConfusions.end(), 2.0, 6.0, 0.35},
                         seed, label_noise);
}

} // namespace pcl_semantic
