// SPDX-License-Identifier: BSD-3-Clause
#include "files/pcd_file.h"
#include "support/ascii_cloud.h"
#include "support/bad_case.h"
#include "support/mapped_street.h"
#include "support/run_tool.h"
#include "support/thrown_message.h"
#include "synthesize/street.h"

#include <pcl_semantic/dataset/lidar_scan.h>
#include <pcl_semantic/evaluation/voxel_lookup.h>
#include <pcl_semantic/files/cloud_file.h>
#include <pcl_semantic/files/label_set_file.h>
#include <pcl_semantic/files/trajectory_file.h>
#include <pcl_semantic/map/semantic_voxel_map.h>
#include <pcl_semantic/odometry/pose_source.h>

#include <pcl/common/io.h>

namespace pcl_semantic {

namespace fs = std::filesystem;

namespace {

// Clouds of the street by pcl_semantic_stereo and pcl_semantic_label.
void
labelClouds(const std::string& street, const TemporaryFolder& folder)
{
  succeed("stereo " + street + "/image_2 " + street + "/image_3 " + street +
          "/calib.txt " + folder.path("clouds") + " --max-depth 0 --max-deviation 0");
  succeed("label --clouds " + folder.path("clouds") + " --labels " + street +
          "/labels --output " + folder.path("labelled"));
}

std::string
mapOfClouds(const TemporaryFolder& folder)
{
  return "map --clouds " + folder.path("labelled") + " --poses " + tinyStreet() +
         "/poses.txt --calibration " + tinyStreet() + "/calib.txt --times " +
         tinyStreet() + "/times.txt --output ";
}

// A laser of a few rings in the frame x forward, y left, z up.
LabelledCloud
scanOf(const SyntheticScene& street, const Eigen::Isometry3d& T_world_sensor)
{
  LabelledCloud scan;
  for (int ring = 0; ring < 16; ++ring)
    for (int step = 0; step < 180; ++step) {
      const double up = 0.02 * ring - 0.25, turn = M_PI / 90.0 * step;
      const Eigen::Vector3d ray(std::cos(turn) * std::cos(up),
                                std::sin(turn) * std::cos(up), std::sin(up));
      const SyntheticHit hit =
          street.intersect(T_world_sensor.translation(), T_world_sensor.linear() * ray);
      if (hit.label == synthetic_sky)
        continue; // nothing comes back
      pcl::PointXYZRGBL point;
      point.getVector3fMap() = (ray * hit.distance).cast<float>();
      point.label = hit.label;
      scan.cloud->push_back(point);
    }
  return scan;
}

void
expectVoxels(const std::string& path, const VoxelCloud& expected)
{
  const LabelledCloud read = readLabelledCloud(path);
  ASSERT_EQ(read.cloud->size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ((*read.cloud)[i].getVector3fMap(), (*expected.cloud)[i].getVector3fMap());
    EXPECT_EQ((*read.cloud)[i].label, (*expected.cloud)[i].label);
  }
  EXPECT_TRUE(read.distributions.matrix() == expected.refined.matrix());
}

// Four scans, clouds/N.pcd, and the scanner's own poses.
class Scans : public testing::Test {
protected:
  Scans()
  {
    const SyntheticScene street(1, 4);
    fs::create_directories(folder.path("clouds"));
    for (int frame = 0; frame < 4; ++frame) {
      T_world_sensor.push_back(street.pose(frame) * worldFromFirstCamera().inverse());
      scans.push_back(scanOf(street, T_world_sensor.back()));
    }
    writeClouds();
    writeKittiTrajectory(folder.path("poses.txt"), T_world_sensor);
  }

  // The voxels that the map has without programs and files.
  VoxelCloud
  expected() const
  {
    SemanticVoxelMap map(readLabelSet(kitti11), SemanticVoxelMap::Parameters());
    for (std::size_t i = 0; i < scans.size(); ++i) {
      const auto& cloud = *scans[i].cloud;
      LabelDistributions labels(map.labelSet().size(), Eigen::Index(cloud.size()));
      for (std::size_t j = 0; j < cloud.size(); ++j)
        labels.setLabel(Eigen::Index(j), Label(cloud[j].label), 0.8f);
      pcl::PointCloud<pcl::PointXYZ> places;
      pcl::copyPointCloud(cloud, places);
      map.integrate(places, T_world_sensor[i], labels);
    }
    return map.occupiedEverywhere();
  }

