/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/grey_image.h>
#include <pcl_semantic/io/map_pictures.h>

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace pcl_semantic {

namespace {

const cv::Scalar background(24, 24, 24);
const cv::Scalar text_colour(235, 235, 235);

cv::Vec3b
bgr(const LabelClass& label_class)
{
  return {label_class.colour[2], label_class.colour[1], label_class.colour[0]};
}

void
drawText(cv::Mat& picture, const std::string& text, cv::Point at)
{
  cv::putText(picture, text, at, cv::FONT_HERSHEY_SIMPLEX, 0.45, text_colour, 1,
              cv::LINE_AA);
}

// A strip of swatches and names, as many rows as the width needs.
cv::Mat
drawLegend(const LabelSet& label_set, int width)
{
  constexpr int row_height = 24, swatch = 14, gap = 8;
  struct Entry {
    cv::Point at;
    Label label;
  };
  std::vector<Entry> entries;
  cv::Point at(gap, gap);
  for (int label = 1; label <= label_set.size(); ++label) {
    const std::string& name = label_set[Label(label)].name;
    const int text =
        cv::getTextSize(name, cv::FONT_HERSHEY_SIMPLEX, 0.45, 1, nullptr).width;
    const int advance = swatch + text + 3 * gap;
    if (at.x > gap && at.x + advance > width)
      at = {gap, at.y + row_height};
    entries.push_back({at, Label(label)});
    at.x += advance;
  }
  cv::Mat legend(at.y + row_height, width, CV_8UC3, background);
  for (const Entry& entry : entries) {
    const LabelClass& label_class = label_set[entry.label];
    cv::rectangle(legend, cv::Rect(entry.at.x, entry.at.y, swatch, swatch),
                  cv::Scalar(bgr(label_class)), cv::FILLED);
    drawText(legend, label_class.name, entry.at + cv::Point(swatch + 6, swatch - 2));
  }
  return legend;
}

// The plane of a top view: which pixel shows which column of voxels.
struct TopViewGrid {
  VoxelIndex low = VoxelIndex::Zero();
  VoxelIndex high = VoxelIndex::Zero();
  int scale = 1; // pixels a cell
  int step = 1;  // voxels a cell

  TopViewGrid(const std::vector<VoxelIndex>& indices,
              const std::vector<Eigen::Vector2d>& path) // in voxels
  {
    constexpr int smallest_side = 640, largest_side = 2400, margin = 3;
    if (!indices.empty())
      low = high = indices.front();
    for (const VoxelIndex& index : indices) {
      low = low.cwiseMin(index);
      high = high.cwiseMax(index);
    }
    for (const Eigen::Vector2d& place : path) {
      const Eigen::Vector2i cell = place.array().floor().cast<int>();
      low.head<2>() = low.head<2>().cwiseMin(cell - Eigen::Vector2i::Constant(margin));
      high.head<2>() =
          high.head<2>().cwiseMax(cell + Eigen::Vector2i::Constant(margin));
    }
    const int side = (high - low).head<2>().maxCoeff() + 1;
    scale = std::clamp(smallest_side / side, 1, 8);
    step = (side + largest_side - 1) / largest_side;
  }

  cv::Size
  size() const
  {
    const VoxelIndex extent = high - low;
    return {(extent.y() / step + 1) * scale, (extent.x() / step + 1) * scale};
  }

  // World x points up, y to the left.
  cv::Point2d
  pixel(double x, double y) const
  {
    return {(high.y() + 1 - y) / step * scale, (high.x() + 1 - x) / step * scale};
  }
};

void
drawColumns(cv::Mat& picture, const TopViewGrid& grid, const VoxelCloud& voxels,
            const LabelSet& label_set)
{
  cv::Mat highest(picture.size(), CV_32SC1,
                  cv::Scalar(std::numeric_limits<int>::min()));
  const float height = float(std::max(1, grid.high.z() - grid.low.z()));
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    const VoxelIndex& index = voxels.indices[i];
    const auto label = static_cast<Label>((*voxels.cloud)[i].label);
    const cv::Point corner((grid.high.y() - index.y()) / grid.step * grid.scale,
                           (grid.high.x() - index.x()) / grid.step * grid.scale);
    const cv::Rect square = cv::Rect(corner.x, corner.y, grid.scale, grid.scale) &
                            cv::Rect(cv::Point(), picture.size());
    if (label == kUnlabelled || square.empty() ||
        highest.at<int>(square.tl()) >= index.z())
      continue;
    highest(square) = index.z();
    const float shade = 0.75f + 0.5f * float(index.z() - grid.low.z()) / height;
    picture(square) = cv::Scalar(bgr(label_set[label])) * shade;
  }
}

// A line, and a dot where the sensor is now.
void
drawPath(cv::Mat& picture, const TopViewGrid& grid,
         const std::vector<Eigen::Vector2d>& path)
{
  const cv::Scalar red(60, 60, 255);
  cv::Point last;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const cv::Point now = grid.pixel(path[i].x(), path[i].y());
    if (i > 0)
      cv::line(picture, last, now, red, 2, cv::LINE_AA);
    last = now;
  }
  if (!path.empty())
    cv::circle(picture, last, 5, red, cv::FILLED, cv::LINE_AA);
}

