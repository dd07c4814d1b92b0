// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/io/ply_file.h>

#include "core/fail.h"
#include "files/bytes.h"

#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/map/voxel_set.h>

#include <iomanip>
#include <limits>
#include <unordered_map>

namespace pcl_semantic {

namespace {

// What makes two vertices the same.
struct VertexKey {
  VoxelIndex corner;
  std::uint32_t look; // label, red, green, blue

  bool
  operator==(const VertexKey& other) const
  {
    return corner == other.corner && look == other.look;
  }
};

struct VertexHash {
  std::size_t
  operator()(const VertexKey& key) const
  {
    return VoxelIndexHash()(key.corner) ^ key.look * 0x9E3779B97F4A7C15ull;
  }
};

// The corners of a face of the voxel at 0, counterclockwise from outside.
std::array<VoxelIndex, 4>
faceCorners(int axis, bool upper)
{
  const VoxelIndex right = VoxelIndex::Unit((axis + 1) % 3),
                   up = VoxelIndex::Unit((axis + 2) % 3);
  const VoxelIndex begin =
      upper ? VoxelIndex(VoxelIndex::Unit(axis)) : VoxelIndex(0, 0, 0);
  if (upper)
    return {begin, begin + right, begin + right + up, begin + up};
  return {begin, begin + up, begin + right + up, begin + right};
}

void
requireColours(const VoxelScene& scene, const std::vector<cv::Vec3b>& colours)
{
  if (colours.size() != scene.voxels.size())
    badParameter(colours.size(), " colours for ", scene.voxels.size(), " voxels");
}

void
writeHeader(std::ostream& stream, const Eigen::Vector3d& origin, std::size_t vertices,
            std::size_t faces)
{
  stream << "ply\nformat binary_little_endian 1.0\ncomment pcl_semantic; x y z [m] are "
            "relative to the origin in the world\ncomment origin "
         << std::setprecision(15) << origin.x() << " " << origin.y() << " "
         << origin.z() << "\nelement vertex " << vertices
         << "\nproperty float x\nproperty float y\nproperty float z\n"
            "property uchar red\nproperty uchar green\nproperty uchar blue\n"
            "property uint label\n";
  if (faces > 0)
    stream << "element face " << faces << "\nproperty list uchar int vertex_indices\n";
  stream << "end_header\n";
}

void
flush(std::ostream& stream, const ByteWriter& bytes)
{
  stream.write(reinterpret_cast<const char*>(bytes.bytes().data()),
               std::streamsize(bytes.bytes().size()));
}

void
writeVertex(std::ostream& stream, const Eigen::Vector3d& position,
            const cv::Vec3b& colour, std::uint32_t label)
{
  ByteWriter bytes(19);
  for (int axis = 0; axis < 3; ++axis)
    bytes.put(static_cast<float>(position[axis]));
  for (int channel = 2; channel >= 0; --channel)
    bytes.put(colour[channel]);
  bytes.put(label);
  flush(stream, bytes);
}

} // namespace

VoxelMesh
blockyMesh(const VoxelScene& scene, const std::vector<cv::Vec3b>& colours)
{
  requireColours(scene, colours);
  const std::vector<VoxelIndex>& voxels = scene.voxels.indices;
  const VoxelSet occupied(voxels);
  VoxelSet::Reader reader(occupied);
  VoxelMesh mesh;
  std::unordered_map<VertexKey, std::uint32_t, VertexHash> numbers;
  const auto vertexAt = [&](const VoxelIndex& corner, std::uint32_t look,
                            std::size_t row) {
    const auto number = static_cast<std::uint32_t>(mesh.corners.size());
    const auto [found, is_new] = numbers.try_emplace({corner, look}, number);
    if (is_new) {
      if (number == std::uint32_t(std::numeric_limits<std::int32_t>::max()))
        badParameter("the mesh has more than ", number, " vertices");
      mesh.corners.push_back(corner);
      mesh.voxels.push_back(static_cast<std::uint32_t>(row));
    }
    return found->second;
  };
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    const cv::Vec3b& colour = colours[i];
    const std::uint32_t look = (*scene.voxels.cloud)[i].label << 24 |
                               std::uint32_t(colour[2]) << 16 |
                               std::uint32_t(colour[1]) << 8 | colour[0];
    for (int axis = 0; axis < 3; ++axis)
      for (const bool upper : {false, true}) {
        const VoxelIndex step = VoxelIndex::Unit(axis) * (upper ? 1 : -1);
        if (reader.contains(voxels[i] + step))
          continue;
        std::array<std::uint32_t, 4> face;
        const std::array<VoxelIndex, 4> corners = faceCorners(axis, upper);
        for (std::size_t c = 0; c < 4; ++c)
          face[c] = vertexAt(voxels[i] + corners[c], look, i);
        mesh.faces.push_back(face);
      }
  }
  return mesh;
}

void
writePlyPoints(const std::string& path, const VoxelScene& scene,
               const std::vector<cv::Vec3b>& colours)
{
  requireColours(scene, colours);
  AtomicFile file(path);
  writeHeader(file.stream(), scene.origin, scene.voxels.size(), 0);
  for (std::size_t i = 0; i < scene.voxels.size(); ++i)
    writeVertex(file.stream(), (*scene.voxels.cloud)[i].getVector3fMap().cast<double>(),
                colours[i], (*scene.voxels.cloud)[i].label);
  file.commit();
}

void
writePlyMesh(const std::string& path, const VoxelMesh& mesh, const VoxelScene& scene,
             const std::vector<cv::Vec3b>& colours)
{
  requireColours(scene, colours);
  AtomicFile file(path);
  writeHeader(file.stream(), scene.origin, mesh.corners.size(), mesh.faces.size());
  for (std::size_t i = 0; i < mesh.corners.size(); ++i) {
    const std::uint32_t voxel = mesh.voxels[i];
    writeVertex(file.stream(),
                scene.grid.corner + mesh.corners[i].cast<double>() * scene.grid.size,
                colours[voxel], (*scene.voxels.cloud)[voxel].label);
  }
  for (const std::array<std::uint32_t, 4>& face : mesh.faces) {
    ByteWriter bytes(17);
    bytes.put(static_cast<std::uint8_t>(face.size()));
    for (const std::uint32_t vertex : face)
      bytes.put(static_cast<std::int32_t>(vertex));
    flush(file.stream(), bytes);
  }
  file.commit();
}

} // namespace pcl_semantic
