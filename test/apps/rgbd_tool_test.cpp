// SPDX-License-Identifier: BSD-3-Clause
#include "core/text_stream.h"
#include "support/bad_case.h"
#include "support/map_folder.h"
#include "support/rgbd_street.h"
#include "support/street_network.h"

#include <pcl_semantic/core/measured_depth.h>
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

std::string
intrinsicsOf(const std::string& street)
{
  const StereoCamera camera = KittiSequence(street).camera();
  TextStream text;
  text << camera.fx << "," << camera.fy << "," << camera.cx << "," << camera.cy;
  return text.str();
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

TEST(RgbdMap, HasTheOutputsForEvaluation)
{
  const TemporaryFolder folder;
  const std::string street = folder.path("street"), out = folder.path("out");
  mapRgbd(folder, "--also depth,measured,probabilities");
  const cv::Mat given =
      readPng(street + "/rgbd/depth/000001.png", ImageKind::disparity);
  const cv::Mat written = readPng(out + "/depth/000001.png", ImageKind::disparity);
  ASSERT_EQ(written.size(), given.size());
  int measured = 0, wrong = 0;
  for (int v = 0; v < given.rows; ++v)
    for (int u = 0; u < given.cols; ++u)
      if (const auto depth = given.at<std::uint16_t>(v, u); isMeasuredDepth(depth)) {
        const double error = written.at<std::uint16_t>(v, u) / 256.0 - depth / 1000.0;
        wrong += std::abs(error) > 0.002;
        ++measured;
      }
  EXPECT_GT(measured, 1000);
  EXPECT_EQ(wrong, 0);
  for (const char* const name : {"measured_labels", "final_labels_at_depth"})
    EXPECT_TRUE(fs::exists(out + "/" + name + "/000002.png")) << name;
}

TEST(RgbdMap, NeedsNeitherLabelsNorPosesNorACameraFile)
{
  const TemporaryFolder folder;
  const std::string street = folder.path("street"), out = folder.path("out");
  mapRgbd(folder, "");
  const std::size_t labelled = readMapFolder(out).voxels.size();
  const std::string command =
      "map --rgbd STREET/rgbd --intrinsics " + intrinsicsOf(street) + " --output OUT";
  const std::string text =
      succeed(replaceAll(replaceAll(command, "STREET", street), "OUT", out));
  EXPECT_TRUE(holds(text,
                    "warning: without --labels or --network the map has depth and "
                    "colour, but no classes"));
  const MapFolder map = readMapFolder(out);
  EXPECT_GT(map.voxels.size(), labelled / 2);
  for (const pcl::PointXYZRGBL& point : *map.voxels.cloud)
    EXPECT_EQ(point.label, kUnlabelled);
  const Trajectory truth = readKittiTrajectory(street + "/world.txt");
  const Trajectory found = readKittiTrajectory(out + "/trajectory.txt");
  ASSERT_EQ(found.size(), 3u);
  const double path = (truth[2].translation() - truth[0].translation()).norm();
  EXPECT_NEAR(found[2].translation().norm(), path, 0.03 * path);
}

// The same undistorted images everywhere, though this lens did not take them.
TEST(RgbdMap, ImagesOfALensAreUndistorted)
{
  const TemporaryFolder folder;
  const std::string street = folder.path("street");
  copyStreet(street);
  addNetwork(street);
  makeRgbd(street);
  fs::copy(street + "/camera.yaml", street + "/lens.yaml");
  std::ofstream(street + "/lens.yaml", std::ios::app) << "D: [-0.05, 0, 0, 0]\n";
  const auto command = [&](const std::string& text, const std::string& out) {
    return replaceAll(replaceAll(text, "STREET", street), "OUT", folder.path(out));
  };
  const std::string told = "lens.yaml line 2: D: the images will be undistorted";
  EXPECT_TRUE(
      holds(succeed(command("label --rgbd STREET/rgbd --calibration STREET/lens.yaml "
                            "--network STREET/net.yaml --output OUT",
                            "labels")),
            told));
  succeed(command("label --rgbd STREET/rgbd --network STREET/net.yaml --output OUT",
                  "distorted"));
  EXPECT_NE(bytesOf(folder.path("labels/000001.npy")),
            bytesOf(folder.path("distorted/000001.npy")));
  const std::string map =
      "map --rgbd STREET/rgbd --calibration STREET/lens.yaml --poses "
      "STREET/world.txt --output OUT ";
  const std::string stored =
      succeed(command(map + "--labels ", "stored") + folder.path("labels"));
  EXPECT_TRUE(holds(stored, told));
  EXPECT_TRUE(holds(stored, "labels have to be of the undistorted images"));
  const std::string direct =
      succeed(command(map + "--network STREET/net.yaml", "direct"));
  EXPECT_FALSE(holds(direct, "labels have to be"));
  EXPECT_EQ(bytesOf(folder.path("stored/map.pcd")),
            bytesOf(folder.path("direct/map.pcd")));
}

// One file a frame, as ScanNet's.
TEST(RgbdMap, PoseFilesAreFoundAndAreOfTheArchive)
{
  const TemporaryFolder folder;
  const std::string street = folder.path("street");
  copyStreet(street);
  makeRgbd(street);
  fs::create_directories(street + "/rgbd/pose");
  const Trajectory poses = readKittiTrajectory(street + "/world.txt");
  for (int frame = 0; frame < 3; ++frame)
    std::ofstream(street + "/rgbd/pose/00000" + std::to_string(frame) + ".txt")
        << std::setprecision(17) << poses[std::size_t(frame)].matrix();
  const auto command = [&](const std::string& name) {
    return replaceAll(replaceAll(run + "--archive OUT.map ", "STREET", street), "OUT",
                      folder.path(name));
  };
  succeed(command("file"));
  const std::string of_files =
      replaceAll(command("files"), "--poses " + street + "/world.txt ", "");
  succeed(of_files);
  EXPECT_EQ(bytesOf(folder.path("files/map.pcd")),
            bytesOf(folder.path("file/map.pcd")));
  std::ofstream(street + "/rgbd/pose/000002.txt")
      << "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\n";
  const ToolResult resumed = runTool(of_files + " --resume");
  EXPECT_EQ(resumed.code, 3) << resumed.text;
  EXPECT_TRUE(holds(resumed.text, "pose_files"));
}

TEST(RgbdMap, DepthImagesWithoutDepthsAreNamed)
{
  const TemporaryFolder folder;
  const std::string street = folder.path("street");
  copyStreet(street);
  makeRgbd(street);
  for (const char* const name : {"000000.png", "000001.png", "000002.png"})
    writePng(street + "/rgbd/depth/" + name, cv::Mat(64, 208, CV_16UC1, cv::Scalar(0)));
  EXPECT_TRUE(holds(
      succeed(replaceAll(replaceAll(run, "STREET", street), "OUT", folder.path("out"))),
      "the map is empty: no frame has a point with a valid depth"));
  EXPECT_TRUE(holds(succeed("rgbd " + street + "/rgbd " + folder.path("clouds") +
                            " --calibration " + street + "/camera.yaml"),
                    "rgbd: no depth image has a measurement: all are 0 or 65535"));
}

TEST(RgbdMap, ADarkImageIsNamed)
{
  const TemporaryFolder folder;
  const std::string street = folder.path("street");
  copyStreet(street);
  makeRgbd(street);
  const std::string command =
      replaceAll(replaceAll(run, "STREET", street), "OUT", folder.path("out"));
  EXPECT_FALSE(holds(succeed(command), "is dark"));
  for (const char* const name : {"000001.png", "000002.png"}) {
    const std::string path = street + "/rgbd/rgb/" + name;
    writePng(path, readImage(path) * 0.05);
  }
  const std::string text = succeed(command);
  EXPECT_TRUE(holds(text, "warning: frame 1: is dark (median grey level "));
  EXPECT_FALSE(holds(text, "frame 2: is dark"));
}

TEST(RgbdMap, BadInput)
{
  expectAllFail(
      {{2, "exclude each other", run + "STREET"},
       {2, "--clouds has no effect with --rgbd", run + "--clouds STREET"},
       {2, "--rgbd needs --calibration or --intrinsics",
        "map --rgbd STREET/rgbd --poses STREET/world.txt --output OUT --labels "
        "STREET/labels"},
       {2, "--rgbd needs --calibration or --intrinsics",
        run + "--intrinsics 120,120,104,32"},
       {2, "--intrinsics is '120,120', expected fx,fy,cx,cy",
        replaceAll(run, "--calibration STREET/camera.yaml", "--intrinsics 120,120")},
       {3, "rgbd: has no groundtruth.txt",
        replaceAll(run, "STREET/world.txt", "sequence"), makeRgbd},
       {2, "--labels and --network exclude each other", run + "--network x.yaml"},
       {2, "--crf has no effect without --labels or --network",
        replaceAll(run, "--labels STREET/labels", "--crf dense")},
       {2, "--sensor is for --clouds", run + "--sensor own"},
       {2, "--also scans needs a SEQUENCE with laser scans", run + "--also scans",
        makeRgbd},
       {2, "--depth-within is less than 0", run + "--depth-within -1"},
       {2, "--pose-gap is less than 0", run + "--pose-gap -1"},
       {2, "--pose-gap has no effect without the times", run + "--pose-gap 1",
        makeRgbd},
       {2, "--depth-within has no effect on folders", run + "--depth-within 1",
        makeRgbd},
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
