// SPDX-License-Identifier: BSD-3-Clause
#include "live_frames.h"

#include <pcl_semantic/core/exceptions.h>

#include <nlohmann/json.hpp>

#include <algorithm>

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

namespace {

using Json = nlohmann::json;

// Beyond these a header is not one of ours.
constexpr std::size_t kMostVoxels = 1u << 28, kMostPoses = 1u << 24;
constexpr int kMostPixels = 1 << 14;

cv::Vec3b
colourOf(const Json& json)
{
  cv::Vec3b colour;
  for (int i = 0; i < 3; ++i)
    colour[i] = json.at(std::size_t(i)).get<std::uint8_t>();
  return colour;
}

class Reader {
public:
  explicit Reader(std::FILE* stream) : stream_(stream) {}

  ViewedMap
  read(const Json& header)
  {
    ViewedMap map;
    map.title = header.at("title").get<std::string>();
    map.grid.size = header.at("voxel_size").get<double>();
    for (int axis = 0; axis < 3; ++axis)
      map.grid.corner[axis] = header.at("corner").at(std::size_t(axis)).get<double>();
    for (const Json& each : header.at("classes"))
      map.classes.push_back({each.at(0).get<Label>(), each.at(1).get<std::string>(),
                             colourOf(each.at(2)), each.at(3).get<std::size_t>()});
    const std::size_t voxels = countOf(header.at("voxels"), kMostVoxels);
    take(map.indices, voxels);
    take(map.labels, voxels);
    for (const Json& each : header.at("colourings"))
      map.colourings.push_back({each.at(0).get<std::string>(), colours(each, voxels)});
    for (std::size_t i = countOf(header.at("poses"), kMostPoses); i > 0; --i)
      map.path.push_back(pose());
    for (const Json& each : header.at("pictures"))
      map.pictures.push_back(picture(each));
    if (map.colourings.empty() || !(map.grid.size > 0.0))
      fail();
    return map;
  }

  [[noreturn]] static void
  fail()
  {
    PCL_THROW_EXCEPTION(BadInputException,
                        "standard input: is no map in the making, or cut short");
  }

private:
  static std::size_t
  countOf(const Json& json, std::size_t most)
  {
    const auto count = json.get<std::size_t>();
    if (count > most)
      fail();
    return count;
  }

  template <typename T>
  void
  take(std::vector<T>& values, std::size_t count)
  {
    values.resize(count);
    if (std::fread(values.data(), sizeof(T), count, stream_) != count)
      fail();
  }

  VoxelColours
  colours(const Json& json, std::size_t voxels)
  {
    VoxelColours colours;
    colours.note = json.at(1).get<std::string>();
    colours.shading = json.at(2).get<double>();
    for (const Json& entry : json.at(3))
      colours.legend.push_back({entry.at(0).get<std::string>(), colourOf(entry.at(1))});
    take(colours.colours, voxels);
    return colours;
  }

  Eigen::Isometry3d
  pose()
  {
    std::vector<double> numbers;
    take(numbers, 16);
    Eigen::Isometry3d pose;
    pose.matrix() = Eigen::Map<const Eigen::Matrix4d>(numbers.data());
    return pose;
  }

  ViewedPicture
  picture(const Json& json)
  {
    ViewedPicture picture;
    StereoCamera& camera = picture.camera;
    camera.fx = json.at(0).get<double>();
    camera.fy = json.at(1).get<double>();
    camera.cx = json.at(2).get<double>();
    camera.cy = json.at(3).get<double>();
    camera.width = json.at(4).get<int>();
    camera.height = json.at(5).get<int>();
    if (std::min(camera.width, camera.height) < 1 ||
        std::max(camera.width, camera.height) > kMostPixels)
      fail();
    picture.T_map_camera = pose();
    std::vector<cv::Vec3b> pixels;
    take(pixels, std::size_t(camera.width) * std::size_t(camera.height));
    picture.image =
        cv::Mat(camera.height, camera.width, CV_8UC3, pixels.data()).clone();
    return picture;
  }

  std::FILE* stream_;
};

} // namespace

std::optional<ViewedMap>
readViewedMap(std::FILE* stream)
{
  std::string line;
  for (int c; (c = std::fgetc(stream)) != '\n';) {
    if (c == EOF && line.empty())
      return std::nullopt;
    if (c == EOF || line.size() > (1u << 20))
      Reader::fail();
    line += char(c);
  }
  try {
    return Reader(stream).read(Json::parse(line));
  }
  catch (const Json::exception&) {
    Reader::fail();
  }
}

} // namespace pcl_semantic::tool
