// SPDX-License-Identifier: BSD-3-Clause
#include "live_frames.h"

#include <nlohmann/json.hpp>

namespace pcl_semantic::tool {

namespace {

using Json = nlohmann::json;

Json
colourJson(const cv::Vec3b& colour)
{
  return {colour[0], colour[1], colour[2]};
}

template <typename T>
void
append(std::string& bytes, const T* values, std::size_t count)
{
  bytes.append(reinterpret_cast<const char*>(values), count * sizeof(T));
}

Json
headerOf(const ViewedMap& map)
{
  const Eigen::Vector3d& corner = map.grid.corner;
  Json header{{"title", map.title},
              {"voxel_size", map.grid.size},
              {"corner", {corner.x(), corner.y(), corner.z()}},
              {"voxels", map.indices.size()},
              {"poses", map.path.size()},
              {"classes", Json::array()},
              {"colourings", Json::array()},
              {"pictures", Json::array()}};
  for (const ViewedClass& each : map.classes)
    header["classes"].push_back(
        {each.label, each.name, colourJson(each.colour), each.voxels});
  for (const Colouring& each : map.colourings) {
    Json legend = Json::array();
    for (const LegendEntry& entry : each.colours.legend)
      legend.push_back({entry.text, colourJson(entry.colour)});
    header["colourings"].push_back(
        {each.name, each.colours.note, each.colours.shading, legend});
  }
  for (const ViewedPicture& each : map.pictures)
    header["pictures"].push_back({each.camera.fx, each.camera.fy, each.camera.cx,
                                  each.camera.cy, each.camera.width,
                                  each.camera.height});
  return header;
}

} // namespace

std::string
bytesOf(const ViewedMap& map)
{
  std::string bytes = headerOf(map).dump() + "\n";
  append(bytes, map.indices.data(), map.indices.size());
  append(bytes, map.labels.data(), map.labels.size());
  for (const Colouring& each : map.colourings)
    append(bytes, each.colours.colours.data(), each.colours.colours.size());
  for (const Eigen::Isometry3d& pose : map.path)
    append(bytes, pose.matrix().data(), 16);
  for (const ViewedPicture& each : map.pictures) {
    append(bytes, each.T_map_camera.matrix().data(), 16);
    append(bytes, each.image.data, each.image.total() * 3);
  }
  return bytes;
}

} // namespace pcl_semantic::tool
