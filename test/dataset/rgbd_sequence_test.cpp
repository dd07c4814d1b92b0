// SPDX-License-Identifier: BSD-3-Clause
#include "support/temporary_folder.h"
#include "support/thrown_message.h"

#include <pcl_semantic/dataset/rgbd_sequence.h>
#include <pcl_semantic/files/stored_poses.h>
#include <pcl_semantic/images/image_file.h>

#include <opencv2/imgcodecs.hpp>

#include <filesystem>
#include <limits>

namespace {

using namespace pcl_semantic;

const PinholeCamera camera{2.0, 4.0, 1.0, 0.5};

// Two frames of 3 x 2 pixels; the second one's depth is that of the first times two.
class Rgbd : public testing::Test {
protected:
  Rgbd()
  {
    for (const char* name : {"rgb", "jpg", "depth"})
      std::filesystem::create_directories(folder.path(name));
    cv::Mat colour(2, 3, CV_8UC3, cv::Scalar(10, 20, 30));
    cv::Mat depth = (cv::Mat_<std::uint16_t>(2, 3) << 0, 1000, 2000, 500, 250, 65535);
    writePng(folder.path("rgb/a.png"), colour);
    writePng(folder.path("depth/a.png"), depth);
    cv::imwrite(folder.path("jpg/b.jpg"), colour);
    writePng(folder.path("rgb/b.png"), colour);
    writePng(folder.path("depth/b.png"), cv::Mat(2 * depth));
  }

  void
  expectRefused(const std::string& says) const
  {
    expectBadInput(says, [&] { RgbdSequence(folder.path(), camera).frame(0); });
  }

