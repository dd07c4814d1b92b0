// SPDX-License-Identifier: BSD-3-Clause
#include "support/temporary_folder.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/camera_doubts.h>
#include <pcl_semantic/dataset/camera_images.h>
#include <pcl_semantic/dataset/pinhole_camera.h>
#include <pcl_semantic/dataset/rectifier.h>
#include <pcl_semantic/dataset/rgbd_sequence.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/images/image_file.h>

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include <array>
#include <filesystem>

namespace pcl_semantic {

namespace {

const std::string size = "width: 640\nheight: 480\n",
                  no_distortion = "D: [0, 0, 0, 0]\n",
                  K = "K: [400, 0, 320, 0, 401, 240, 0, 0, 1]\n",
                  R = "R: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n",
                  P = "P: [500, 0, 300, 0, 0, 502, 220, 0, 0, 0, 1, 0]\n";

std::string
regionOfInterest(int x, int y, int width, int height)
{
  return "roi:\n  x_offset: " + std::to_string(x) +
         "\n  y_offset: " + std::to_string(y) +
         "\n  height: " + std::to_string(height) +
         "\n  width: " + std::to_string(width) + "\n  do_rectify: false\n";
}

const std::string euroc =
    "# General sensor definitions.\nsensor_type: camera\ncomment: VI-Sensor cam0\n"
    "T_BS:\n  cols: 4\n  rows: 4\n  data: [0, -1, 0, X, 1, 0, 0, 0.02,\n"
    "    0, 0, 1, 0.03, 0, 0, 0, 1]\nrate_hz: 20\nresolution: [752, 480]\n"
    "camera_model: pinhole\nintrinsics: [458.6, 457.2, 367.2, 248.3] #fu, fv, cu, cv\n"
    "distortion_model: radial-tangential\ndistortion_coefficients: ";

std::string
eurocCamera(const std::string& x, const std::string& coefficients)
{
  std::string text = euroc;
  text.replace(text.find('X'), 1, x);
  return text + coefficients + "\n";
}

const std::string middlebury =
    "cam0=[3979.911 0 1244.772; 0 3979.911 1019.507; 0 0 1]\n"
    "cam1=[3979.911 0 1369.115; 0 3979.911 1019.507; 0 0 1]\ndoffs=124.343\n"
    "baseline=193.001\nwidth=2964\nheight=1988\nndisp=270\n";

const std::string kitti_raw =
    "calib_time: 09-Jan-2012 13:57:47\ncorner_dist: 9.950000e-02\n"
    "S_rect_02: 1.242000e+03 3.750000e+02\n"
    "P_rect_02: 721.5 0 609.5 44.8 0 721.5 172.8 0.2 0 0 1 0.003\n"
    "P_rect_03: 721.5 0 609.5 -339.5 0 721.5 172.8 2.2 0 0 1 0.003\n";

struct GoodCamera {
  std::string file, numbers; // fx, fy, cx, cy, width and height
  std::string text;
  std::string doubt = ""; // part of the only one; empty = none
};

void
expectCamera(const GoodCamera& good)
{
  SCOPED_TRACE(good.text);
  const TemporaryFolder folder;
  const PinholeCamera read = readPinholeCamera(folder.write(good.file, good.text));
  const std::vector<double> numbers = parseNumbers(good.numbers, "");
  const double found[] = {
      read.fx, read.fy, read.cx, read.cy, double(read.width), double(read.height)};
  for (std::size_t i = 0; i < 6; ++i)
    EXPECT_NEAR(found[i], numbers.at(i), 1e-9) << i;
  ASSERT_EQ(read.doubts.size(), good.doubt.empty() ? 0u : 1u);
  if (!good.doubt.empty()) {
    EXPECT_TRUE(holds(read.doubts[0], good.doubt));
  }
}

} // namespace

TEST(CameraFile, KnowsAllThatAFileStates)
{
  const std::string full = size + no_distortion + K + R;
  const std::string kalibr =
      "cam0:\n  camera_model: pinhole\n  distortion_model: radtan\n"
      "  distortion_coeffs: [0, 0, 0, 0]\n  intrinsics: [400, 401, 320, 240]\n"
      "  resolution: [640, 480]\n";
  const std::string of_K = "400 401 320 240 640 480", of_P = "500 502 300 220 640 480",
                    turned =
                        size + no_distortion + K + "R: [0, -1, 0, 1, 0, 0, 0, 0, 1]\n",
                    K_of_ros = "[500.5, 0, 320, 0, 501, 240, 0, 0, 1]\n";
  for (const GoodCamera& good : std::vector<GoodCamera>{
           {"c.yaml", "400 401 320 240 0 0", K},
           {"c.yaml", of_K, full},
           {"c.yaml", of_P, full + P},
           {"c.yaml", of_K, full + "---\n"},
           {"c.yaml", of_K, full + "P: [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]\n"},
           {"c.yaml", "250 125.5 150 55 320 120",
            full + P + "binning_x: 2\nbinning_y: 4\n"},
           {"c.yaml", of_K,
            full + "binning_x: 0\nbinning_y: 0\n" + regionOfInterest(0, 0, 0, 0)},
           {"c.yaml", "200 200.5 110 100 160 120",
            full + "binning_x: 2\nbinning_y: 2\n" +
                regionOfInterest(100, 40, 320, 240)},
           {"c.yaml", of_P, turned + P, "P is used instead of K"},
           {"c.yaml", of_K,
            turned + "P: [400, 0, 320, 0, 0, 401, 240, 0, 0, 0, 1, 0]\n",
            "R is not used"},
           {"c.yaml", of_K,
            full + "P: [400, 0, 320, -48, 0, 401, 240, 0, 0, 0, 1, 0]\n",
            "not the left one of its pair"},
           {"c.yaml", "500.5 501 320 240 640 480",
            "image_width: 640\nimage_height: 480\ncamera_matrix:\n  rows: 3\n  cols: "
            "3\n  data: " +
                K_of_ros +
                "distortion_coefficients:\n  rows: 1\n  cols: 5\n  data: [0, 0, 0, 0, "
                "0]\n"},
           {"c.yaml", "500.5 501 320 240 0 0", "D: [0, 0, 0, 0, 0]\nK: " + K_of_ros},
           {"c.yaml", "500.5 501 320 240 0 0",
            "cam0:\n  intrinsics: [500.5, 501, 320, 240]\n  distortion_coeffs: [0, 0, "
            "0, "
            "0]\n"},
           {"c.yml", of_K, kalibr},
           {"c.yml", of_K, kalibr + "cam1:\n  intrinsics: [1, 1, 1, 1]\n",
            "c.yml line 1: cam0 is used, not cam1"},
           {"sensor.yaml", "458.6 457.2 367.2 248.3 752 480",
            eurocCamera("0", "[0, 0, 0, 0]")},
           {"calib.txt", "3979.911 3979.911 1244.772 1019.507 2964 1988", middlebury},
           {"calib.txt", "721.5 721.5 609.5 172.8 1242 375", kitti_raw},
           {"calibration.txt", "726 727 354 186 0 0", "726 727 354 186\n"}})
    expectCamera(good);
}

TEST(CameraFile, ALensIsReadAndToldOf)
{
  const TemporaryFolder folder;
  const auto read = [&](const std::string& text) {
    return readPinholeCamera(folder.write("c.yaml", text));
  };
  EXPECT_FALSE(read(size + K + no_distortion).isDistorted());
  const PinholeCamera radial = read(size + K + P + "D: [0.1, 0, 0, 0]\n");
  EXPECT_EQ(radial.distortion, (std::vector<double>{0.1, 0, 0, 0}));
  EXPECT_FALSE(radial.is_fisheye);
  EXPECT_EQ(radial.fx, 400.0) << "P is of other images";
  ASSERT_EQ(radial.doubts.size(), 1u);
  EXPECT_TRUE(holds(radial.doubts[0],
                    "c.yaml line 5: D: the images will be undistorted "
                    "with these coefficients; if they are already"));
  for (const std::string model :
       {"distortion_model: equidistant\n", "fisheye_model: 1\n"}) {
    const PinholeCamera fisheye = read(size + K + no_distortion + model);
    EXPECT_TRUE(fisheye.is_fisheye);
    EXPECT_TRUE(fisheye.isDistorted())
        << "with coefficients of 0 it still is no pinhole";
    ASSERT_EQ(fisheye.doubts.size(), 1u);
    EXPECT_TRUE(
        holds(fisheye.doubts[0], "the images of this fisheye will be undistorted"));
  }
}

TEST(CameraFile, RefusesWhatItCannotUse)
{
  for (const auto& [file, text, says] : std::vector<std::array<std::string, 3>>{
           {"c.yaml", K + no_distortion + "distortion_model: ds\n",
            "distortion_model is 'ds', expected 'plumb_bob' or 'rational_polynomial' "
            "or "
            "'none' or 'equidistant'; omnidirectional models are not supported"},
           {"c.yaml", K + no_distortion + "fisheye_model: 2\n", "expected 0 or 1"},
           {"c.yaml",
            K + no_distortion + "fisheye_model: 0\ndistortion_model: fisheye\n",
            "fisheye_model is 0, but distortion_model is 'fisheye'"},
           {"c.yaml", K + "distortion_model: equidistant\n",
            "c.yaml: states no distortion coefficients, expected the 4"},
           {"c.yaml", K + "D: []\ndistortion_model: equidistant\n",
            "D: has 0 numbers, expected the 4"},
           {"c.yaml", "cam0:\n  camera_model: omni\n  intrinsics: [1, 1, 1, 1, 1]\n",
            "camera_model is 'omni', expected 'pinhole'"},
           {"c.yaml", "sensor_type: imu\nintrinsics: [1, 1, 1, 1]\n",
            "sensor_type is 'imu'"},
           {"c.yaml", "width: 640\n" + K, "expected both 'width' and 'height'"},
           {"c.yaml", size + "image_size: [320, 240]\n" + K,
            "the image size is 320 x 240, but 'width' says 640 x 480"},
           {"c.yaml", size + K + "binning_x: -1\n", "binning_x: is -1"},
           {"c.yaml", size + K + regionOfInterest(500, 0, 200, 100),
            "the region of interest, 200 x 100 at 500, 0, is not inside 640 x 480"},
           {"c.yaml", size + K + regionOfInterest(5, 0, 0, 0), "roi: has 0 x 0 pixels"},
           {"c.yaml", K + R + "P: [1, 2, 3]\n", "P: has 3 numbers, expected 12"},
           {"c.yaml", K + "P: [1, 9, 3, 0, 0, 1, 3, 0, 0, 0, 1, 0]\n",
            "P: is no camera matrix"},
           {"c.yaml", "K1: [400, 0, 320, 0, 401, 240, 0, 0, 1]\n",
            "is the calibration of a pair"},
           {"c.yaml", "Camera.fx: 500\n", "has neither camera_matrix or K"},
           {"c.yaml", "width: 3\n", "has neither camera_matrix"},
           {"c.yaml", K + "D: [0.1, 0, 0]\n", "has 3 distortion coefficients"},
           {"c.yaml", "K: [1, 2]\n", "is no camera matrix"},
           {"c.yaml", "K: [0, 0, 1, 0, 1, 1, 0, 0, 1]\n", "fx 0"},
           {"c.yaml", "cam0:\n  intrinsics: [1, 2]\n", "expected fx, fy"},
           {"c.yaml", "<?xml version=\"1.0\"?>\n", "c.yaml: is XML"},
           {"calib.txt", "cam0=[1 0 0; 0 1 0; 0 0 1]\n", "has no line 'cam1='"}}) {
    SCOPED_TRACE(text);
    const TemporaryFolder folder;
    const std::string path = folder.write(file, text);
    expectBadInput(says, [&] { readPinholeCamera(path); });
  }
}

TEST(CameraFile, ImagesOfAnotherSizeAreRefusedByAllThatTakeIt)
{
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder.path("s/rgb"));
  std::filesystem::create_directories(folder.path("s/depth"));
  writePng(folder.path("s/rgb/0.png"), cv::Mat(240, 320, CV_8UC3, cv::Scalar::all(9)));
  writePng(folder.path("s/depth/0.png"), cv::Mat(240, 320, CV_16UC1, 1000.0));
  const std::string half = "binning_x: 2\nbinning_y: 2\n";
  for (const auto& [text, says] : std::vector<std::pair<std::string, std::string>>{
           {size + K, "0.png: has 320 x 240 pixels, but c.yaml is the calibration of "
                      "640 x 480"},
           {size + K + "binning_x: 4\nbinning_y: 4\n",
            "of 160 x 120 (640 x 480, binning 4 x 4)"},
           {size + K + regionOfInterest(1, 2, 320, 200),
            "of 320 x 200 (640 x 480, region of interest 320 x 200 at 1, 2)"},
           {K, "c.yaml: the principal point (320, 240) is outside the images of 320 x "
               "240"},
           {size + K + half, ""},
           {size + K + regionOfInterest(200, 100, 320, 240), ""}}) {
    PinholeCamera camera = readPinholeCamera(folder.write("c.yaml", text));
    camera.calibration = "c.yaml";
    const auto open = [&] { RgbdSequence(folder.path("s"), camera); };
    const auto openImages = [&] { CameraImages(folder.path("s/rgb/*.png"), camera); };
    if (says.empty()) {
      EXPECT_NO_THROW(open());
      EXPECT_NO_THROW(openImages());
      continue;
    }
    expectBadInput(says, open);
    expectBadInput(says, openImages);
  }
}

