// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/pictures/ply_file.h>

#include "core/fail.h"
#include "files/bytes.h"

#include <pcl_semantic/files/atomic_file.h>

#include <iomanip>

namespace pcl_semantic {

namespace {

void
writeHeader(std::ostream& stream, const Eigen::Vector3d& origin, std::size_t vertices)
{
  stream << "ply\nformat binary_little_endian 1.0\ncomment pcl_semantic; x y z [m] are "
            "relative to the origin in the world\ncomment origin "
         << std::setprecision(15) << origin.x() << " " << origin.y() << " "
         << origin.z() << "\nelement vertex " << vertices
         << "\nproperty float x\nproperty float y\nproperty float z\n"
            "property uchar red\nproperty uchar green\nproperty uchar blue\n"
            "property uint label\nend_header\n";
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
  stream.write(reinterpret_cast<const char*>(bytes.bytes().data()),
               std::streamsize(bytes.bytes().size()));
}

} // namespace

void
writePlyPoints(const std::string& path, const VoxelScene& scene,
               const std::vector<cv::Vec3b>& colours)
{
  if (colours.size() != scene.voxels.size())
    badParameter(colours.size(), " colours for ", scene.voxels.size(), " voxels");
  AtomicFile file(path);
  writeHeader(file.stream(), scene.origin, scene.voxels.size());
  for (std::size_t i = 0; i < scene.voxels.size(); ++i)
    writeVertex(file.stream(), (*scene.voxels.cloud)[i].getVector3fMap().cast<double>(),
                colours[i], (*scene.voxels.cloud)[i].label);
  file.commit();
}

} // namespace pcl_semantic
