// SPDX-License-Identifier: BSD-3-Clause
#include "support/mapped_street.h"
#include "support/run_tool.h"
#include "support/thrown_message.h"

#include <pcl_semantic/files/cloud_file.h>

// Programs that people look at clouds with; not needed to build, so each test skips
// where its program is not installed.

namespace pcl_semantic {

namespace {

// Prints place, colour and label of the first and last point, as Open3D has them.
const std::string script = R"(import sys
import open3d
cloud = open3d.t.io.read_point_cloud(sys.argv[1])
size = len(cloud.point["positions"])
for i in [0, size - 1]:
    for name in ["positions", "colors", "label", "observations"]:
        for value in cloud.point[name][i].numpy():
            print(value, end=" ")
print(size)
)";

std::string
rowOf(const LabelledCloud& cloud, std::size_t i)
{
  const pcl::PointXYZRGBL& point = (*cloud.cloud)[i];
  const PcdColumn observations(cloud.table, cloud.table.find("observations"));
  std::ostringstream row;
  row << point.x << " " << point.y << " " << point.z << " " << int(point.r) << " "
      << int(point.g) << " " << int(point.b) << " " << point.label << " "
      << observations(i) << " ";
  return row.str();
}

std::string
mapIn(const TemporaryFolder& folder)
{
  mapStreet(tinyStreet(), folder.path("map"), "--frames 0:1 --crf none");
  return folder.path("map/map_classes.pcd");
}

} // namespace

TEST(OtherReaders, Open3dReadsTheMap)
{
  const std::string python = "/usr/bin/python3"; // Debian's, which has its packages
  if (runShell(python + " -c 'import open3d' 2>&1").code != 0)
    GTEST_SKIP() << "python3-open3d is not installed";
  const TemporaryFolder folder;
  const std::string path = mapIn(folder);
  const ToolResult read = runShell(python + " " + folder.write("read.py", script) +
                                   " " + path + " 2>/dev/null");
  ASSERT_EQ(read.code, 0) << read.text;
  const LabelledCloud cloud = readLabelledCloud(path);
  const std::size_t size = cloud.cloud->size();
  EXPECT_EQ(read.text,
            rowOf(cloud, 0) + rowOf(cloud, size - 1) + std::to_string(size) + "\n");
}

TEST(OtherReaders, PclViewerLoadsTheMap)
{
  if (runShell("command -v pcl_viewer").code != 0 || !hasVirtualDisplay())
    GTEST_SKIP() << "pcl-tools or xvfb are not installed";
  const TemporaryFolder folder;
  const std::string path = mapIn(folder);
  // It stays open until it is ended.
  const ToolResult shown = runOnDisplay("stdbuf -oL pcl_viewer " + path,
                                        "HOME=" + folder.path() + " timeout 15");
  const std::size_t size = readLabelledCloud(path).cloud->size();
  EXPECT_TRUE(holds(shown.text, ": " + std::to_string(size) + " points]"))
      << shown.text;
  EXPECT_TRUE(holds(shown.text, "x y z rgba label probability entropy observations"));
}

} // namespace pcl_semantic
