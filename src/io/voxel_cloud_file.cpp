/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include <pcl_semantic/files/pcd_file.h>
#include <pcl_semantic/io/voxel_cloud_file.h>

#include <cstring>

namespace pcl_semantic {

namespace {

class RowWriter {
public:
  explicit RowWriter(std::uint8_t* row) : next_(row) {}

  template <typename T>
  void
  put(const T* values, std::size_t count)
  {
    std::memcpy(next_, values, count * sizeof(T));
    next_ += count * sizeof(T);
  }

  template <typename T>
  void
  put(T value)
  {
    put(&value, 1);
  }

private:
  std::uint8_t* next_;
};

std::uint32_t
packColour(const std::array<std::uint8_t, 3>& rgb)
{
  return 0xFF000000u | std::uint32_t(rgb[0]) << 16 | std::uint32_t(rgb[1]) << 8 |
         rgb[2];
}

} // namespace

void
writeVoxelCloud(const std::string& path, const VoxelCloud& voxels,
                const LabelSet& label_set, VoxelColour colour)
{
  const int classes = label_set.size();
  PcdTable table;
  table.fields = {{"x"},          {"y"},
                  {"z"},          {"rgba", 'U'},
                  {"label", 'U'}, {"probability", 'F', 4, classes},
                  {"entropy"},    {"observations", 'U'}};
  table.points = voxels.size();
  table.data.resize(table.points * table.pointSize());
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    const pcl::PointXYZRGBL& point = (*voxels.cloud)[i];
    const auto column = static_cast<Eigen::Index>(i);
    RowWriter row(table.data.data() + i * table.pointSize());
    row.put(point.data, 3);
    row.put(colour == VoxelColour::classes
                ? packColour(label_set[Label(point.label)].colour)
                : packColour({point.r, point.g, point.b}));
    row.put(std::uint32_t(point.label));
    row.put(voxels.refined.column(column), std::size_t(classes));
    row.put(voxels.refined.entropy(column));
    row.put(voxels.observations[i]);
  }
  writePcd(path, table);
}

} // namespace pcl_semantic