TEST(CameraFile, APairOfEuroc)
{
  const TemporaryFolder folder;
  // The body is turned: the cameras stand along its y axis.
  std::string second = eurocCamera("0", "[-0.28, 0.07, 0.0002, 0.00002]");
  second.replace(second.find("0.02,"), 5, "0.13,");
  const std::string left = folder.write(
                        "0.yaml", eurocCamera("0", "[-0.28, 0.07, 0.0002, 0.00002]")),
                    right = folder.write("1.yaml", second);
  const StereoRig rig = readStereoRig(left, right);
  EXPECT_EQ(rig.width, 752);
  EXPECT_EQ(rig.D2, (std::vector<double>{-0.28, 0.07, 0.0002, 0.00002}));
  EXPECT_TRUE(rig.R.isIdentity(1e-12));
  EXPECT_TRUE(rig.T.isApprox(Eigen::Vector3d(-0.11, 0, 0), 1e-12)) << rig.T;
  expectBadInput("is the sensor.yaml of one camera", [&] { readStereoRig(left); });
}

TEST(CameraFile, APairOfMiddlebury)
{
  const TemporaryFolder folder;
  const RectifiedPair pair =
      readRectifiedPair({folder.write("calib.txt", middlebury), ""},
                        {{2964, 1988}, "im0.png"}, KittiCameras::colour);
  ASSERT_TRUE(pair.rectifier); // to one principal point, which cuts the margins off
  EXPECT_NEAR(pair.camera.fx, 3979.911, 400.0);
  EXPECT_NEAR(pair.camera.baseline, 0.193001, 1e-9);
  expectBadInput("im0.png: has 741 x 497 pixels, but ", [&] {
    readRectifiedPair({folder.path("calib.txt"), ""}, {{741, 497}, "im0.png"},
                      KittiCameras::colour);
  });
}

