// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/pictures/scene_image.h>

#include "core/fail.h"
#include "pictures/cube_renderer.h"

#include <pcl_semantic/map/voxel_set.h>
#include <pcl_semantic/pictures/scene_view.h>

#include <opencv2/core/mat.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace pcl_semantic {

namespace {

// A position on the face of a voxel.
struct Face {
  VoxelIndex voxel = VoxelIndex::Zero();
  VoxelIndex normal = VoxelIndex::Zero();
  int axis = 0;                                     // of the normal
  Eigen::Vector3d within = Eigen::Vector3d::Zero(); // position in the voxel, 0 to 1
};

class Shader {
public:
  Shader(const VoxelScene& scene, const CubeImage& cubes, const SceneView& view,
         const VoxelSet& set)
      : scene_(scene), cubes_(cubes), view_(view), reader_(set)
  {
    // The light comes from behind the camera's left shoulder, and from above.
    const Eigen::Matrix3d& axes = view.T_world_camera.linear();
    Eigen::Vector3d side = -0.8 * axes.col(0) - 0.45 * axes.col(2);
    side.z() = 0.0;
    light_ = (side + 1.25 * Eigen::Vector3d::UnitZ()).normalized();
  }

  void
  shadeRow(int row, cv::Mat& shade)
  {
    for (int column = 0; column < cubes_.voxel.cols; ++column)
      if (cubes_.voxel.at<int>(row, column) >= 0) {
        const Face face = faceAt(row, column);
        shade.at<float>(row, column) =
            static_cast<float>(lightOn(face) * openness(face) * edge(row, column));
      }
  }

private:
  Face
  faceAt(int row, int column) const
  {
    const double size = scene_.grid.size;
    const Eigen::Vector3d& eye = view_.T_world_camera.translation();
    Face face;
    face.voxel = scene_.voxels.indices[std::size_t(cubes_.voxel.at<int>(row, column))];
    const Eigen::Vector3d lower = face.voxel.cast<double>() * size - eye;
    const Eigen::Vector3d point =
        view_.T_world_camera.linear() *
        view_.camera.unproject(column, row, cubes_.depth.at<double>(row, column));
    face.within = ((point - lower) / size).cwiseMax(0.0).cwiseMin(1.0);
    double nearest = 2.0;
    for (int axis = 0; axis < 3; ++axis) {
      const bool from_below = lower[axis] > 0.0, from_above = lower[axis] + size < 0.0;
      const double distance = from_below   ? face.within[axis]
                              : from_above ? 1.0 - face.within[axis]
                                           : 2.0;
      if (distance >= nearest)
        continue;
      nearest = distance;
      face.axis = axis;
      face.normal.setZero();
      face.normal[axis] = from_below ? -1 : 1;
    }
    return face;
  }

  double
  lightOn(const Face& face) const
  {
    return 0.55 + 0.62 * std::max(0.0, light_.dot(face.normal.cast<double>()));
  }

  // Ambient occlusion: voxels beside the cell in front of the face reduce the light,
  // the more the closer the position is to their corner.
  double
  openness(const Face& face)
  {
    if (face.voxel != last_.voxel || face.normal != last_.normal) {
      last_ = face;
      const int b = (face.axis + 1) % 3, c = (face.axis + 2) % 3;
      for (int corner = 0; corner < 4; ++corner) {
        VoxelIndex to_b = VoxelIndex::Zero(), to_c = to_b;
        to_b[b] = corner & 1 ? 1 : -1;
        to_c[c] = corner & 2 ? 1 : -1;
        const VoxelIndex front = face.voxel + face.normal;
        const bool beside_b = reader_.contains(front + to_b);
        const bool beside_c = reader_.contains(front + to_c);
        const int closed = beside_b && beside_c
                               ? 3
                               : int(beside_b) + int(beside_c) +
                                     int(reader_.contains(front + to_b + to_c));
        corners_[std::size_t(corner)] = 1.0 - 0.12 * closed;
      }
    }
    const double b = face.within[(face.axis + 1) % 3],
                 c = face.within[(face.axis + 2) % 3];
    return (1.0 - c) * ((1.0 - b) * corners_[0] + b * corners_[1]) +
           c * ((1.0 - b) * corners_[2] + b * corners_[3]);
  }

  // Darkens pixels beside nearer ones, which outlines objects.
  double
  edge(int row, int column) const
  {
    constexpr int reach = 2;
    const double depth = cubes_.depth.at<double>(row, column);
    const double slack = 2.0 * scene_.grid.size, most = 8.0 * scene_.grid.size;
    double behind = 0.0;
    for (const auto& [dv, du] : {std::pair(-reach, 0), std::pair(reach, 0),
                                 std::pair(0, -reach), std::pair(0, reach)}) {
      const int v = row + dv, u = column + du;
      if (v < 0 || u < 0 || v >= cubes_.depth.rows || u >= cubes_.depth.cols ||
          cubes_.voxel.at<int>(v, u) < 0)
        continue;
      const double step = depth - cubes_.depth.at<double>(v, u) - slack;
      behind += std::clamp(step / most, 0.0, 1.0);
    }
    return std::exp(-0.22 * behind);
  }

