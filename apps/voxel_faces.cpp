// SPDX-License-Identifier: BSD-3-Clause
#include "voxel_faces.h"

#include <pcl_semantic/map/voxel_set.h>

#include <cmath>

namespace pcl_semantic::tool {

namespace {

// How much light falls on a face: below, above, and the sides, by axis.
constexpr double kLight[3][2] = {{0.86, 0.72}, {0.70, 0.79}, {0.55, 1.0}};
constexpr double kCornerShade = 0.09;

class FaceMaker {
public:
  FaceMaker(const ViewedMap& map, const ViewState& state, const VoxelSet& set)
      : map_(map), colours_(map.colourings[state.colouring].colours), reader_(set)
  {}

  void
  add(std::size_t voxel, std::vector<VoxelFace>& faces)
  {
    const VoxelIndex& index = map_.indices[voxel];
    for (int axis = 0; axis < 3; ++axis)
      for (int side = 0; side < 2; ++side) {
        VoxelIndex front = index;
        front[axis] += side == 0 ? -1 : 1;
        if (!reader_.contains(front))
          faces.push_back(face(voxel, front, axis, side));
      }
  }

private:
  VoxelFace
  face(std::size_t voxel, const VoxelIndex& front, int axis, int side)
  {
    // Round the face, so that it is counterclockwise for the upper side.
    constexpr int round[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    const int b = (axis + 1) % 3, c = (axis + 2) % 3;
    const cv::Vec3b& colour = colours_.colours[voxel];
    VoxelFace face;
    for (std::size_t k = 0; k < 4; ++k) {
      const auto& [to_b, to_c] = round[side == 1 ? k : 3 - k];
      VoxelIndex corner = map_.indices[voxel];
      corner[axis] += side;
      corner[b] += to_b;
      corner[c] += to_c;
      const double light = kLight[axis][side] * openness(front, b, c, to_b, to_c);
      const double shade = 1.0 - colours_.shading * (1.0 - light);
      for (int i = 0; i < 3; ++i) {
        const auto at = static_cast<std::size_t>(i);
        face.corners[k][at] =
            static_cast<float>(map_.grid.corner[i] + corner[i] * map_.grid.size);
        face.colours[k][at] =
            static_cast<std::uint8_t>(std::lround(colour[2 - i] * shade));
      }
    }
    return face;
  }

  // Voxels beside the cell in front of a face take light from its corner.
  double
  openness(const VoxelIndex& front, int b, int c, int to_b, int to_c)
  {
    VoxelIndex beside_b = front, beside_c = front;
    beside_b[b] += to_b == 1 ? 1 : -1;
    beside_c[c] += to_c == 1 ? 1 : -1;
    VoxelIndex across = beside_b;
    across[c] = beside_c[c];
    const bool has_b = reader_.contains(beside_b), has_c = reader_.contains(beside_c);
    const int closed = has_b && has_c ? 3 : has_b + has_c + reader_.contains(across);
    return 1.0 - kCornerShade * closed;
  }

  const ViewedMap& map_;
  const VoxelColours& colours_;
  VoxelSet::Reader reader_;
};

} // namespace

std::vector<VoxelFace>
facesOf(const ViewedMap& map, const ViewState& state)
{
  std::vector<std::size_t> shown;
  std::vector<VoxelIndex> indices;
  for (std::size_t i = 0; i < map.indices.size(); ++i)
    if (state.shows(map, i)) {
      shown.push_back(i);
      indices.push_back(map.indices[i]);
    }
  const VoxelSet set(indices);
  FaceMaker maker(map, state, set);
  std::vector<VoxelFace> faces;
  faces.reserve(2 * shown.size());
  for (const std::size_t voxel : shown)
    maker.add(voxel, faces);
  return faces;
}

} // namespace pcl_semantic::tool
