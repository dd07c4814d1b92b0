// SPDX-License-Identifier: BSD-3-Clause
#include "support/bad_case.h"
#include "support/map_folder.h"
#include "support/mapped_street.h"
#include "support/same_image.h"
#include "support/thrown_message.h"

#include <pcl_semantic/dataset/kitti_sequence.h>
#include <pcl_semantic/dataset/lidar_scan.h>
#include <pcl_semantic/evaluation/depth_file.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/images/distribution_file.h>

#include <opencv2/core.hpp>

#include <cmath>

namespace pcl_semantic {

namespace {

// Scans of a street as a laser would make them: its true disparities, every third
// pixel, in the scanner's frame.
void
addScans(const std::string& street)
{
  const KittiSequence sequence(street);
  const StereoCamera& camera = sequence.camera();
  const Eigen::Isometry3d T_velodyne_camera =
      sequence.T_camera0_velodyne().inverse() * sequence.T_camera0_camera();
  std::filesystem::create_directories(street + "/velodyne");
  for (const char* frame : {"000000", "000001", "000002"}) {
    const cv::Mat1w disparity =
        readPng(street + "/disparity/" + frame + ".png", ImageKind::disparity);
    std::ofstream stream(street + "/velodyne/" + frame + ".bin", std::ios::binary);
    for (int v = 1; v < disparity.rows; v += 3)
      for (int u = 1; u < disparity.cols; u += 3) {
        if (disparity(v, u) == 0)
          continue;
        const double depth = camera.fx * camera.baseline * 256.0 / disparity(v, u);
        const Eigen::Vector3f point =
            (T_velodyne_camera * camera.unproject(u, v, depth)).cast<float>();
        const float record[] = {point.x(), point.y(), point.z(), 0.5f};
        stream.write(reinterpret_cast<const char*>(record), sizeof(record));
      }
  }
}

cv::Mat
imageOf(const std::string& path)
{
  return readPng(path, ImageKind::labels);
}

// One map with everything that --also knows, for all tests.
class EvaluatedMap : public testing::Test {
protected:
  static void
  SetUpTestSuite()
  {
    folder_ = std::make_unique<TemporaryFolder>();
    copyStreet(street());
    addScans(street());
    mapStreet(street(), folder_->path("map"),
              "--no-things --crf dense --also measured,depth,probabilities,scans "
              "--scan-within 0.3 "
              "--voxel-size 0.2");
  }

  static std::string
  street()
  {
    return folder_->path("street");
  }

  static std::string
  map(const std::string& name)
  {
    return folder_->path("map/" + name);
  }