  TemporaryFolder folder;
};

void
expectFirstFrame(const RgbdFrame& frame, float metre)
{
  const auto& cloud = *frame.cloud;
  ASSERT_EQ(cloud.width, 3u);
  ASSERT_EQ(cloud.height, 2u);
  EXPECT_TRUE(std::isnan(cloud(0, 0).x));
  EXPECT_EQ(cloud(1, 0).getVector3fMap(), Eigen::Vector3f(0, -0.125f, 1) * metre);
  EXPECT_EQ(cloud(2, 0).getVector3fMap(), Eigen::Vector3f(1, -0.25f, 2) * metre);
  EXPECT_EQ(cloud(0, 1).r, 30);
  EXPECT_EQ(cloud(0, 1).b, 10);
  EXPECT_EQ(frame.image.at<cv::Vec3b>(1, 0)[2], 30);
}

TEST_F(Rgbd, FoldersHoldFramesOfTheSameNames)
{
  const RgbdSequence sequence(folder.path(), camera);
  ASSERT_EQ(sequence.size(), 2u);
  EXPECT_EQ(sequence.name(1), "b");
  expectFirstFrame(sequence.frame(0), 1.0f);
  EXPECT_TRUE(std::isnan(sequence.frame(0, 1.5).cloud->at(2, 0).z));
  EXPECT_EQ(RgbdSequence(folder.path(), camera, 500.0).frame(0).cloud->at(1, 0).z,
            2.0f);
}

TEST_F(Rgbd, TumsListsAreMatchedByTime)
{
  folder.write("rgb.txt",
               "# times\n100.01 rgb/a.png\n100.05 jpg/b.jpg\n101 rgb/b.png\n");
  folder.write("depth.txt",
               "100.00 depth/b.png\n100.02 depth/a.png\n100.06 depth/b.png\n");
  const RgbdSequence sequence(folder.path(), camera);
  ASSERT_EQ(sequence.size(), 2u) << "the third colour image has no depth image";
  EXPECT_EQ(sequence.name(0), "100.01");
  EXPECT_EQ(sequence.frame(1).timestamp, 100.05);
  EXPECT_EQ(sequence.frame(1).cloud->at(1, 0).z, 0.4f);
  EXPECT_EQ(sequence.doubts().at(0),
            folder.path("rgb.txt") +
                ": 1 of its 3 images have no depth image within "
                "0.02 s and are skipped; --depth-within allows more");
  EXPECT_EQ(RgbdSequence(folder.path(), camera, 0.0, 1.0).size(), 3u);
  EXPECT_TRUE(sequence.hasTimes());
  folder.write("rgb.txt", "90 rgb/a.png\n100.01 rgb/a.png\n100.05 jpg/b.jpg\n");
  const RgbdSequence gapped(folder.path(), camera);
  EXPECT_EQ(gapped.frameNumber(0), 1); // the position in the list
  EXPECT_EQ(gapped.frame(1).number, 2);
  std::vector<std::string> doubts;
  const auto images = RgbdSequence::colourImages(folder.path(), 0.02, &doubts);
  EXPECT_EQ(images.begin()->first, 1);
  EXPECT_EQ(images.size(), 2u);
  EXPECT_EQ(doubts.size(), 1u);
  EXPECT_THROW(RgbdSequence(folder.path(), camera, 0.0, -1.0),
               InvalidParameterException);
  EXPECT_EQ(sequence.posesPath(), "");
  folder.write("groundtruth.txt", "");
  EXPECT_EQ(RgbdSequence(folder.path(), camera).posesPath(),
            folder.path("groundtruth.txt"));
  for (const auto& [list, says] : std::vector<std::pair<std::string, std::string>>{
           {"100.00 depth/b.png\n100.00 depth/a.png\n",
            "depth.txt line 2: times have to rise"},
           {"7 depth/b.png\n", "no time is within 0.02 s"},
           {"7\n", "line 1: expected a time and a file"},
           {"nan depth/b.png\n", "line 1"}}) {
    folder.write("depth.txt", list);
    expectRefused(says);
  }
}

TEST_F(Rgbd, RefusesImagesThatDoNotBelongTogether)
{
  writePng(folder.path("depth/a.png"), cv::Mat(4, 6, CV_16UC1, cv::Scalar(1000)));
  expectRefused("has 6 x 4 pixels, expected ");
  writePng(folder.path("depth/a.png"), cv::Mat(2, 3, CV_8UC1, cv::Scalar(1)));
  expectRefused("8 bits, expected 16-bit grey, or 32-bit float TIFF (depths)");
  std::filesystem::remove(folder.path("depth/b.png"));
  expectRefused("depth/b.png: is missing");
  std::filesystem::remove_all(folder.path("depth"));
  expectRefused("no RGB-D sequence");
}

TEST_F(Rgbd, AllImagesHaveOneSizeAndAreWhole)
{
  std::filesystem::resize_file(folder.path("jpg/b.jpg"), 300);
  expectBadInput("is not complete", [&] { readImage(folder.path("jpg/b.jpg")); });
  for (const auto& [name, type] :
       {std::pair("rgb/b.png", CV_8UC3), std::pair("depth/b.png", CV_16UC1)})
    writePng(folder.path(name), cv::Mat(4, 6, type, cv::Scalar::all(1)));
  expectBadInput("rgb/b.png: has 6 x 4 pixels, expected those of",
                 [&] { RgbdSequence(folder.path(), camera).frame(1); });
}

TEST_F(Rgbd, NoMeasurementIsNoPointAndWhatCannotBeIsRefused)
{
  const RgbdSequence sequence(folder.path(), camera);
  const RgbdFrame frame = sequence.frame(0, 1.5);
  EXPECT_EQ(frame.unmeasured, 2u); // 0 and 65535; 2 m is too far
  for (const auto& [u, v] : {std::pair(0, 0), std::pair(2, 1)})
    EXPECT_TRUE(std::isnan(frame.cloud->at(u, v).z));
  for (const double depth : {-1.0, std::nan("")})
    expectBadParameter("max_depth is ", [&] { sequence.frame(0, depth); });
  expectBadParameter("frame 7 is beyond the 2 of the sequence",
                     [&] { sequence.frame(7); });
}

TEST_F(Rgbd, AScaleOrACameraThatIsNotTheImagesIsDoubtful)
{
  const auto of_camera =
      RgbdSequence(folder.path(), PinholeCamera{2.0, 4.0, 2.5, 0.5}).doubts();
  ASSERT_EQ(of_camera.size(), 1u);
  EXPECT_TRUE(
      holds(of_camera[0], "the principal point (2.5, 0.5) is far from the middle"));
  const auto doubts = [&](double scale) {
    return RgbdSequence(folder.path(), camera, scale).doubts();
  };
  EXPECT_TRUE(doubts(0.0).empty());
  EXPECT_TRUE(doubts(5000.0).empty());
  for (const auto& [scale, says] :
       {std::pair(1.0, "are more than 1000 m with depth scale 1; 1000 would give 1 m"),
        std::pair(1e6, "are less than 0.001 m")}) {
    ASSERT_EQ(doubts(scale).size(), 1u) << scale;
    EXPECT_TRUE(holds(doubts(scale)[0], says));
    EXPECT_TRUE(holds(doubts(scale)[0], "depth/a.png: half of its depths"));
  }
  expectBadParameter(
      "depth scale is 0.001, expected the value of 1 m in the depth images: 1000",
      [&] { doubts(0.001); });
}

// frame-N.color.png, .depth.png and .pose.txt, whose world has the axes of a camera.
TEST_F(Rgbd, SevenScenesAreReadAsTheyCome)
{
  const TemporaryFolder scene;
  const auto write = [&](const std::string& frame, const std::string& source,
                         const std::string& pose) {
    std::filesystem::copy(folder.path("rgb/" + source + ".png"),
                          scene.path(frame + ".color.png"));
    std::filesystem::copy(folder.path("depth/" + source + ".png"),
                          scene.path(frame + ".depth.png"));
    scene.write(frame + ".pose.txt", pose);
  };
  const std::string lost = "-1.#INF -inf nan -1.#IND\n";
  write("frame-000000", "a", "1 0 0 0.5\n0 1 0 0\n0 0 1 2\n0 0 0 1\n");
  write("frame-000001", "b", lost + lost + lost + lost);
  write("frame-000010", "b",
        "1.0e+000\t 0 0 1 \n0 1 0 0 \n0 0 1 3 \n0 0 0 1.0000000e+000 \n");
  RgbdSequence sequence(scene.path(), camera);
  EXPECT_EQ(sequence.size(), 3u);
  EXPECT_EQ(sequence.name(2), "frame-000010");
  EXPECT_FALSE(sequence.hasTimes());
  expectFirstFrame(sequence.frame(0), 1.0f);
  EXPECT_EQ(sequence.posesPath(), scene.path());
  EXPECT_TRUE(sequence.hasPoseFiles());
  EXPECT_EQ(RgbdSequence::colourImages(scene.path()).size(), 3u);
  const StoredTrajectory read = sequence.takePoseFiles();
  EXPECT_EQ(read.doubts.at(0),
            scene.path() + ": 1 of 3 frames have no finite pose and are skipped");
  ASSERT_EQ(sequence.size(), 2u);
  EXPECT_EQ(sequence.frameNumber(1), 2);
  const StoredPoses poses(read);
  const Eigen::Vector3d ahead =
      poses.pose({2, 0.0}).translation() - poses.pose({0, 0.0}).translation();
  EXPECT_TRUE(ahead.isApprox(Eigen::Vector3d(1.0, -0.5, 0.0))); // x forward, y left
  expectBadInput("none for frame 1", [&] { poses.pose({1, 0.0}); });
  const auto take = [&] { RgbdSequence(scene.path(), camera).takePoseFiles(); };
  scene.write("frame-000000.pose.txt", "1 0 0\n");
  expectBadInput("has 3 numbers, expected 16 (a 4 x 4 pose)", take);
  scene.write("frame-000000.pose.txt", "1 0 0 0 0 1 0 0 0 0 1 0 0 0 1 1");
  expectBadInput("the last row of its matrix is not 0 0 0 1", take);
  std::filesystem::remove(scene.path("frame-000000.pose.txt"));
  expectBadInput("frame-000000.pose.txt: is missing, the pose of ", take);
}

// color, depth and pose, in a world with z up.
TEST_F(Rgbd, ScannetsFoldersAreReadAsTheyCome)
{
  std::filesystem::rename(folder.path("rgb"), folder.path("color"));
  std::filesystem::create_directories(folder.path("pose"));
  const std::string turned = "0 0 1 5\n-1 0 0 6\n0 -1 0 ";
  for (const std::string name : {"a", "a0", "b"}) // one more than there are images
    folder.write("pose/" + name + ".txt",
                 turned + (name == "b" ? "7" : "1") + "\n0 0 0 1\n");
  RgbdSequence sequence(folder.path(), camera);
  EXPECT_EQ(sequence.size(), 2u);
  const StoredPoses poses(sequence.takePoseFiles());
  EXPECT_TRUE(poses.pose({1, 0.0}).translation().isApprox(Eigen::Vector3d(5, 6, 7)))
      << "by its name";
  std::filesystem::remove(folder.path("pose/a.txt"));
  expectBadInput("pose/a.txt: is missing, the pose of ",
                 [&] { RgbdSequence(folder.path(), camera).takePoseFiles(); });
  EXPECT_EQ(RgbdSequence(folder.path(), camera).size(), 2u)
      << "poses that are not used do not matter";
  std::filesystem::create_directories(folder.path("rgb"));
  writePng(folder.path("rgb/a.png"), cv::Mat(2, 3, CV_8UC3, cv::Scalar(1, 2, 3)));
  EXPECT_TRUE(
      holds(RgbdSequence(folder.path(), camera).doubts().at(1),
            "has colour images in two layouts; those in " + folder.path("rgb")));
}

TEST_F(Rgbd, DepthsMayBeFloatsOrTiff)
{
  constexpr float none = std::numeric_limits<float>::quiet_NaN();
  const cv::Mat depth = (cv::Mat_<float>(2, 3) << 0, 1, 2, 0.5f, 0.25f, none);
  std::filesystem::remove(folder.path("depth/a.png"));
  cv::imwrite(folder.path("depth/a.tiff"), depth);
  expectFirstFrame(RgbdSequence(folder.path(), camera).frame(0), 1.0f);
  EXPECT_TRUE(
      std::isnan(RgbdSequence(folder.path(), camera).frame(0).cloud->at(2, 1).z));
  cv::imwrite(folder.path("depth/a.tiff"), cv::Mat(1000 * depth));
  EXPECT_TRUE(holds(RgbdSequence(folder.path(), camera).doubts().at(0),
                    "are more than 1000 m with depth scale 1; 1000 would give 1 m"));
  expectFirstFrame(RgbdSequence(folder.path(), camera, 1000.0).frame(0), 1.0f);
  cv::Mat whole;
  cv::Mat(1000 * depth).convertTo(whole, CV_16U);
  cv::imwrite(folder.path("depth/a.tiff"), whole);
  expectFirstFrame(RgbdSequence(folder.path(), camera).frame(0), 1.0f);
  cv::imwrite(folder.path("depth/a.tiff"), cv::Mat(2, 3, CV_8UC1, cv::Scalar(1)));
  expectRefused("expected 16-bit grey, or 32-bit float TIFF (depths)");
  folder.write("depth/a.tiff", "II*");
  expectRefused("is not a TIFF image");
}

} // namespace
