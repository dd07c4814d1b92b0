// SPDX-License-Identifier: BSD-3-Clause
#include "cube_shading.h"

#include <pcl_semantic/map/voxel_set.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace pcl_semantic {

namespace {

// A place on the surface: the face of a voxel, and where on it.
struct Face {
  VoxelIndex voxel = VoxelIndex::Zero();
  VoxelIndex normal = VoxelIndex::Zero();
  int axis = 0;                                     // of the normal
  Eigen::Vector3d within = Eigen::Vector3d::Zero(); // the voxel, 0 to 1
};

class Shader {
public:
  Shader(const VoxelScene& scene, const CubeImage& cubes, const PictureView& view,
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

  // How open the sky over a place is: voxels beside the cell in front of the face take
  // some of it away, more the nearer the place is to their corner.
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

  // Darker where neighbouring pixels see something nearer: outlines of things.
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
  const PictureView& view_;
  VoxelSet::Reader reader_;
  Eigen::Vector3d light_;
  Face last_; // the zero normal belongs to no face
  std::array<double, 4> corners_{};
};

} // namespace

cv::Mat
shadeCubes(const VoxelScene& scene, const CubeImage& cubes, const PictureView& view)
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

} // namespace pcl_semantic
