// SPDX-License-Identifier: BSD-3-Clause
#include "support/bad_case.h"
#include "support/map_folder.h"
#include "support/rgbd_street.h"

#include <pcl_semantic/dataset/kitti_sequence.h>
#include <pcl_semantic/files/trajectory_file.h>
#include <pcl_semantic/images/image_file.h>
#include <pcl_semantic/odometry/pose_source.h>

#include <opencv2/core.hpp>

#include <filesystem>
#include <fstream>
#include <iomanip>

namespace pcl_semantic {

namespace {

namespace fs = std::filesystem;

const std::string run =
    "map --rgbd STREET/rgbd --calibration STREET/camera.yaml --poses STREET/world.txt "
    "--output OUT --labels STREET/labels ";

// Maps an RGB-D sequence with options; the files of both are in the folder.
void
mapRgbd(const TemporaryFolder& folder, const std::string& options,
        const std::string& without = "")
{
  const std::string street = folder.path("street");
  copyStreet(street);
  makeRgbd(street);
  if (!without.empty())
    fs::remove(street + without);
  succeed(replaceAll(replaceAll(run + options, "STREET", street), "OUT",
                     folder.path("out")));
}

} // namespace

TEST(RgbdMap, IsLabelledAsTheImagesAre)
{
  const TemporaryFolder folder;
  const std::string street = folder.path("street"), out = folder.path("out");
  mapRgbd(folder, "--crf hierarchical --cliques superpixel");
  const cv::Mat truth = readPng(street + "/gt/000002.png", ImageKind::labels);
  const cv::Mat labels = readPng(out + "/labels/000002.png", ImageKind::labels);
  ASSERT_EQ(labels.size(), truth.size());
  const cv::Mat known = (truth > 0) & (labels > 0);
  const int right = cv::countNonZero((truth == labels) & known);
  EXPECT_GT(cv::countNonZero(known), int(truth.total()) / 3);
  EXPECT_GT(right, cv::countNonZero(known) * 3 / 4);
}

TEST(RgbdMap, LabelsEveryNthFrameAndGivesCentres)
{
  const TemporaryFolder folder;
  const std::string out = folder.path("out");
  mapRgbd(folder, "--network-every 2 --centres --voxel-size 0.2",
          "/labels/000001.bin"); // needs none
  EXPECT_EQ(
      cv::countNonZero(readPng(out + "/network_labels/000001.png", ImageKind::labels)),
      0);
  const MapFolder map = readMapFolder(out);
  ASSERT_GT(map.voxels.size(), 100u);
  for (std::size_t i = 0; i < map.voxels.size(); ++i)
    EXPECT_TRUE(
        (*map.voxels.cloud)[i].getVector3fMap().isApprox(map.voxels.centre(i), 1e-5f));
}

TEST(RgbdMap, BadInput)
{
  expectAllFail(
      {{2, "exclude each other", run + "STREET"},
       {2, "--clouds has no effect with --rgbd", run + "--clouds STREET"},
       {2, "--rgbd needs --calibration",
        "map --rgbd STREET/rgbd --poses STREET/world.txt --output OUT --labels "
        "STREET/labels"},
       {2, "--rgbd needs a trajectory",
        "map --rgbd STREET/rgbd --calibration STREET/camera.yaml --output OUT "
        "--labels STREET/labels"},
       {2, "either --labels or --network",
        "map --rgbd STREET/rgbd --calibration STREET/camera.yaml --poses "
        "STREET/world.txt --output OUT"},
       {2, "--sensor is for --clouds", run + "--sensor own"},
       {2, "--also has no effect with --rgbd", run + "--also depth"},
       {2, "--depth-scale is less than 0", run + "--depth-scale -1"},
       {3, "has no frame in 7:9", run + "--frames 7:9", makeRgbd},
       {3, "no RGB-D sequence", replaceAll(run, "STREET/rgbd", "STREET/gt"), makeRgbd},
       {3, "times.txt: has no row 'P2:'", replaceAll(run, "camera.yaml", "times.txt"),
        makeRgbd},
       {3, "world.txt", run, [](const std::string& street) {
          makeRgbd(street);
          writeKittiTrajectory(street + "/world.txt", {Eigen::Isometry3d::Identity()});
        }}});
}

} // namespace pcl_semantic