  std::string
  cloud(std::size_t frame) const
  {
    return folder.path("clouds/" + std::to_string(frame) + ".pcd");
  }

  void
  writeClouds() const
  {
    for (std::size_t frame = 0; frame < 4; ++frame)
      writeLabelledCloud(cloud(frame), scans[frame]);
  }

  // The command that maps them with other poses, and with their own.
  std::string
  mapWith(const std::string& options) const
  {
    return "map --clouds " + folder.path("clouds") + " --crf none --output " +
           folder.path("map") + " --poses " + options;
  }

  std::string
  map(const std::string& options = "") const
  {
    return mapWith(folder.path("poses.txt")) + options;
  }

  // Maps them and expects the map of the library.
  void
  expectMapped() const
  {
    succeed(map());
    expectVoxels(folder.path("map/map.pcd"), expected());
  }

  TemporaryFolder folder;
  std::vector<LabelledCloud> scans;
  Trajectory T_world_sensor;
};

} // namespace

TEST(CloudTools, APipelineOfToolsMakesTheSameMap)
{
  const TemporaryFolder folder;
  labelClouds(tinyStreet(), folder);
  succeed(mapOfClouds(folder) + folder.path("map"));
  mapStreet(tinyStreet(), folder.path("direct"), "");
  expectSameMaps(folder.path("map"), folder.path("direct"));
  // And with the CRF as a tool of its own.
  succeed(mapOfClouds(folder) + folder.path("raw") + " --crf none");
  succeed("crf " + folder.path("raw/map.pcd") + " " + folder.path("refined.pcd") +
          " --crf-sensor stereo --crf-temperature 3" + of_kitti11);
  const LabelledCloud tools = readLabelledCloud(folder.path("refined.pcd"));
  const LabelledCloud direct = readLabelledCloud(folder.path("direct/map.pcd"));
  ASSERT_EQ(tools.cloud->size(), direct.cloud->size());
  // Files round places to single precision, which moves points within the lattice.
  EXPECT_LT((tools.distributions.matrix() - direct.distributions.matrix())
                .cwiseAbs()
                .maxCoeff(),
            1e-2f);
  std::size_t others = 0;
  for (std::size_t i = 0; i < direct.cloud->size(); ++i)
    others += (*tools.cloud)[i].label != (*direct.cloud)[i].label;
  EXPECT_LT(others, direct.cloud->size() / 1000);
}

TEST(CloudTools, OtherFieldsOfALabelledCloudStay)
{
  const TemporaryFolder folder;
  folder.write("cloud.pcd",
               asciiCloud("x:F8 y z rgb:F4 ring:U2",
                          "1 2 3 0 7\n1 2 4 0 8\n1 3 3 0 9\nnan nan nan 0 10\n", 2));
  std::vector<float> stored(44, 0.0f);
  stored[5] = stored[11] = stored[30] = stored[43] = 1.0f;
  folder.write("labels.bin",
               std::string(reinterpret_cast<const char*>(stored.data()), 44 * 4));
  succeed("label --clouds " + folder.path("cloud.pcd") + " --labels " +
          folder.path("labels.bin") + " --output " + folder.path("out.pcd"));
  const LabelledCloud out = readLabelledCloud(folder.path("out.pcd"));
  EXPECT_EQ(out.cloud->height, 2u);
  const std::uint32_t labels[] = {6, 1, 9, 11};
  const PcdColumn ring(out.table, out.table.find("ring"));
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ((*out.cloud)[i].label, labels[i]);
    EXPECT_EQ(ring(i), double(7 + i));
  }
  EXPECT_EQ(sizeOfField(out.table.fields[0]), 8u);
}

