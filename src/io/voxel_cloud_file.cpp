// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/io/voxel_cloud_file.h>

#include "core/fail.h"
#include "core/label_number.h"
#include "files/pcd_header.h"

#include <algorithm>
#include <cstring>
#include <limits>

namespace pcl_semantic {

namespace {

std::uint32_t
packColour(const std::array<std::uint8_t, 3>& rgb)
{
  return 0xFF000000u | std::uint32_t(rgb[0]) << 16 | std::uint32_t(rgb[1]) << 8 |
         rgb[2];
}

PcdTable
makeTable(int classes, std::size_t count, VoxelColour colour,
          const VoxelCloudWriter::Fields& fields)
{
  using Field = pcl::PCLPointField;
  PcdTable table;
  for (const char* const axis : {"x", "y", "z"})
    table.addField(axis, Field::FLOAT32);
  if (colour != VoxelColour::none)
    table.addField("rgba", Field::UINT32);
  table.addField("label", Field::UINT32);
  table.addField("probability", Field::FLOAT32, std::size_t(classes));
  table.addField("entropy", Field::FLOAT32);
  table.addField("observations", Field::UINT32);
  if (fields.object)
    table.addField("object", Field::UINT32);
  if (fields.plane)
    table.addField("plane", Field::UINT32);
  if (count > std::numeric_limits<pcl::uindex_t>::max())
    badParameter("a cloud cannot have ", count, " points");
  table.width = pcl::uindex_t(count);
  table.height = 1;
  return table;
}

} // namespace

VoxelCloudWriter::VoxelCloudWriter(const std::string& path, const LabelSet& label_set,
                                   VoxelColour colour, std::size_t count,
                                   double voxel_size, const Eigen::Vector3d& origin,
                                   Fields fields)
    : file_(path), label_set_(label_set), colour_(colour), missing_(count),
      fields_(fields)
{
  PcdTable table = makeTable(label_set.size(), count, colour, fields);
  const Eigen::Vector3d corner = Eigen::Vector3d::Zero() - origin; // avoids -0
  table.voxel_grid = {voxel_size, corner.x(), corner.y(), corner.z()};
  writePcdHeader(file_.stream(), table);
  row_.resize(table.point_step);
}

void
VoxelCloudWriter::write(const VoxelCloud& voxels, const std::vector<bool>& is_written)
{
  const auto classes = static_cast<std::size_t>(label_set_.size());
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    if (!is_written.empty() && !is_written[i])
      continue;
    const pcl::PointXYZRGBL& point = (*voxels.cloud)[i];
    const auto column = static_cast<Eigen::Index>(i);
    std::uint8_t* next = row_.data();
    const auto put = [&](const auto* values, std::size_t count = 1) {
      std::memcpy(next, values, count * sizeof *values);
      next += count * sizeof *values;
    };
    put(point.data, 3);
    if (colour_ != VoxelColour::none) {
      const std::uint32_t colour =
          colour_ == VoxelColour::classes
              ? packColour(label_set_[requireLabel(point.label)].colour)
              : packColour({point.r, point.g, point.b});
      put(&colour);
    }
    const float entropy = voxels.refined.entropy(column);
    put(&point.label);
    put(voxels.refined.column(column), classes);
    put(&entropy);
    put(&voxels.observations[i]);
    if (fields_.object)
      put(&voxels.objects[i]);
    if (fields_.plane)
      put(&voxels.planes[i]);
    file_.stream().write(reinterpret_cast<const char*>(row_.data()),
                         std::streamsize(row_.size()));
    --missing_;
  }
}

void
VoxelCloudWriter::commit()
{
  if (missing_ != 0)
    badParameter("voxel cloud: got ", -static_cast<std::int64_t>(missing_),
                 " voxels more than announced, expected 0");
  file_.commit();
}

void
writeVoxelCloud(const std::string& path, const VoxelCloud& voxels,
                const LabelSet& label_set, VoxelColour colour)
{
  if (colour == VoxelColour::measured && voxels.size() > 0 && !hasColour(voxels))
    colour = VoxelColour::none;
  VoxelCloudWriter writer(path, label_set, colour, voxels.size(), voxels.voxel_size,
                          voxels.origin,
                          {!voxels.objects.empty(), !voxels.planes.empty()});
  writer.write(voxels);
  writer.commit();
}

} // namespace pcl_semantic