  static inline std::unique_ptr<TemporaryFolder> folder_;
};

// The label of a point in the world, voxel by voxel, as the finished map says: of the
// voxel that is nearest and within a distance of its cube.
Label
plainLabel(const Eigen::Vector3d& point, const MapFolder& map, double within)
{
  Label label = kUnlabelled;
  double least = within + 1e-9;
  for (std::size_t i = 0; i < map.voxels.size(); ++i) {
    const Eigen::Array3d offset = point - map.voxels.centre(i).cast<double>();
    const double distance =
        (offset.abs() - 0.5 * map.voxels.voxel_size).max(0.0).matrix().norm();
    if (distance < least) {
      least = distance;
      label = Label((*map.voxels.cloud)[i].label);
    }
  }
  return label;
}

std::vector<Label>
plainScanLabels(const std::string& street, const MapFolder& map, int frame,
                double within)
{
  const KittiSequence sequence(street);
  const Eigen::Isometry3d T_world_velodyne =
      map.T_world_camera0[std::size_t(frame)] * sequence.T_camera0_velodyne();
  const auto scan =
      readVelodyneScan(street + "/velodyne/" + frameFileName(frame, ".bin"));
  std::vector<Label> labels;
  for (const pcl::PointXYZI& point : *scan)
    labels.push_back(plainLabel(
        T_world_velodyne * point.getVector3fMap().cast<double>(), map, within));
  return labels;
}

} // namespace

TEST_F(EvaluatedMap, MeasuredLabelsAreThoseOfAMapWithoutCrf)
{
  mapStreet(street(), folder_->path("plain"),
            "--no-things --crf none --also measured,depth,scans --voxel-size 0.2");
  const auto plain = [&](const std::string& name) {
    return folder_->path("plain/" + name);
  };
  int changed = 0;
  for (const std::string frame : {"/000000", "/000001", "/000002"}) {
    for (const auto& [measured, same] :
         {std::pair("measured_labels", "labels"),
          std::pair("measured_labels_at_depth", "labels_at_depth"),
          std::pair("final_measured_labels", "final_labels"),
          std::pair("final_measured_labels_at_depth", "final_labels_at_depth")}) {
      const cv::Mat expected = imageOf(plain(same + frame + ".png"));
      EXPECT_TRUE(isSameImage(imageOf(map(measured + frame + ".png")), expected));
      EXPECT_TRUE(isSameImage(imageOf(plain(measured + frame + ".png")), expected));
      changed += cv::countNonZero(imageOf(map(same + frame + ".png")) != expected);
    }
    for (const auto& [measured, same] :
         {std::pair("measured_scan_labels", "scan_labels"),
          std::pair("final_measured_scan_labels", "final_scan_labels")})
      EXPECT_EQ(bytesOf(map(measured + frame + ".label")),
                bytesOf(plain(same + frame + ".label")));
  }
  EXPECT_GT(changed, 0); // the CRF does something
}

TEST_F(EvaluatedMap, PointsOfScansHaveTheLabelOfTheirVoxel)
{
  const MapFolder finished = readMapFolder(folder_->path("map"));
  std::size_t labelled = 0;
  for (const auto& [name, within] : {std::pair("final_scan_labels", 0.0),
                                     std::pair("final_near_scan_labels", 0.3)}) {
    const std::vector<Label> labels = readScanLabels(map(name) + "/000001.label", 11);
    const std::vector<Label> expected = plainScanLabels(street(), finished, 1, within);
    ASSERT_EQ(labels.size(), expected.size());
    // Points on a face may fall to either side: poses and centres are rounded.
    std::size_t different = 0;
    const std::size_t before = labelled;
    labelled = 0;
    for (std::size_t i = 0; i < labels.size(); ++i) {
      different += labels[i] != expected[i];
      labelled += labels[i] != kUnlabelled;
    }
    EXPECT_LE(different, labels.size() / 200) << name;
    EXPECT_GT(labelled, labels.size() / 4) << name;
    EXPECT_GT(labelled, before) << name;
  }
  // The last frame sees the finished map.
  EXPECT_EQ(bytesOf(map("scan_labels/000002.label")),
            bytesOf(map("final_scan_labels/000002.label")));
}

TEST_F(EvaluatedMap, TheNetworkLabelsTheVisiblePoints)
{
  const KittiSequence sequence(street());
  const auto scan = readVelodyneScan(street() + "/velodyne/000001.bin");
  const std::vector<Label> labels =
      readScanLabels(map("network_scan_labels/000001.label"), 11);
  const cv::Mat1b image = imageOf(map("network_labels/000001.png"));
  ASSERT_EQ(labels.size(), scan->size());
  const cv::Mat1w disparity =
      readPng(street() + "/disparity/000001.png", ImageKind::disparity);
  std::size_t i = 0;
  for (int v = 1; v < disparity.rows; v += 3)
    for (int u = 1; u < disparity.cols; u += 3)
      if (disparity(v, u) > 0) {
        ASSERT_EQ(labels[i++], image(v, u));
      }
  EXPECT_EQ(i, labels.size());
}

TEST_F(EvaluatedMap, DepthIsThatOfTheStereoPair)
{
  const KittiSequence sequence(street());
  const cv::Mat1f depth = readDepths(map("depth/000001.png"));
  const cv::Mat1w disparity =
      readPng(street() + "/disparity/000001.png", ImageKind::disparity);
  const double scale = sequence.camera().fx * sequence.camera().baseline * 256.0;
  int near = 0, all = 0;
  for (int v = 0; v < depth.rows; ++v)
    for (int u = 0; u < depth.cols; ++u) {
      if (depth(v, u) == 0.0f || disparity(v, u) == 0)
        continue;
      ++all;
      near += std::abs(depth(v, u) * disparity(v, u) / scale - 1.0) < 0.15;
    }
  EXPECT_GT(all, depth.rows * depth.cols / 3);
  EXPECT_GT(near, all * 3 / 4);
}

TEST_F(EvaluatedMap, TheFinishedMapIsLookedUpAtTheDepths)
{
  const MapFolder finished = readMapFolder(folder_->path("map"));
  const KittiSequence sequence(street());
  const Eigen::Isometry3d T_world_camera =
      finished.T_world_camera0[0] * sequence.T_camera0_camera();
  const cv::Mat1f depth = readDepths(map("depth/000000.png"));
  const cv::Mat1b labels = imageOf(map("final_labels_at_depth/000000.png"));
  int looked_up = 0, different = 0;
  for (int v = 0; v < depth.rows; v += 5)
    for (int u = 0; u < depth.cols; u += 7) {
      if (depth(v, u) == 0.0f) {
        EXPECT_EQ(labels(v, u), 0);
        continue;
      }
      const Eigen::Vector3d point =
          T_world_camera * sequence.camera().unproject(u, v, double(depth(v, u)));
      ++looked_up;
      different += labels(v, u) != plainLabel(point, finished, 0.0);
    }
  EXPECT_GT(looked_up, 100);
  EXPECT_LE(different, looked_up / 100); // of voxels' faces: poses are rounded

  // The last frame sees the finished map; its depth image is rounded.
  const cv::Mat1b causal = imageOf(map("labels_at_depth/000002.png"));
  const cv::Mat1b same = imageOf(map("final_labels_at_depth/000002.png"));
  EXPECT_LT(cv::countNonZero(causal != same), cv::countNonZero(causal) / 50);
  EXPECT_GT(cv::countNonZero(imageOf(map("labels_at_depth/000000.png")) != labels), 0);
}

TEST_F(EvaluatedMap, EvaluationTellsCausalFromFinal)
{
  const auto evaluated = [&](const std::string& labels) {
    return succeed("evaluate --truth " + street() + "/gt" + of_kitti11 +
                   " --prediction " + map(labels));
  };
  EXPECT_EQ(evaluated("labels/").rfind("causal: ", 0), 0u);
  EXPECT_EQ(evaluated("labels_at_depth").rfind("causal: ", 0), 0u);
  EXPECT_EQ(evaluated("final_labels_at_depth").rfind("final: ", 0), 0u);
  EXPECT_EQ(evaluated("network_labels --json").rfind("{\n  \"labels\": \"network\"", 0),
            0u);
  EXPECT_EQ(evaluated("../street/gt").rfind("class", 0), 0u); // of no map
  EXPECT_TRUE(holds(evaluated("labels --truth " + street() + "/gt --prediction " +
                              map("final_labels")),
                    "warning: the predictions are not of one kind: "));
}

TEST_F(EvaluatedMap, ProbabilitiesAreThoseOfTheLabels)
{
  const cv::Mat labels = imageOf(map("labels_at_depth/000001.png"));
  const LabelDistributions probabilities = readDistributions(
      map("probabilities_at_depth/000001.npy"), labels.cols, labels.rows, 11, 1.0f);
  int different = 0;
  for (Eigen::Index i = 0; i < probabilities.size(); ++i)
    different += probabilities.mapLabel(i) != labels.data[i];
  EXPECT_LT(different, 10); // half precision makes a tie now and then
}

// The points of a map lie in their voxels; their centres are an option.
TEST_F(EvaluatedMap, CentresOfVoxelsAreAnOption)
{
  const std::string centres = folder_->path("centres");
  mapStreet(street(), centres, "--no-things --crf dense --voxel-size 0.2 --centres");
  const MapFolder at_centres = readMapFolder(centres);
  const MapFolder on_surface = readMapFolder(folder_->path("map"));
  EXPECT_EQ(at_centres.voxels.indices, on_surface.voxels.indices);
  std::size_t moved = 0;
  for (std::size_t i = 0; i < at_centres.voxels.size(); ++i) {
    const Eigen::Vector3f centre = at_centres.voxels.centre(i);
    EXPECT_EQ((*at_centres.voxels.cloud)[i].getVector3fMap(), centre);
    moved += (*on_surface.voxels.cloud)[i].getVector3fMap() != centre;
  }
  EXPECT_GT(moved, on_surface.voxels.size() / 2);
  EXPECT_EQ(bytesOf(centres + "/final_labels/000001.png"),
            bytesOf(map("final_labels/000001.png")));
}

TEST_F(EvaluatedMap, ALaterRunRemovesWhatItDoesNotWrite)
{
  const std::string again = folder_->path("again");
  mapStreet(street(), again, "--crf none --also measured,scans --frames 0:2");
  EXPECT_TRUE(std::filesystem::exists(again + "/scan_labels/000001.label"));
  mapStreet(street(), again, "--crf none --frames 0:1");
  EXPECT_EQ(filesIn(again), filesOfMap({"000000"}));
}

TEST_F(EvaluatedMap, AJumpOfThePosesIsWarnedOf)
{
  const std::string poses = folder_->path("jump.txt");
  std::filesystem::copy_file(street() + "/poses.txt", poses);
  setWord(poses, 2, 12, "900000");
  const std::string command = mapOf(street()) + " --crf none --map-only --output " +
                              folder_->path("jumped") + " --poses ";
  const std::string jumped = succeed(command + poses);
  EXPECT_TRUE(holds(jumped, "warning: frame 1 is 9"));
  EXPECT_TRUE(holds(jumped, "in metres?"));
  EXPECT_FALSE(holds(succeed(command + street() + "/poses.txt"), "warning"));
}

// A run that fails leaves the earlier map, a run that ends its own alone.
TEST_F(EvaluatedMap, TheEarlierMapStaysUntilTheNewOneIsWhole)
{
  const std::string again = folder_->path("kept"), previous = again + "/previous";
  const std::string options =
      "--crf none --also depth --voxel-size 0.3 --output " + again;
  const std::string street_copy = folder_->path("kept_street");
  copyStreet(street_copy);
  succeed(mapOf(street_copy) + " " + options);
  std::ofstream(again + "/labels/notes.txt") << "mine";
  const std::string map = bytesOf(again + "/map.pcd");
  const auto files = filesIn(again);
  const std::string labels = bytesOf(street_copy + "/labels/000002.bin");
  std::ofstream(street_copy + "/labels/000002.bin") << "cut";
  for (int time = 0; time < 2; ++time) { // of two that fail the second has less to keep
    expectFails(mapOf(street_copy) + " " + options, 3, "000002.bin: has 3 bytes");
    EXPECT_EQ(readMapFolder(previous).frames, (std::vector<int>{0, 1, 2}));
    EXPECT_TRUE(bytesOf(previous + "/map.pcd") == map);
    EXPECT_TRUE(std::filesystem::exists(previous + "/depth/000002.png"));
    EXPECT_FALSE(std::filesystem::exists(again + "/map.pcd"));
    EXPECT_EQ(bytesOf(again + "/labels/notes.txt"), "mine");
  }
  std::ofstream(street_copy + "/labels/000002.bin") << labels;
  succeed(mapOf(street_copy) + " " + options);
  EXPECT_EQ(filesIn(again), files) << "and nothing else";
  EXPECT_TRUE(bytesOf(again + "/map.pcd") == map);

  // A foreign folder of that name is neither used nor removed.
  std::filesystem::create_directories(previous);
  std::ofstream(previous + "/map.pcd") << "mine";
  expectFails(mapOf(street_copy) + " " + options, 5,
              "previous: is not of an earlier run");
  EXPECT_TRUE(bytesOf(again + "/map.pcd") == map);
  std::filesystem::remove_all(previous);
  std::filesystem::create_directories(folder_->path("elsewhere"));
  std::ofstream(folder_->path("elsewhere/map.pcd")) << "mine";
  std::filesystem::create_directory_symlink(folder_->path("elsewhere"), previous);
  expectFails(mapOf(street_copy) + " " + options, 5, "is not of an earlier run");
  EXPECT_EQ(bytesOf(folder_->path("elsewhere/map.pcd")), "mine");
}

TEST(EvaluatedMapTool, BadInput)
{
  const std::string map = "map STREET --output OUT --labels STREET/labels ";
  expectAllFail({{2, "--also: 'laser'", map + "--also measured,laser"},
                 {3, "velodyne/000000.bin: is missing", map + "--also scans"},
                 {2, "--scan-within is 3", map + "--also scans --scan-within 3"},
                 {2, "needs a SEQUENCE",
                  "map --left 'STREET/image_2/*.png' --right 'STREET/image_3/*.png' "
                  "--calibration STREET/calib.txt --poses STREET/poses.txt "
                  "--labels STREET/labels --output OUT --also scans"}});
}

} // namespace pcl_semantic