TEST_F(Scans, OfAnySensorBecomeTheMapOfTheLibrary)
{
  expectMapped();
  EXPECT_EQ(filesIn(folder.path("map")), filesOfMap({}));
  // As the trajectory of a camera that looks along x.
  const Trajectory written = readKittiTrajectory(folder.path("map/trajectory.txt"));
  ASSERT_EQ(written.size(), 4u);
  EXPECT_TRUE((worldFromFirstCamera() * written[3])
                  .isApprox(T_world_sensor[3] * worldFromFirstCamera(), 1e-9));
  succeed("render " + folder.path("map") + " " + folder.path("map.png"));
}

// As drivers write what did not come back, and a scan that nothing came back of.
TEST_F(Scans, NoReturnsAndEmptyScansChangeNothing)
{
  for (LabelledCloud& scan : scans)
    for (int i = 0; i < 300; ++i) {
      pcl::PointXYZRGBL point;
      point.getVector3fMap().setZero();
      point.label = 1;
      scan.cloud->push_back(point);
    }
  writeClouds();
  for (LabelledCloud& scan : scans) // expected clouds
    scan.cloud->resize(scan.cloud->size() - 300);
  expectMapped();
  EXPECT_TRUE(
      holds(bytesOf(folder.path("map/summary.json")), "\"without_depth\": 1200"));

  scans[2].cloud->clear();
  LabelledCloud nothing;
  nothing.cloud->width = 0;
  writeLabelledCloud(cloud(2), nothing);
  fs::remove_all(folder.path("map"));
  expectMapped();
}

TEST_F(Scans, OfOtherColumnsAreReadAsTheyAreNamed)
{
  const auto write = [&](const std::string& extension) {
    for (std::size_t frame = 0; frame < 4; ++frame) {
      std::vector<float> values;
      std::vector<std::uint32_t> labels;
      const auto& cloud = *scans[frame].cloud;
      for (std::size_t i = 0; i < cloud.size(); ++i) {
        const pcl::PointXYZRGBL& point = cloud[i];
        values.insert(values.end(),
                      {point.x, point.y, point.z, float(i % 200), float(i % 16)});
        labels.push_back(point.label | std::uint32_t(i) << 16);
      }
      const std::string name = folder.path("scans/00000" + std::to_string(frame));
      std::ofstream(name + extension, std::ios::binary)
          .write(reinterpret_cast<const char*>(values.data()),
                 std::streamsize(4 * values.size()));
      std::ofstream(name + ".label", std::ios::binary)
          .write(reinterpret_cast<const char*>(labels.data()),
                 std::streamsize(4 * labels.size()));
    }
  };
  const std::string command = replaceAll(map(), "/clouds", "/scans");
  fs::create_directories(folder.path("scans"));
  write(".bin");
  expectFails(command, 3, "like 5 float32 a point; name them with --scan-columns");
  succeed(command + " --scan-columns x,y,z,intensity,ring");
  expectVoxels(folder.path("map/map.pcd"), expected());
  fs::remove_all(folder.path("scans"));
  fs::create_directories(folder.path("scans"));
  write(".pcd.bin");
  fs::remove_all(folder.path("map"));
  EXPECT_TRUE(holds(succeed(command + " --label-mapping semantic_kitti_to_kitti11"),
                    "kitti11 lacks"));
  fs::remove_all(folder.path("map"));
  succeed(command);
  expectVoxels(folder.path("map/map.pcd"), expected());
  expectFails(map(" --scan-columns 5"), 2, "scan columns are for .bin");
}

TEST_F(Scans, TakeTheLabelsOfTheirMap)
{
  succeed(map(" --also scans,measured"));
  const VoxelCloud voxels = expected();
  const VoxelLookup lookup(voxels);
  for (std::size_t frame = 0; frame < scans.size(); ++frame) {
    const auto read = [&](const std::string& name) {
      return readScanLabels(
          folder.path("map/" + name + "/00000" + std::to_string(frame) + ".label"), 11);
    };
    const auto& cloud = *scans[frame].cloud;
    const std::vector<Label> labels = read("final_scan_labels");
    const std::vector<Label> own = read("network_scan_labels");
    ASSERT_EQ(labels.size(), cloud.size());
    ASSERT_EQ(own.size(), cloud.size());
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const std::int32_t voxel =
          lookup.at(T_world_sensor[frame] * cloud[i].getVector3fMap().cast<double>());
      EXPECT_EQ(labels[i], voxel < 0 ? 0 : (*voxels.cloud)[std::size_t(voxel)].label);
      EXPECT_EQ(own[i], cloud[i].label);
    }
    EXPECT_EQ(read("final_measured_scan_labels"), labels); // there is no CRF
    EXPECT_EQ(read("scan_labels").size(), cloud.size());
  }
  EXPECT_FALSE(fs::exists(folder.path("map/measured_labels"))); // there are no images
}

