/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

// Maps and poses of a camera that is not rectified, by --left, --right, --calibration.

#include "support/bad_case.h"
#include "support/mapped_street.h"
#include "support/own_camera.h"

#include <pcl_semantic/io/labelled_cloud_file.h>

#include <array>
#include <cmath>
#include <map>

namespace pcl_semantic {

namespace fs = std::filesystem;

namespace {

constexpr double voxel = 0.25; // [m]

// Labels of the voxels of a map, by their place in the world.
std::map<std::array<int, 3>, std::uint32_t>
voxelsOf(const std::string& output)
{
  const LabelledCloud map = readLabelledCloud(output + "/map.pcd");
  const nlohmann::json origin = readJson(output + "/summary.json")["map_origin"];
  std::map<std::array<int, 3>, std::uint32_t> voxels;
  for (const auto& point : map.cloud->points) {
    const double world[] = {point.x + double(origin[0]), point.y + double(origin[1]),
                            point.z + double(origin[2])};
    voxels[{int(std::floor(world[0] / voxel)), int(std::floor(world[1] / voxel)),
            int(std::floor(world[2] / voxel))}] = point.label;
  }
  return voxels;
}

// The share of the voxels of `map` that have one of the same label at the same place or
// next to it in `other`.
double
shareFoundIn(const std::string& other, const std::string& map)
{
  const auto voxels = voxelsOf(map), others = voxelsOf(other);
  std::size_t found = 0;
  for (const auto& [at, label] : voxels) {
    bool is_there = false;
    for (int k = 0; k < 27 && !is_there; ++k) {
      const auto near =
          others.find({at[0] + k % 3 - 1, at[1] + k / 3 % 3 - 1, at[2] + k / 9 - 1});
      is_there = near != others.end() && near->second == label;
    }
    found += is_there;
  }
  EXPECT_GT(voxels.size(), 500u);
  return double(found) / double(voxels.size());
}

const std::string options = " --crf none --max-depth 10 --voxel-size 0.25 ";

std::string
mapCommand(const std::string& camera, const std::string& output)
{
  return "map" + ownCamera(camera) + "--labels " + camera + "/labels --output " +
         output + options;
}

} // namespace

TEST(OwnCamera, GivesTheMapOfTheRectifiedStreet)
{
  const TemporaryFolder folder;
  const std::string camera = folder.path("camera");
  writeOwnCamera(camera);
  mapStreet(tinyStreet(), folder.path("street"), options);
  const ToolResult result = runTool(mapCommand(camera, folder.path("own")) +
                                    "--poses " + camera + "/poses.txt");
  ASSERT_EQ(result.code, 0) << result.text;
  std::cerr << shareFoundIn(folder.path("street"), folder.path("own")) << " "
            << voxelsOf(folder.path("own")).size() << " "
            << voxelsOf(folder.path("street")).size() << "\n";
  const ToolResult result2 = runTool(mapCommand(camera, folder.path("own2")) +
                                     "--poses " + tinyStreet() + "/poses.txt");
  std::cerr << shareFoundIn(folder.path("street"), folder.path("own2")) << "\n";
}

} // namespace pcl_semantic
