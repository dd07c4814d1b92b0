// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/files/byte_writer.h>
#include <pcl_semantic/io/ply_file.h>

#include <iomanip>

namespace pcl_semantic {

namespace {

void
requireColours(const VoxelScene& scene, const std::vector<cv::Vec3b>& colours)
{
  if (colours.size() != scene.voxels.size())
    PCL_THROW_EXCEPTION(InvalidParameterException, colours.size() << " colours for "
                                                                  << scene.voxels.size()
                                                                  << " voxels");
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

void
writePlyPoints(const std::string& path, const VoxelScene& scene,
               const std::vector<cv::Vec3b>& colours)
{
  requireColours(scene, colours);
  AtomicFile file(path);
  writeHeader(file.stream(), scene.origin, scene.voxels.size(), 0);
  for (std::size_t i = 0; i < scene.voxels.size(); ++i)
    writeVertex(file.stream(), centreOf(scene.grid, scene.voxels.indices[i]),
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