TEST_F(Scans, TimesAndTumPosesFindEachOther)
{
  std::string rows;
  for (std::size_t i = 0; i < 4; ++i) {
    const std::string time = "15." + std::to_string(25 * i + 10);
    fs::rename(cloud(i), folder.path("clouds/" + time + ".pcd"));
    std::ostringstream row;
    row.precision(17);
    const Eigen::Quaterniond q(T_world_sensor[i].linear());
    row << time << " " << T_world_sensor[i].translation().transpose() << " " << q.x()
        << " " << q.y() << " " << q.z() << " " << q.w() << "\n";
    rows += row.str();
  }
  folder.write("tum.txt", rows);
  succeed(mapWith(folder.path("tum.txt")));
  EXPECT_EQ(readLabelledCloud(folder.path("map/map.pcd")).cloud->size(),
            expected().size());
}

TEST_F(Scans, OfKittisLaserHaveThePosesOfItsCamera)
{
  // Camera 0 a metre above and half a metre behind the scanner.
  Eigen::Isometry3d T_sensor_camera0 = worldFromFirstCamera();
  T_sensor_camera0.translation() << -0.5, 0.0, 1.0;
  Trajectory poses;
  for (const Eigen::Isometry3d& pose : T_world_sensor)
    poses.push_back(worldFromFirstCamera().inverse() * pose * T_sensor_camera0);
  writeKittiTrajectory(folder.path("camera0.txt"), poses);
  std::ostringstream row;
  row << "Tr:";
  const Eigen::Isometry3d T_camera0_sensor = T_sensor_camera0.inverse();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 4; ++j)
      row << " " << T_camera0_sensor(i, j);
  std::string rows;
  for (const std::string& line : linesOf(tinyStreet() + "/calib.txt"))
    if (line.rfind("Tr", 0) != 0)
      rows += line + "\n";
  folder.write("calib.txt", rows + row.str() + "\n");
  succeed(mapWith(folder.path("camera0.txt")) + " --sensor laser --calibration " +
          folder.path("calib.txt"));
  const LabelledCloud read = readLabelledCloud(folder.path("map/map.pcd"));
  EXPECT_NEAR(double(read.cloud->size()), double(expected().size()),
              0.01 * double(expected().size()));
}

TEST_F(Scans, WithoutLabelsAreAMapWithoutLabels)
{
  for (std::size_t i = 0; i < scans.size(); ++i) {
    PcdTable table = readLabelledCloud(cloud(i)).table;
    table.removeColumns("label");
    writeCloudTable(cloud(i), table);
  }
  const std::string text = succeed(replaceAll(map(), "--crf none", "--crf dense"));
  EXPECT_TRUE(holds(text, "0.pcd: has no field 'label' or 'probability': it gives "
                          "the map no labels\n"));
  EXPECT_FALSE(holds(text, "1.pcd")); // said once
  const LabelledCloud read = readLabelledCloud(folder.path("map/map.pcd"));
  EXPECT_EQ(read.cloud->size(), expected().size());
  for (const pcl::PointXYZRGBL& point : *read.cloud)
    ASSERT_EQ(point.label, kUnlabelled);
}

TEST_F(Scans, InMillimetresAreAnEmptyMapWithAWarning)
{
  for (LabelledCloud& scan : scans)
    for (pcl::PointXYZRGBL& point : *scan.cloud)
      point.getVector3fMap() *= 1000.0f;
  writeClouds();
  EXPECT_TRUE(holds(succeed(map()), "warning: the map is empty"));
}