void
drawScale(cv::Mat& picture, double pixels_per_metre)
{
  double metres = 1.0;
  while (metres * pixels_per_metre < 60.0)
    metres *= 10.0;
  if (metres * pixels_per_metre > 300.0)
    metres /= 2.0;
  const cv::Point left(12, picture.rows - 14);
  const cv::Point right(left.x + int(metres * pixels_per_metre), left.y);
  cv::line(picture, left, right, text_colour, 2);
  drawText(picture, cv::format("%g m", metres), left - cv::Point(0, 8));
}

} // namespace

cv::Mat
colourLabels(const cv::Mat& labels, const LabelSet& label_set)
{
  cv::Mat colours(labels.size(), CV_8UC3);
  for (int v = 0; v < labels.rows; ++v)
    for (int u = 0; u < labels.cols; ++u)
      colours.at<cv::Vec3b>(v, u) = bgr(label_set[labels.at<std::uint8_t>(v, u)]);
  return colours;
}

cv::Mat
drawOverlay(const cv::Mat& image, const cv::Mat& labels, const LabelSet& label_set)
{
  if (image.size() != labels.size() || labels.type() != CV_8UC1)
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "an overlay needs an image and labels of the same size");
  cv::Mat picture;
  cv::cvtColor(greyImage(image), picture, cv::COLOR_GRAY2BGR);
  cv::Mat blended;
  cv::addWeighted(picture, 0.45, colourLabels(labels, label_set), 0.65, 0.0, blended);
  blended.copyTo(picture, labels != kUnlabelled);
  cv::Mat result;
  cv::vconcat(picture, drawLegend(label_set, picture.cols), result);
  return result;
}

cv::Mat
drawTopView(const VoxelCloud& voxels, const std::vector<Eigen::Vector3d>& path,
            const LabelSet& label_set)
{
  std::vector<Eigen::Vector2d> path_in_voxels;
  for (const Eigen::Vector3d& position : path)
    path_in_voxels.push_back(position.head<2>() / voxels.voxel_size);
  const TopViewGrid grid(voxels.indices, path_in_voxels);
  cv::Mat picture(grid.size(), CV_8UC3, background);
  drawColumns(picture, grid, voxels, label_set);
  drawPath(picture, grid, path_in_voxels);
  drawScale(picture, grid.scale / (voxels.voxel_size * grid.step));
  cv::Mat result;
  cv::vconcat(picture, drawLegend(label_set, picture.cols), result);
  return result;
}

} // namespace pcl_semantic
