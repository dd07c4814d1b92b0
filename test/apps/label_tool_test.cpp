// SPDX-License-Identifier: BSD-3-Clause
#include "core/text_stream.h"
#include "support/bad_case.h"
#include "support/rgbd_street.h"
#include "support/same_image.h"
#include "support/street_network.h"

#include <pcl_semantic/dataset/kitti_sequence.h>
#include <pcl_semantic/files/cloud_file.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/files/trajectory_file.h>
#include <pcl_semantic/images/distribution_file.h>

#include <iomanip>
#include <set>

namespace pcl_semantic {

namespace fs = std::filesystem;

namespace {

const std::string tool = "label STREET --network STREET/net.yaml ";

} // namespace

TEST(LabelTool, AMapOfStoredLabelsIsThatOfTheNetwork)
{
  const TemporaryFolder folder;
  const std::string street = folder.path("street");
  copyStreet(street);
  addNetwork(street);
  succeed(replaceAll(tool, "STREET", street) + "--output " + folder.path("labels"));
  EXPECT_EQ(listFrameFiles(folder.path("labels"), {".npy"}).size(), 3u);
  for (const std::string& run :
       {" --labels " + folder.path("labels") + " --output " + folder.path("stored"),
        " --network " + street + "/net.yaml --output " + folder.path("direct")}) {
    succeed("map " + street + " --crf none" + run);
  }
  for (const char* image : {"network_labels/000001.png", "labels/000002.png"})
    EXPECT_TRUE(
        isSameImage(readPng(folder.path("stored/") + image, ImageKind::labels),
                    readPng(folder.path("direct/") + image, ImageKind::labels)));
}

TEST(LabelTool, SingleImagesAreLabelledAsThoseOfAPair)
{
  const TemporaryFolder folder;
  const std::string street = folder.path("street");
  copyStreet(street);
  addNetwork(street);
  makeRgbd(street);
  const std::string net = " --network " + street + "/net.yaml --output ";
  succeed("label " + street + net + folder.path("pairs"));
  succeed("label --images '" + street + "/image_2/*.png'" + net +
          folder.path("images"));
  succeed("label --rgbd " + street + "/rgbd --format packed --frames 1:" + net +
          folder.path("rgbd"));
  const auto read = [&](const std::string& file) {
    return readDistributions(folder.path(file), 208, 64, 11, 0.8f).matrix();
  };
  for (const char* const name : {"000000.npy", "000002.npy"})
    EXPECT_TRUE(read(std::string("images/") + name) ==
                read(std::string("pairs/") + name));
  EXPECT_FALSE(fs::exists(folder.path("rgbd/000000.npy.zst")));
  for (const std::string format : {"float32", "float16", "packed", "ids"})
    for (const std::string frames : {"0:1", "1:2"})
      succeed("label --rgbd " + street + "/rgbd --format " + format + " --frames " +
              frames + net + folder.path("again_" + format));
  for (const std::string& bad :
       {"--rgbd " + street + "/rgbd" + net + street + "/rgbd/rgb",
        "--images '" + street + "/image_[2]/*.png'" + net + street + "/image_2"})
    EXPECT_EQ(runTool("label --format ids " + bad).code, 2);
  EXPECT_LT(
      (read("rgbd/000002.npy.zst") - read("pairs/000002.npy")).cwiseAbs().maxCoeff(),
      0.005f);
  succeed("map --rgbd " + street + "/rgbd --calibration " + street +
          "/camera.yaml --poses " + street + "/world.txt --frames 1: --labels " +
          folder.path("rgbd") + " --output " + folder.path("map"));
  for (const auto& [says, options] : std::vector<std::pair<std::string, std::string>>{
           {"exclude each other", street + " --images x"},
           {"exclude each other", "--rgbd x --images y"},
           {"--left has no effect with --images or --rgbd", "--rgbd x --left y"},
           {"--intrinsics has no effect without --clouds and --left",
            "--images x --intrinsics 1,1,1,1"},
           {"--depth-within has no effect without --rgbd",
            "--images x --depth-within 1"}})
    EXPECT_TRUE(
        holds(runTool("label " + options + net + folder.path("no")).text, says));
}

TEST(LabelTool, IdsAreTheClassesOfTheDistributions)
{
  const TemporaryFolder folder;
  const std::string street = folder.path("street");
  copyStreet(street);
  addNetwork(street);
  for (const std::string format : {"float16", "ids"}) {
    succeed(replaceAll(tool, "STREET", street) + "--frames 1:2 --format " + format +
            " -o " + folder.path(format));
    succeed("map " + street + " --frames 1:2 --crf none --labels " +
            folder.path(format) + " --output " + folder.path("map_" + format));
  }
  const cv::Mat ids = readPng(folder.path("ids/000001.png"), ImageKind::labels);
  EXPECT_TRUE(isSameImage(ids, readPng(folder.path("map_ids/network_labels/000001.png"),
                                       ImageKind::labels)));
  // Rounding can only turn classes that are equally probable.
  const cv::Mat halves =
      readPng(folder.path("map_float16/network_labels/000001.png"), ImageKind::labels);
  EXPECT_LT(cv::countNonZero(ids != halves), int(ids.total() / 100));
  EXPECT_GT(cv::countNonZero(ids != ids.at<std::uint8_t>(0, 0)), 0);
}

namespace {

// A scan of frame 1 that returns from a grid of pixels at 10 m, from behind the camera
// and from behind one of the others.
void
addReturns(const std::string& street)
{
  const KittiSequence sequence(street);
  const Eigen::Isometry3d T_velodyne_camera =
      sequence.T_camera0_velodyne().inverse() * sequence.T_camera0_camera();
  std::vector<float> scan;
  const auto add = [&](const Eigen::Vector3d& point) {
    const Eigen::Vector3d in_scanner = T_velodyne_camera * point;
    for (int axis = 0; axis < 3; ++axis)
      scan.push_back(float(in_scanner[axis]));
    scan.push_back(0.25f);
  };
  const StereoCamera& camera = sequence.camera();
  for (int v = 5; v < camera.height; v += 10)
    for (int u = 5; u < camera.width; u += 10)
      add(camera.unproject(u, v, 10.0));
  add(camera.unproject(5, 5, -10.0));
  add(camera.unproject(5, 5, 30.0));
  fs::create_directories(street + "/velodyne");
  std::ofstream(street + "/velodyne/000001.bin", std::ios::binary)
      .write(reinterpret_cast<const char*>(scan.data()),
             std::streamsize(scan.size() * sizeof(float)));
}

// The camera of a street as ROS describes it, and where the scanner is.
void
describeCamera(const std::string& street)
{
  const KittiSequence sequence(street);
  const StereoCamera& camera = sequence.camera();
  std::ofstream(street + "/camera.yaml")
      << std::setprecision(17) << "K: [" << camera.fx << ", 0, " << camera.cx << ", 0, "
      << camera.fy << ", " << camera.cy << ", 0, 0, 1]\n";
  writeKittiTrajectory(street + "/scanner.txt", {sequence.T_camera0_camera().inverse() *
                                                 sequence.T_camera0_velodyne()});
}

const std::string carry = "label --clouds STREET/velodyne --labels STREET/labels ";
const std::string own =
    carry + "--left STREET/image_2 --calibration STREET/camera.yaml ";

} // namespace

TEST(LabelTool, AScannersPointsGetTheLabelsOfTheirPixels)
{
  const TemporaryFolder folder;
  const std::string street = folder.path("street");
  copyStreet(street);
  addReturns(street);
  describeCamera(street);
  const StereoCamera camera = KittiSequence(street).camera();
  TextStream intrinsics;
  intrinsics.precision(17);
  intrinsics << camera.fx << "," << camera.fy << "," << camera.cx << "," << camera.cy;
  for (const std::string& command :
       {carry + "STREET -o OUT", own + "--sensor-pose STREET/scanner.txt -o OWN",
        carry + "--left STREET/image_2 --intrinsics " + intrinsics.str() +
            " --sensor-pose STREET/scanner.txt -o OWN/numbers"}) {
    succeed(replaceAll(
        replaceAll(replaceAll(command, "STREET", street), "OUT", folder.path("out")),
        "OWN", folder.path("own")));
  }
  for (const char* const name : {"own/000001.pcd", "own/numbers/000001.pcd"})
    EXPECT_EQ(bytesOf(folder.path(name)), bytesOf(folder.path("out/000001.pcd")));
  const LabelledCloud cloud = readLabelledCloud(folder.path("out/000001.pcd"));
  const LabelDistributions pixels =
      readDistributions(street + "/labels/000001.bin", 208, 64, 11, 0.8f);
  std::size_t i = 0;
  std::set<std::uint32_t> labels;
  for (int v = 5; v < 64; v += 10)
    for (int u = 5; u < 208; u += 10, ++i) {
      const Eigen::Index pixel = v * 208 + u;
      EXPECT_EQ((*cloud.cloud)[i].label, pixels.mapLabel(pixel)) << u << " " << v;
      EXPECT_TRUE(cloud.distributions.matrix()
                      .col(Eigen::Index(i))
                      .isApprox(pixels.matrix().col(pixel), 1e-5f));
      labels.insert((*cloud.cloud)[i].label);
    }
  ASSERT_EQ(cloud.cloud->size(), i + 2);
  EXPECT_GT(labels.size(), 2u);
  EXPECT_EQ((*cloud.cloud)[i].label, 0u);     // behind the camera
  EXPECT_EQ((*cloud.cloud)[i + 1].label, 0u); // hidden
  EXPECT_GE(cloud.table.find("intensity"), 0);
  succeed("map --clouds " + folder.path("out") + " --poses " + street +
          "/poses.txt --sensor laser --calibration " + street + "/calib.txt --output " +
          folder.path("map"));
}

TEST(LabelTool, BadCarrying)
{
  const auto damage = [](const std::string& street) {
    addReturns(street);
    describeCamera(street);
  };
  const auto andAnother = [&](const std::string& street) {
    damage(street);
    fs::copy(street + "/velodyne/000001.bin", street + "/velodyne/000007.bin");
  };
  const auto twoPoses = [&](const std::string& street) {
    damage(street);
    std::ofstream(street + "/scanner.txt", std::ios::app)
        << "1 0 0 0 0 1 0 0 0 0 1 0\n";
  };
  const std::string pose = "--sensor-pose STREET/scanner.txt ";
  expectAllFail(
      {{2, "--left needs --sensor-pose", own + "-o OUT", damage},
       {2, "--right has no effect with --clouds",
        own + pose + "--right STREET/image_3 -o OUT", damage},
       {2, "--left needs --calibration or --intrinsics",
        carry + "--left STREET/image_2 " + pose + "-o OUT", damage},
       {2, "both a SEQUENCE", own + pose + "STREET -o OUT", damage},
       {2, "--occlusion-window is '3'", carry + "STREET --occlusion-window 3 -o OUT",
        damage},
       {2, "--sensor-pose has no effect with --clouds that have no SEQUENCE",
        carry + pose + "-o OUT", damage},
       {2, "--max-depth", carry + "STREET --max-depth -1 -o OUT", damage},
       {3, "the camera has no image of frame 7", carry + "STREET -o OUT", andAnother},
       {3, "has no image of frame 7", own + pose + "-o OUT", andAnother},
       {3, "holds 2 poses, expected one", own + pose + "-o OUT", twoPoses},
       {3, "none.txt", own + "--sensor-pose STREET/none.txt -o OUT", damage}});
}

TEST(LabelTool, BadInput)
{
  expectAllFail(
      {{2, "expected a SEQUENCE, or --left", "label"},
       {2, "--output is missing", tool},
       {2, "--network is missing", "label STREET --output OUT"},
       {2, "--format is 'jpg'", tool + "--format jpg --output OUT"},
       {2, "holds images", tool + "--format ids --output STREET/image_2"},
       {2, "where only .npy files", tool + "--output STREET/labels"},
       {3, "has no frame in 7:9", tool + "--frames 7:9 --output OUT", addNetwork},
       {3, "net.yaml", tool + "--output OUT"},
       {5, "cannot be made", tool + "--output STREET/calib.txt/out", addNetwork}});
}

} // namespace pcl_semantic