TEST_F(Scans, OfOwnClassesKeepTheirNames)
{
  std::string classes = "classes:\n";
  for (int label = 1; label <= 11; ++label)
    classes += "  - {name: thing" + std::to_string(label) + ", colour: [" +
               std::to_string(label) + ", 2, 3]}\n";
  folder.write("things.yaml", classes);
  succeed(map(" --label-set " + folder.path("things.yaml")));
  const LabelSet kept = readLabelSet(folder.path("map/label_set.yaml"));
  ASSERT_EQ(kept.size(), 11);
  EXPECT_EQ(kept[3].name, "thing3");
  EXPECT_EQ(kept[7].colour, (std::array<std::uint8_t, 3>{7, 2, 3}));
}

TEST_F(Scans, GoOnWithAnArchive)
{
  const std::string archive = " --archive " + folder.path("map.archive");
  succeed(map(archive));
  const std::string whole = bytesOf(folder.path("map/map.pcd"));
  EXPECT_TRUE(holds(succeed(map(archive + " --resume")), "resumed_after: 4"));
  EXPECT_EQ(bytesOf(folder.path("map/map.pcd")), whole);
}

TEST_F(Scans, AreShownInAWindow)
{
  if (!hasVirtualDisplay() ||
      !fs::exists(PCL_SEMANTIC_BINARY_DIR "/bin/pcl_semantic_view"))
    GTEST_SKIP() << "xvfb or xauth is not installed, or the viewer not built";
  const ToolResult result = runOnDisplay(PCL_SEMANTIC_BINARY_DIR "/bin/pcl_semantic_" +
                                         map(" --view --verbose"));
  EXPECT_EQ(result.code, 0);
  EXPECT_TRUE(holds(result.text, "frame 3, "));
  EXPECT_FALSE(holds(result.text, "the window was closed"));
}

TEST_F(Scans, BadInput)
{
  const std::string all = "map --clouds " + folder.path("clouds") + " --output OUT ";
  const std::string poses = "--poses " + folder.path("poses.txt") + " ";
  expectAllFail({
      {2, "--clouds needs a trajectory: --poses FILE", all},
      {2, "--poses FILE", all + "--poses odometry"},
      {2, "exclude each other", all + poses + "STREET"},
      {2, "hold their labels", all + poses + "--labels STREET/labels"},
      {2, "--sensor is 'lidar'", all + poses + "--sensor lidar"},
      {2, "--sensor camera needs --calibration", all + poses + "--sensor camera"},
      {2, "--calibration is not for --sensor own",
       all + poses + "--sensor own --calibration STREET/calib.txt"},
      {2, "--sensor is for --clouds", "--labels STREET/labels --sensor own"},
      {3, "is no organized cloud", all + poses + "--calibration STREET/calib.txt"},
      {3, "no file matches", "map --clouds TEMP/none --output OUT " + poses},
      {3, "none for frame 3", all + "--poses STREET/poses.txt"},
      {2, "are for frames of a camera", all + poses + "--also depth"},
      {2, "also needs scans", all + poses + "--also measured"},
      {2, "--min-hit-ratio has no effect with --clouds that are not of a camera",
       all + poses + "--min-hit-ratio 0.2"},
      {2, "--output holds the clouds",
       "map --clouds " + folder.path("clouds") + " " + poses + "--output " +
           folder.path("clouds")},
      {2, "expected either --labels or --network",
       "label --clouds " + folder.path("clouds") + " --output OUT"},
      {2, "--format has no effect with --clouds",
       "label --clouds " + folder.path("clouds") +
           " --labels STREET/labels --output OUT --format ids"},
      {3, "expected",
       "label --clouds " + folder.path("clouds") +
           " --labels STREET/labels --output OUT"},
      {2, "--output is one cloud",
       "label --clouds " + folder.path("clouds") +
           " --labels STREET/labels --output TEMP/one.pcd"},
      {2, "",
       "label --clouds " + folder.path("clouds") + " --labels STREET/labels --output " +
           folder.path("clouds")},
  });
  succeed(map());
  expectFails(mapWith(folder.path("map/trajectory.txt")), 2,
              "--poses is the trajectory that --output writes");
  folder.write("clouds/2.pcd", "garbage");
  expectFails({3, "2.pcd", all + poses});
}

} // namespace pcl_semantic
