// SPDX-License-Identifier: BSD-3-Clause
#include "support/bad_case.h"

#include <pcl_semantic/dataset/kitti_sequence.h>
#include <pcl_semantic/files/cloud_file.h>
#include <pcl_semantic/files/trajectory_file.h>
#include <pcl_semantic/odometry/pose_source.h>

#include <opencv2/core.hpp>

#include <iomanip>

namespace pcl_semantic {

namespace fs = std::filesystem;

namespace {

// The images of a street have 208 x 64 pixels.
constexpr int columns = 208, rows = 64;

// The pair of a street as two camera_infos of another size, or with more lines, and as
// an RGB-D camera all of whose pixels are 5 m away.
BadCase::Damage
described(int width, int height, const std::string& more = "")
{
  return [=](const std::string& street) {
    const KittiSequence sequence(street);
    const StereoCamera& camera = sequence.camera();
    for (const auto& [name, Tx] :
         {std::pair("left", 0.0), std::pair("right", -camera.fx * camera.baseline)}) {
      std::ofstream file(street + "/" + name + ".yaml");
      file << std::setprecision(17) << "width: " << width << "\nheight: " << height
           << "\nD: [0, 0, 0, 0, 0]\nR: [1, 0, 0, 0, 1, 0, 0, 0, 1]\nK: [" << camera.fx
           << ", 0, " << camera.cx << ", 0, " << camera.fy << ", " << camera.cy
           << ", 0, 0, 1]\nP: [" << camera.fx << ", 0, " << camera.cx << ", " << Tx
           << ", 0, " << camera.fy << ", " << camera.cy << ", 0, 0, 0, 1, 0]\n"
           << more;
    }
    fs::create_directories(street + "/rgbd/depth");
    fs::copy(street + "/image_2", street + "/rgbd/rgb");
    Trajectory poses;
    for (const Eigen::Isometry3d& pose : readKittiTrajectory(street + "/poses.txt"))
      poses.push_back(worldFromFirstCamera() * pose * sequence.T_camera0_camera());
    writeKittiTrajectory(street + "/world.txt", poses);
    for (const char* const name : {"000000.png", "000001.png", "000002.png"})
      writePng(street + "/rgbd/depth/" + name,
               cv::Mat(rows, columns, CV_16UC1, 5000.0));
    fs::create_directories(street + "/velodyne");
    const float points[] = {10, 2, -1, 0, 12, -1, -1, 0};
    std::ofstream(street + "/velodyne/000001.bin", std::ios::binary)
        .write(reinterpret_cast<const char*>(points), sizeof(points));
  };
}

// The same, with one image replaced by an image of another size.
BadCase::Damage
with(const std::string& image, int type)
{
  return [=](const std::string& street) {
    described(columns, rows)(street);
    writePng(street + "/" + image,
             cv::Mat(rows / 2, columns / 2, type,
                     cv::Scalar::all(type == CV_16UC1 ? 5000 : 1)));
  };
}

const std::string rgbd = "rgbd STREET/rgbd OUT --calibration STREET/left.yaml",
                  rgbd_map = "map --rgbd STREET/rgbd --calibration STREET/left.yaml "
                             "--poses STREET/world.txt --output OUT --labels ",
                  pairs = "--left STREET/image_2 --right STREET/image_3 --calibration "
                          "STREET/left.yaml --extrinsics STREET/right.yaml ",
                  pair_map = "map " + pairs +
                             "--poses STREET/poses.txt --output OUT "
                             "--labels STREET/labels",
                  carry =
                      "label --clouds STREET/velodyne --labels STREET/labels -o OUT "
                      "--left STREET/image_2 --calibration STREET/left.yaml "
                      "--sensor-pose STREET/scanner.txt";

} // namespace

TEST(CameraSizes, EveryConsumerRefusesAnother)
{
  const BadCase::Damage other = described(640, 480);
  const auto withScanner = [&](const std::string& street) {
    other(street);
    std::ofstream(street + "/scanner.txt") << "0 -1 0 0 0 0 -1 0 1 0 0 0\n";
  };
  const auto withClouds = [](const std::string& street) {
    described(columns, rows)(street);
    succeed("rgbd " + street + "/rgbd " + street + "/clouds --quiet --calibration " +
            street + "/left.yaml");
    for (const char* const name : {"/left.yaml", "/right.yaml"}) {
      const std::string text = bytesOf(street + name);
      std::ofstream(street + name) << replaceAll(
          replaceAll(text, "width: 208", "width: 640"), "height: 64", "height: 480");
    }
  };
  const std::string half = "000001.png: has 104 x 32 pixels, expected 208 x 64";
  const std::string size = "left.yaml is the calibration of 640 x 480";
  const std::string evaluate =
      "evaluate" + of_kitti11 + "--truth STREET/gt --prediction STREET/gt2 ";
  const auto predictions = [](const std::string& image, int type) {
    return [=](const std::string& street) {
      fs::copy(street + "/gt", street + "/gt2");
      fs::create_directories(street + "/depth");
      for (const char* const name : {"000000.png", "000001.png", "000002.png"})
        writePng(street + "/depth/" + name, cv::Mat(rows, columns, CV_16UC1, 256.0));
      with(image, type)(street);
    };
  };
  expectAllFail({
      {3, " has 208 x 64 pixels, but ", rgbd, other},
      {3, size, rgbd, other},
      {3, size, rgbd_map + "STREET/labels", other},
      {3, size, pair_map, other},
      {3, size, "odometry " + pairs + "OUT", other},
      {3, size, carry, withScanner},
      {3, size,
       "map --clouds STREET/clouds --calibration STREET/left.yaml --extrinsics "
       "STREET/right.yaml --poses STREET/poses.txt --output OUT",
       withClouds},
      {3, "depth/000000.png: has 104 x 32 pixels, expected 208 x 64 as", rgbd,
       with("rgbd/depth/000000.png", CV_16UC1)},
      {3, half, rgbd_map + "STREET/gt", with("gt/000001.png", CV_8UC1)},
      {3, "image_2/000001.png: has 104 x 32 pixels, expected 208 x 64", pair_map,
       with("image_2/000001.png", CV_8UC3)},
      {3, "image_3/000001.png: has 104 x 32 pixels, expected 208 x 64", pair_map,
       with("image_3/000001.png", CV_8UC3)},
      {3, half, "--labels STREET/gt", with("gt/000001.png", CV_8UC1)},
      {3, half, "image_crf STREET/image_2/000001.png STREET/gt/000001.png OUT.png",
       with("gt/000001.png", CV_8UC1)},
      {3, half,
       "image_crf STREET/image_2/000001.png STREET/labels/000001.bin OUT.png --crf "
       "pn-potts --cliques STREET/gt/000001.png",
       with("gt/000001.png", CV_8UC1)},
      {3, "000001.png", evaluate, predictions("gt2/000001.png", CV_8UC1)},
      {3, "has 104 x 32 depths, the ground truth 208 x 64",
       evaluate + "--truth-depth STREET/depth --range 0:9",
       predictions("depth/000001.png", CV_16UC1)},
      {3, "000000.png", "stereo STREET/image_2 STREET/image_3 STREET/calib.txt OUT",
       with("image_3/000000.png", CV_8UC3)},
  });
}

TEST(CameraSizes, BinningAndARegionExplainThem)
{
  for (const auto& damage :
       {described(columns, rows),
        described(2 * columns, 3 * rows, "binning_x: 2\nbinning_y: 3\n"),
        described(640, 480,
                  "roi: {x_offset: 7, y_offset: 9, width: 208, height: 64}\n")}) {
    const TemporaryFolder folder;
    const std::string street = folder.path("street");
    copyStreet(street);
    damage(street);
    const std::string said = succeed(
        replaceAll(replaceAll(rgbd, "STREET", street), "OUT", folder.path("out")));
    EXPECT_TRUE(holds(said, "clouds: 3"));
    EXPECT_EQ(readLabelledCloud(folder.path("out/000000.pcd")).cloud->width, 208u);
  }
}

TEST(CameraSizes, RectifiedImagesUseP)
{
  const TemporaryFolder folder;
  fs::create_directories(folder.path("s/rgb"));
  fs::create_directories(folder.path("s/depth"));
  writePng(folder.path("s/rgb/0.png"), cv::Mat(30, 40, CV_8UC3, cv::Scalar::all(9)));
  cv::Mat1w depth(30, 40, std::uint16_t(2000));
  depth(3, 4) = 65535;
  depth(5, 6) = 0;
  writePng(folder.path("s/depth/0.png"), depth);
  const std::string camera = folder.write(
      "c.yaml", "height: 30\nwidth: 40\nD: [0, 0, 0, 0, 0]\nK: [40, 0, 20, 0, 40, 15, "
                "0, 0, 1]\nR: [1, 0, 0, 0, 1, 0, 0, 0, 1]\nP: [50, 0, 20, 0, 0, 50, "
                "15, 0, 0, 0, 1, 0]\n");
  const std::string tool = "rgbd " + folder.path("s") + " " + folder.path("out") +
                           " --calibration " + camera;
  EXPECT_TRUE(holds(succeed(tool), "pixels_without_depth: 2"));
  const auto cloud = readLabelledCloud(folder.path("out/0.pcd")).cloud;
  EXPECT_NEAR(cloud->at(0, 0).x, -0.8f, 1e-6f);
  EXPECT_TRUE(std::isnan(cloud->at(4, 3).z));
  expectFails(tool + " --depth-scale 0.001", 2, "1000 if the unit is 0.001 m");
  EXPECT_TRUE(holds(succeed(tool + " --depth-scale 1"),
                    "pcl_semantic_rgbd: warning: " + folder.path("s/depth/0.png") +
                        ": half of its depths are more than 2000 m"));
}

TEST(CameraSizes, AMapOfQuaternionsWithWFirstIsDoubted)
{
  const TemporaryFolder folder;
  const std::string street = folder.path("street"), out = folder.path("out");
  copyStreet(street);
  TimedTrajectory right, wrong;
  double time = 0.0;
  for (const Eigen::Isometry3d& pose : readKittiTrajectory(street + "/poses.txt")) {
    const Eigen::Quaterniond q(pose.linear());
    right.push_back({time, pose});
    wrong.push_back(right.back());
    wrong.back().pose.linear() =
        Eigen::Quaterniond(q.z(), q.w(), q.x(), q.y()).toRotationMatrix();
    time += 0.1;
  }
  writeTumTrajectory(folder.path("right.txt"), right);
  writeTumTrajectory(folder.path("wrong.txt"), wrong);
  const std::string map = "map " + street + " --labels " + street +
                          "/labels --crf none --map-only --output " + out + " --poses ";
  fs::remove(street + "/times.txt");
  EXPECT_FALSE(
      holds(succeed(map + folder.path("right.txt")), "warning: " + folder.path()));
  EXPECT_TRUE(holds(succeed(map + folder.path("wrong.txt")),
                    "wrong.txt: most poses are tilted or upside down, but upright if "
                    "the quaternions have w first"));
}

} // namespace pcl_semantic
