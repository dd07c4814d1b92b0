/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/dataset/semantic_kitti_labels.h>
#include <pcl_semantic/files/input_file.h>

#include <cstring>

namespace pcl_semantic {

std::vector<Label>
readSemanticKittiLabels(const std::string& path, const LabelMapping& mapping,
                        std::size_t count)
{
  const std::vector<std::uint8_t> bytes = readBytes(path);
  if (bytes.size() != count * sizeof(std::uint32_t))
    PCL_THROW_EXCEPTION(BadInputException,
                        path << ": has " << bytes.size() << " bytes, expected "
                             << count * sizeof(std::uint32_t) << " (uint32 for each of "
                             << count << " points of the scan)");
  std::vector<Label> labels(count);
  for (std::size_t i = 0; i < count; ++i) {
    std::uint32_t value = 0;
    std::memcpy(&value, bytes.data() + i * sizeof(value), sizeof(value));
    labels[i] = mapping(value & 0xFFFFu);
  }
  return labels;
}

} // namespace pcl_semantic