TEST(CameraFile, ThePairOfKittisRawDataHasItsSize)
{
  const TemporaryFolder folder;
  const std::string path = folder.write("calib_cam_to_cam.txt", kitti_raw);
  const KittiCalibration calibration = readKittiCalibration(path, KittiCameras::colour);
  EXPECT_EQ(calibration.camera.width, 1242);
  expectBadInput("im0.png: has 1392 x 512 pixels, but ", [&] {
    readRectifiedPair({path, ""}, {{1392, 512}, "im0.png"}, KittiCameras::colour);
  });
}

TEST(CameraFile, KittisObjectsHaveTheScannerInTwoParts)
{
  const TemporaryFolder folder;
  const std::string left = ": 721.5 0 609.5 0 0 721.5 172.8 0 0 0 1 0\n";
  const std::string path = folder.write(
      "000000.txt", "P2" + left + "P3: 721.5 0 609.5 -380 0 721.5 172.8 0 0 0 1 0\n" +
                        "R0_rect: 0 -1 0 1 0 0 0 0 1\n"
                        "Tr_velo_to_cam: 1 0 0 2 0 1 0 3 0 0 1 4\n");
  const KittiCalibration calibration = readKittiCalibration(path, KittiCameras::colour);
  ASSERT_TRUE(calibration.T_camera0_velodyne);
  EXPECT_TRUE(calibration.T_camera0_velodyne->translation().isApprox(
      Eigen::Vector3d(-3, 2, 4), 1e-12));
}