  const VoxelScene& scene_;
  const CubeImage& cubes_;
  const SceneView& view_;
  VoxelSet::Reader reader_;
  Eigen::Vector3d light_;
  Face last_; // a zero normal is no valid face
  std::array<double, 4> corners_{};
};

// Brightness of each pixel of a rendering, about 0.3 to 1; 1 without a voxel.
cv::Mat
shadeCubes(const VoxelScene& scene, const CubeImage& cubes, const SceneView& view)
{
  const VoxelSet set(scene.voxels.indices);
  cv::Mat shade(cubes.voxel.size(), CV_32FC1, cv::Scalar(1.0));
#pragma omp parallel
  {
    Shader shader(scene, cubes, view, set);
#pragma omp for schedule(dynamic, 16)
    for (int row = 0; row < shade.rows; ++row)
      shader.shadeRow(row, shade);
  }
  return shade;
}

constexpr int kSupersampling = 2;
const cv::Vec3f sky_colour(250, 247, 245), ground_colour(243, 240, 238),
    grid_colour(216, 210, 206);
const cv::Scalar path_colour(60, 60, 235);

SceneView
enlarged(SceneView view, int factor)
{
  StereoCamera& camera = view.camera;
  camera.fx *= factor;
  camera.fy *= factor;
  // Pixel centres are at integer coordinates.
  camera.cx = (camera.cx + 0.5) * factor - 0.5;
  camera.cy = (camera.cy + 0.5) * factor - 0.5;
  camera.width *= factor;
  camera.height *= factor;
  return view;
}

// Height of the grid's plane, slightly below most voxels.
double
groundHeight(const VoxelScene& scene)
{
  std::vector<int> heights;
  for (const VoxelIndex& index : scene.voxels.indices)
    heights.push_back(index.z());
  const auto low = heights.begin() + std::ptrdiff_t(heights.size() / 100);
  std::nth_element(heights.begin(), low, heights.end());
  return *low * scene.grid.size;
}

// Grid spacing in metres: about a tenth of the map's longer side, rounded to 1, 2 or 5
// times a power of ten.
double
gridStep(const VoxelScene& scene)
{
  Eigen::AlignedBox3i box;
  for (const VoxelIndex& index : scene.voxels.indices)
    box.extend(index);
  const double side = box.sizes().head<2>().maxCoeff() + 1.0;
  const double wanted = 0.1 * side * scene.grid.size;
  const double power = std::pow(10.0, std::floor(std::log10(wanted)));
  return power * (wanted / power >= 5.0 ? 5.0 : wanted / power >= 2.0 ? 2.0 : 1.0);
}

// The ground grid, visible where no voxel is in front of it.
struct Ground {
  const SceneView& view;
  Eigen::Vector3d corner; // of voxel 0: lines are at integer coordinates of the file
  double height, step;    // [m]

