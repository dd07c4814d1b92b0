// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/pictures/scene_lines.h>

#include <pcl_semantic/pictures/drawing.h>

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>

namespace pcl_semantic {

namespace {

// The visible parts of a projected line, in OpenCV's fixed point.
std::vector<std::pair<cv::Point, cv::Point>>
visibleParts(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
             const cv::Mat& depth, double margin, int shift)
{
  const auto steps =
      int(std::ceil((to - from).head<2>().cwiseAbs().maxCoeff())) + 1; // below a pixel
  std::vector<std::pair<cv::Point, cv::Point>> parts;
  bool was_visible = false;
  for (int i = 0; i <= steps; ++i) {
    const double t = double(i) / steps;
    const Eigen::Vector2d pixel = (1.0 - t) * from.head<2>() + t * to.head<2>();
    // The inverse of the depth is linear in the image.
    const double own = 1.0 / ((1.0 - t) / from.z() + t / to.z());
    const double surface =
        depth.at<double>(std::clamp(cvRound(pixel.y()), 0, depth.rows - 1),
                         std::clamp(cvRound(pixel.x()), 0, depth.cols - 1));
    const bool is_visible = surface == 0.0 || own <= surface + margin;
    const cv::Point at(cvRound(pixel.x() * (1 << shift)),
                       cvRound(pixel.y() * (1 << shift)));
    if (is_visible && !was_visible)
      parts.emplace_back(at, at);
    if (is_visible)
      parts.back().second = at;
    was_visible = is_visible;
  }
  return parts;
}

} // namespace

std::vector<SceneLine>
boxLines(const std::vector<ObjectSummary>& objects, const LabelSet& label_set,
         const Eigen::Vector3d& origin)
{
  std::vector<SceneLine> lines;
  for (const ObjectSummary& object : objects) {
    const std::vector<Eigen::Vector3d> corners = object.yaw_box.corners();
    for (const auto& [from, to] : YawBox::edges)
      lines.push_back({corners[from] - origin, corners[to] - origin,
                       classColour(label_set, object.label)});
  }
  return lines;
}

std::vector<SceneLine>
outlineLines(const std::vector<PlaneSummary>& planes, const LabelSet& label_set,
             const Eigen::Vector3d& origin)
{
  std::vector<SceneLine> lines;
  const auto add = [&](const PlaneRing& ring, const cv::Vec3b& colour) {
    for (std::size_t i = 0; i < ring.size(); ++i)
      lines.push_back({ring[i] - origin, ring[(i + 1) % ring.size()] - origin, colour});
  };
  for (const PlaneSummary& plane : planes)
    for (const PlanePolygon& polygon : plane.polygons) {
      const cv::Vec3b colour = plane.label == kUnlabelled
                                   ? cv::Vec3b(255, 255, 255)
                                   : classColour(label_set, plane.label);
      add(polygon.outer, colour);
      for (const PlaneRing& hole : polygon.holes)
        add(hole, colour);
    }
  return lines;
}

std::optional<std::pair<Eigen::Vector3d, Eigen::Vector3d>>
projectLine(const SceneView& view, const Eigen::Vector3d& from,
            const Eigen::Vector3d& to)
{
  constexpr double near_plane = 0.1; // [m]
  const StereoCamera& camera = view.camera;
  const Eigen::Isometry3d T_camera_world = view.T_world_camera.inverse();
  const Eigen::Vector3d a = T_camera_world * from, b = T_camera_world * to;
  // Planes through the camera's centre and the sides of the image: inside they are
  // positive.
  const auto distances = [&](const Eigen::Vector3d& point) {
    Eigen::Array<double, 5, 1> sides;
    sides << point.z() - near_plane, camera.fx * point.x() + camera.cx * point.z(),
        (camera.width - 1.0 - camera.cx) * point.z() - camera.fx * point.x(),
        camera.fy * point.y() + camera.cy * point.z(),
        (camera.height - 1.0 - camera.cy) * point.z() - camera.fy * point.y();
    return sides;
  };
  const Eigen::Array<double, 5, 1> at_a = distances(a), at_b = distances(b);
  double begin = 0.0, end = 1.0;
  for (int side = 0; side < 5; ++side) {
    if (!(std::isfinite(at_a[side]) && std::isfinite(at_b[side])) ||
        (at_a[side] < 0.0 && at_b[side] < 0.0))
      return std::nullopt;
    const double crossing = at_a[side] / (at_a[side] - at_b[side]);
    if (at_a[side] < 0.0)
      begin = std::max(begin, crossing);
    else if (at_b[side] < 0.0)
      end = std::min(end, crossing);
  }
  if (begin > end)
    return std::nullopt;
  const auto pixelAt = [&](double t) {
    const Eigen::Vector3d point = (1.0 - t) * a + t * b;
    Eigen::Vector3d pixel;
    pixel << camera.project(point), point.z();
    return pixel;
  };
  return std::pair(pixelAt(begin), pixelAt(end));
}

void
drawLines(cv::Mat& picture, const cv::Mat& depth, const SceneView& view,
          const std::vector<SceneLine>& lines, double margin, int width)
{
  constexpr int shift = 4; // OpenCV's fixed point
  for (const bool is_border : {true, false})
    for (const SceneLine& line : lines)
      if (const auto ends = projectLine(view, line.from, line.to))
        for (const auto& [from, to] :
             visibleParts(ends->first, ends->second, depth, margin, shift))
          cv::line(picture, from, to,
                   is_border ? cv::Scalar::all(255) : cv::Scalar(line.colour),
                   is_border ? 2 * width + 1 : width, cv::LINE_AA, shift);
}

} // namespace pcl_semantic
