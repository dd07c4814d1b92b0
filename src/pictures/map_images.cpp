// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/pictures/map_images.h>

#include "core/fail.h"
#include "core/label_number.h"
#include "images/grey_image.h"

#include <pcl_semantic/pictures/drawing.h>

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <limits>

namespace pcl_semantic {

namespace {

// Mapping between the pixels of a top view and columns of voxels.
struct TopViewGrid {
  VoxelIndex low = VoxelIndex::Zero();
  VoxelIndex high = VoxelIndex::Zero();
  int scale = 1; // pixels per cell
  int step = 1;  // voxels per cell

  TopViewGrid(const std::vector<VoxelIndex>& indices,
              const std::vector<Eigen::Vector2d>& path) // in voxels
  {
    constexpr int smallest_side = 640, max_side = 2400, margin = 3;
    if (!indices.empty())
      low = high = indices.front();
    for (const VoxelIndex& index : indices) {
      low = low.cwiseMin(index);
      high = high.cwiseMax(index);
    }
    for (const Eigen::Vector2d& position : path) {
      const Eigen::Array2i cell = position.array().floor().cast<int>();
      low.head<2>() = low.head<2>().array().min(cell - margin);
      high.head<2>() = high.head<2>().array().max(cell + margin);
    }
    const int side = (high - low).head<2>().maxCoeff() + 1;
    scale = std::clamp(smallest_side / side, 1, 8);
    step = (side + max_side - 1) / max_side;
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

using Shown = std::vector<bool>; // by label

// The highest labelled voxels, or those without a class in their own colours.
void
drawColumns(cv::Mat& picture, const TopViewGrid& grid, const VoxelCloud& voxels,
            const LabelSet& label_set, bool is_labelled)
{
  cv::Mat highest(picture.size(), CV_32SC1,
                  cv::Scalar(std::numeric_limits<int>::min()));
  const float height = float(std::max(1, grid.high.z() - grid.low.z()));
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    const VoxelIndex& index = voxels.indices[i];
    const auto label = requireLabel((*voxels.cloud)[i].label);
    const cv::Point corner((grid.high.y() - index.y()) / grid.step * grid.scale,
                           (grid.high.x() - index.x()) / grid.step * grid.scale);
    const cv::Rect square = cv::Rect(corner.x, corner.y, grid.scale, grid.scale) &
                            cv::Rect(cv::Point(), picture.size());
    if ((is_labelled && label == kUnlabelled) || square.empty() ||
        highest.at<int>(square.tl()) >= index.z())
      continue;
    highest(square) = index.z();
    const pcl::PointXYZRGBL& point = (*voxels.cloud)[i];
    const float shade = 0.75f + 0.5f * float(index.z() - grid.low.z()) / height;
    if (is_labelled)
      picture(square) = cv::Scalar(classColour(label_set, label)) * shade;
    else
      picture(square) = cv::Scalar(point.b, point.g, point.r);
  }
}

// A line, and a dot at the current position.
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

} // namespace

cv::Mat
drawOverlay(const cv::Mat& image, const cv::Mat& labels, const LabelSet& label_set)
{
  if (image.size() != labels.size() || labels.type() != CV_8UC1)
    badParameter("an overlay needs an image and labels of the same size");
  cv::Mat3b colours(labels.size());
  std::transform(labels.begin<Label>(), labels.end<Label>(), colours.begin(),
                 [&](Label label) { return classColour(label_set, label); });
  cv::Mat picture, blended;
  cv::cvtColor(greyImage(image), picture, cv::COLOR_GRAY2BGR);
  cv::addWeighted(picture, 0.45, colours, 0.65, 0.0, blended);
  blended.copyTo(picture, labels != kUnlabelled);
  Shown shown(256, false);
  for (const Label label : cv::Mat1b(labels))
    shown[label] = true;
  // The height of a legend of all classes, up to three rows: images for a video.
  constexpr int most_rows = 3;
  const int rows = rowsOfLegend(legendOf(label_set, Shown(256, true)), picture.cols);
  return withLegend(picture, legendOf(label_set, shown), dark_theme,
                    std::min(rows, most_rows));
}

cv::Mat
drawTopView(const VoxelCloud& voxels, const std::vector<Eigen::Vector3d>& path,
            const LabelSet& label_set)
{
  std::vector<Eigen::Vector2d> path_in_voxels;
  for (const Eigen::Vector3d& position : path)
    path_in_voxels.push_back(position.head<2>() / voxels.voxel_size);
  const TopViewGrid grid(voxels.indices, path_in_voxels);
  cv::Mat picture(grid.size(), CV_8UC3, dark_theme.background);
  Shown shown(256, false);
  for (const pcl::PointXYZRGBL& point : *voxels.cloud)
    shown[requireLabel(point.label)] = true;
  const std::vector<LegendEntry> legend = legendOf(label_set, shown);
  drawColumns(picture, grid, voxels, label_set, !legend.empty());
  drawPath(picture, grid, path_in_voxels);
  drawScale(picture, grid.scale / (voxels.voxel_size * grid.step), dark_theme);
  return withLegend(picture, legend, dark_theme);
}

} // namespace pcl_semantic