  cv::Vec3f
  colourAt(int row, int column) const
  {
    const Eigen::Vector3d ray =
        view.T_world_camera.linear() * view.camera.unproject(column, row, 1.0);
    const Eigen::Vector3d& eye = view.T_world_camera.translation();
    const double depth = (height - eye.z()) / ray.z();
    if (!(depth > 0.0) || !std::isfinite(depth))
      return sky_colour;
    const Eigen::Vector3d position = eye + depth * ray;
    // Extent of a pixel on the ground, along the ray and across it [m].
    const double across = depth / view.camera.fx;
    const double along =
        across * ray.norm() / std::max(1e-9, std::abs(ray.z()) / ray.norm());
    double line = 0.0;
    for (int axis = 0; axis < 2; ++axis) {
      const double cells = (position[axis] + corner[axis]) / step;
      const double distance = std::abs(cells - std::round(cells)) * step;
      const double width =
          std::max(across, along * std::abs(ray[axis]) / ray.head<2>().norm());
      line = std::max(line, std::clamp(1.5 - distance / width, 0.0, 1.0) *
                                std::clamp(0.12 * step / width - 0.2, 0.0, 1.0));
    }
    return ground_colour + float(line) * (grid_colour - ground_colour);
  }
};

cv::Mat
paint(const VoxelScene& scene, const VoxelColours& colours, const SceneView& view,
      const Ground& ground, const std::vector<SceneLine>& lines)
{
  const CubeImage cubes =
      renderCubes(scene.voxels.indices, scene.grid.size, view.camera,
                  view.T_world_camera, std::numeric_limits<double>::infinity());
  const cv::Mat shade = shadeCubes(scene, cubes, view);
  const auto strength = static_cast<float>(colours.shading);
  cv::Mat picture(shade.size(), CV_8UC3);
#pragma omp parallel for schedule(static)
  for (int row = 0; row < picture.rows; ++row)
    for (int column = 0; column < picture.cols; ++column) {
      const int voxel = cubes.voxel.at<int>(row, column);
      const cv::Vec3f colour =
          voxel < 0 ? ground.colourAt(row, column)
                    : cv::Vec3f(colours.colours[std::size_t(voxel)]) *
                          (1.0f - strength + strength * shade.at<float>(row, column));
      for (int c = 0; c < 3; ++c)
        picture.at<cv::Vec3b>(row, column)[c] =
            cv::saturate_cast<std::uint8_t>(colour[c]);
    }
  // The edges of a box are often just below the ground, which a ray meets earlier.
  drawLines(picture, cubes.depth, view, lines, 8.0 * scene.grid.size,
            2 * kSupersampling);
  return picture;
}

// The sensor's path: red, with a white border for contrast.
void
drawPath(cv::Mat& picture, const SceneView& view, const SensorPath& path)
{
  constexpr int shift = 4; // OpenCV's fixed point
  const Eigen::Isometry3d T_camera_world = view.T_world_camera.inverse();
  std::vector<std::vector<cv::Point>> pieces(1);
  for (const Eigen::Vector3d& position : path) {
    const Eigen::Vector3d point = T_camera_world * position;
    const Eigen::Vector2d pixel =
        point.z() > 0.1 ? view.camera.project(point) : Eigen::Vector2d::Constant(1e9);
    if (pixel.cwiseAbs().maxCoeff() < 3e4)
      pieces.back().emplace_back(cvRound((pixel.x() + 0.5) * (1 << shift)),
                                 cvRound((pixel.y() + 0.5) * (1 << shift)));
    else if (!pieces.back().empty())
      pieces.emplace_back();
  }
  for (const auto& [colour, width] :
       {std::pair(cv::Scalar::all(255), 5), std::pair(path_colour, 2)}) {
    cv::polylines(picture, pieces, false, colour, width, cv::LINE_AA, shift);
    if (!pieces.back().empty())
      cv::circle(picture, pieces.back().back(), (4 + width / 2) << shift, colour,
                 cv::FILLED, cv::LINE_AA, shift);
  }
}

// A caption in the lower right corner, on a background for contrast.
void
drawNote(cv::Mat& picture, const std::string& note)
{
  const double size = std::min(1.0, 0.9 * picture.cols / textWidth(note));
  const int width = textWidth(note, size);
  const cv::Rect plate =
      cv::Rect(picture.cols - width - 20, picture.rows - 29, width + 20, 29) &
      cv::Rect(cv::Point(), picture.size());
  cv::Mat under = picture(plate);
  cv::addWeighted(under, 0.2, cv::Mat(under.size(), CV_8UC3, light_theme.background),
                  0.8, 0.0, under);
  drawText(picture, note, {picture.cols - width - 10, picture.rows - 10},
           light_theme.text, size);
}

void
validate(const VoxelScene& scene, const VoxelColours& colours, const SceneView& view)
{
  if (scene.voxels.size() == 0)
    badParameter("there is no voxel to draw");
  if (colours.colours.size() != scene.voxels.size())
    badParameter(colours.colours.size(), " colours for ", scene.voxels.size(),
                 " voxels");
  const Eigen::Array3d cell =
      (view.T_world_camera.translation() / scene.grid.size).array().floor();
  for (const VoxelIndex& index : scene.voxels.indices)
    if ((index.cast<double>().array() == cell).all())
      badParameter("the camera is inside a voxel: it would see nothing");
}

} // namespace

cv::Mat
drawVoxels(const VoxelScene& scene, const VoxelColours& colours, const SceneView& view,
           const SensorPath& path, const std::vector<SceneLine>& lines)
{
  validate(scene, colours, view);
  const SceneView large = enlarged(view, kSupersampling);
  const Ground ground{large, scene.grid.corner, groundHeight(scene), gridStep(scene)};
  cv::Mat picture;
  cv::resize(paint(scene, colours, large, ground, lines), picture,
             cv::Size(view.camera.width, view.camera.height), 0, 0, cv::INTER_AREA);
  drawPath(picture, view, path);
  std::string note = colours.note + (colours.note.empty() ? "" : ", ");
  note += cv::format("grid of %g m", ground.step);
  if (view.pixels_per_metre > 0.0)
    drawScale(picture, view.pixels_per_metre, light_theme);
  drawNote(picture, note);
  std::vector<LegendEntry> legend = colours.legend;
  if (!path.empty())
    legend.push_back({"path of the camera", {60, 60, 235}});
  return withLegend(picture, legend, light_theme);
}

} // namespace pcl_semantic
