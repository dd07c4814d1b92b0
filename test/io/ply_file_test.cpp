// SPDX-License-Identifier: BSD-3-Clause

// What we write as PLY, read by PCL and compared with the voxels one by one.

#include "support/random_scene.h"
#include "support/temporary_folder.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/io/ply_file.h>

#include <gtest/gtest.h>
#include <pcl/conversions.h>
#include <pcl/io/ply_io.h>

#include <set>
#include <tuple>

using namespace pcl_semantic;

namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZRGBL>;

// The voxel that holds a point of the file.
VoxelIndex
voxelAround(const VoxelScene& scene, const Eigen::Vector3d& point)
{
  return ((point - scene.grid.corner) / scene.grid.size).array().floor().cast<int>();
}

::testing::AssertionResult
looksLike(const pcl::PointXYZRGBL& point, const VoxelScene& scene,
          const std::vector<cv::Vec3b>& colours, std::size_t row)
{
  if (point.label != (*scene.voxels.cloud)[row].label)
    return ::testing::AssertionFailure() << "label " << point.label;
  if (cv::Vec3b(point.b, point.g, point.r) != colours[row])
    return ::testing::AssertionFailure() << "another colour";
  return ::testing::AssertionSuccess();
}

/** \brief A mesh as PCL reads it. */
struct ReadMesh {
  Cloud vertices;
  std::vector<pcl::Vertices> faces;
};

ReadMesh
writtenMesh(const VoxelScene& scene, const std::vector<cv::Vec3b>& colours)
{
  const TemporaryFolder folder;
  writePlyMesh(folder.path("a.ply"), blockyMesh(scene, colours), scene, colours);
  pcl::PolygonMesh mesh;
  EXPECT_EQ(pcl::io::loadPLYFile(folder.path("a.ply"), mesh), 0);
  ReadMesh result;
  pcl::fromPCLPointCloud2(mesh.cloud, result.vertices);
  result.faces = mesh.polygons;
  return result;
}

} // namespace

TEST(PlyPoints, AreReadByPcl)
{
  const TemporaryFolder folder;
  const VoxelScene scene = randomScene(1);
  const std::vector<cv::Vec3b> colours = randomColours(scene, 2);
  writePlyPoints(folder.path("a.ply"), scene, colours);
  Cloud cloud;
  ASSERT_EQ(pcl::io::loadPLYFile(folder.path("a.ply"), cloud), 0);
  ASSERT_EQ(cloud.size(), scene.voxels.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    EXPECT_TRUE(looksLike(cloud[i], scene, colours, i));
    EXPECT_EQ(cloud[i].getVector3fMap(),
              (*scene.voxels.cloud)[i].getVector3fMap()); // as map.pcd has them
  }
  EXPECT_NE(bytesOf(folder.path("a.ply")).find("\ncomment origin 1000 -2000 0\n"),
            std::string::npos);
}

TEST(PlyMesh, HasTheFacesBetweenOccupiedAndNotOccupied)
{
  const VoxelScene scene = randomScene(3);
  const std::vector<cv::Vec3b> colours = randomColours(scene, 4);
  const ReadMesh mesh = writtenMesh(scene, colours);
  const auto rows = rowsOf(scene);
  std::set<std::tuple<int, int, int, int, int, int>> found; // voxel, neighbour - voxel
  for (const pcl::Vertices& face : mesh.faces) {
    ASSERT_EQ(face.vertices.size(), 4u);
    std::array<Eigen::Vector3d, 4> corner;
    for (std::size_t c = 0; c < 4; ++c)
      corner[c] = mesh.vertices.at(face.vertices[c]).getVector3fMap().cast<double>();
    // Vertices counterclockwise: the normal points outwards.
    const Eigen::Vector3d normal =
        (corner[1] - corner[0]).cross(corner[3] - corner[0]) / scene.grid.size;
    ASSERT_NEAR(normal.norm(), scene.grid.size, 1e-3);
    EXPECT_LT((corner[0] + corner[2] - corner[1] - corner[3]).norm(), 1e-3);
    const Eigen::Vector3d centre = 0.5 * (corner[0] + corner[2]);
    const VoxelIndex inside = voxelAround(scene, centre - 0.5 * normal),
                     outside = voxelAround(scene, centre + 0.5 * normal);
    ASSERT_EQ(rows.count(inside), 1u) << inside.transpose();
    ASSERT_EQ(rows.count(outside), 0u) << outside.transpose();
    for (const auto vertex : face.vertices)
      EXPECT_TRUE(looksLike(mesh.vertices[vertex], scene, colours, rows.at(inside)));
    const VoxelIndex step = outside - inside;
    EXPECT_TRUE(
        found.insert({inside.x(), inside.y(), inside.z(), step.x(), step.y(), step.z()})
            .second);
  }
  std::size_t expected = 0;
  for (const VoxelIndex& voxel : scene.voxels.indices)
    for (int axis = 0; axis < 3; ++axis)
      for (const int step : {-1, 1})
        expected += rows.count(voxel + step * VoxelIndex(VoxelIndex::Unit(axis))) == 0;
  EXPECT_EQ(found.size(), expected);
}

TEST(PlyMesh, SharesItsVertices)
{
  const VoxelScene scene = randomScene(5);
  const ReadMesh mesh = writtenMesh(scene, randomColours(scene, 6));
  std::set<std::tuple<float, float, float, std::uint32_t, std::uint32_t>> different;
  for (const pcl::PointXYZRGBL& vertex : mesh.vertices)
    EXPECT_TRUE(
        different.insert({vertex.x, vertex.y, vertex.z, vertex.label, vertex.rgba})
            .second);
  std::set<pcl::index_t> used;
  for (const pcl::Vertices& face : mesh.faces)
    used.insert(face.vertices.begin(), face.vertices.end());
  EXPECT_EQ(used.size(), mesh.vertices.size());
  // One voxel: a cube of eight corners and six squares.
  VoxelScene one = emptyScene();
  addVoxel(one, {-1, 7, 0}, 2);
  const VoxelMesh cube = blockyMesh(one, {cv::Vec3b(1, 2, 3)});
  EXPECT_EQ(cube.corners.size(), 8u);
  EXPECT_EQ(cube.faces.size(), 6u);
}

TEST(PlyFiles, RefuseOtherNumbersOfColours)
{
  const TemporaryFolder folder;
  const VoxelScene scene = randomScene(7);
  const std::vector<cv::Vec3b> one(1);
  EXPECT_TRUE(
      holds(thrownMessage<InvalidParameterException>([&] { blockyMesh(scene, one); }),
            "1 colours for"));
  EXPECT_TRUE(holds(thrownMessage<InvalidParameterException>(
                        [&] { writePlyPoints(folder.path("a.ply"), scene, one); }),
                    "1 colours for"));
  EXPECT_EQ(folder.entries(), 0u);
}