TEST(CameraFile, RectifiedCamerasOfRosUseP)
{
  const TemporaryFolder folder;
  const auto camera = [&](const std::string& name, const std::string& K_of,
                          const std::string& P_of, const std::string& more) {
    return folder.write(name, no_distortion + R + "K: [" + K_of +
                                  ", 0, 0, 1]\nP: [500, 0, 300, " + P_of +
                                  ", 0, 500, 220, 0, 0, 0, 1, 0]\n" + more);
  };
  const std::string left = camera("l.yaml", "400, 0, 320, 0, 400, 240", "0", size),
                    right = camera("r.yaml", "410, 0, 322, 0, 410, 241", "-50", size);
  const RectifiedPair pair =
      readRectifiedPair({left, right}, {{640, 480}, "l.png"}, KittiCameras::colour);
  EXPECT_EQ(pair.camera.fx, 500.0);
  EXPECT_EQ(pair.camera.cx, 300.0);
  EXPECT_NEAR(pair.camera.baseline, 0.1, 1e-12);
  EXPECT_TRUE(pair.T_camera0_camera.isApprox(Eigen::Isometry3d::Identity()));

  const std::string binned = camera("b.yaml", "400, 0, 320, 0, 400, 240", "-50",
                                    size + "binning_x: 2\nbinning_y: 2\n");
  expectBadInput(
      "the right images have 320 x 240 (640 x 480, binning 2 x 2) pixels, but ",
      [&] { readStereoRig(left, binned); });
}

TEST(CameraFile, ACameraOfOtherImagesIsDoubtful)
{
  const StereoCamera good{500, 500, 320, 240, 0.1, 640, 480};
  EXPECT_TRUE(doubtsOf(good).empty());
  StereoCamera half = good, normalised = good, unknown = good;
  half.width = 1280;
  half.height = 960;
  normalised.fx = normalised.fy = 0.8;
  unknown.width = unknown.height = 0;
  EXPECT_TRUE(holds(doubtsOf(half).at(0), "images of another size"));
  EXPECT_TRUE(holds(doubtsOf(normalised).at(0), "is it in pixels?"));
  EXPECT_TRUE(doubtsOf(unknown).empty());
}

} // namespace pcl_semantic
