// SPDX-License-Identifier: BSD-3-Clause

// pcl_semantic_cliques, what pcl_semantic_crf makes of its field, and cliques of
// pcl_semantic_map.

#include "files/pcd_file.h"
#include "support/ascii_cloud.h"
#include "support/bad_case.h"
#include "support/clique_lists.h"
#include "support/thrown_message.h"
#include "support/tiny_street.h"

#include <pcl_semantic/cliques/cube_cliques.h>
#include <pcl_semantic/cliques/supervoxel_cliques.h>
#include <pcl_semantic/core/voxel_index.h>
#include <pcl_semantic/files/cloud_file.h>
#include <pcl_semantic/files/trajectory_file.h>
#include <pcl_semantic/odometry/pose_source.h>
#include <pcl_semantic/superpixels/superpixel_cliques.h>

#include <gtest/gtest.h>
#include <pcl/common/io.h>

#include <iomanip>
#include <set>

namespace pcl_semantic {

namespace {

Cliques
cliquesIn(const std::string& path)
{
  return listsOf(readLabelledCloud(path).cliques);
}

CliqueGenerator::Cloud
pointsIn(const std::string& path)
{
  CliqueGenerator::Cloud cloud;
  LabelledCloud read = readLabelledCloud(path);
  moveToVoxelCentres(read);
  pcl::copyPointCloud(*read.cloud, cloud);
  return cloud;
}

// A map of one frame of the tiny street, and the frame's cloud; made once.
class CliquesTool : public testing::Test {
protected:
  static void
  SetUpTestSuite()
  {
    folder_ = std::make_unique<TemporaryFolder>();
    succeed(mapOf(tinyStreet()) + " --frames 0:2 --crf none --output " + path("map"));
    succeed("stereo " + tinyStreet() + "/image_2/000001.png " + tinyStreet() +
            "/image_3/000001.png " + tinyStreet() + "/calib.txt " + path("frame.pcd"));
  }

  static std::string
  path(const std::string& name)
  {
    return folder_->path(name);
  }

  static std::string
  map()
  {
    return path("map/map.pcd");
  }

  // The command for the superpixels of the frame at its pose.
  static std::string
  ofFrame()
  {
    return "cliques " + map() + " " + path("out.pcd") +
           " --method superpixel:40 --frame " + path("frame.pcd");
  }

  static Eigen::Isometry3d
  pose()
  {
    return worldFromFirstCamera() * readKittiTrajectory(path("map/trajectory.txt"))[1];
  }

  static Cliques
  superpixels(const Eigen::Isometry3d& T_world_camera)
  {
    const CliqueGenerator::Cloud points = pointsIn(map());
    std::vector<VoxelIndex> voxels;
    for (const pcl::PointXYZRGB& point : points)
      voxels.push_back(voxelOf(quantize(point.getVector3fMap().cast<double>(), 0.1)));
    SuperpixelParameters parameters;
    parameters.slic.superpixels = 40;
    SuperpixelCliques generator(parameters);
    generator.setVoxels(voxels, 0.1);
    generator.setFrame(
        std::make_shared<CliqueGenerator::Cloud>(pointsIn(path("frame.pcd"))),
        T_world_camera);
    return listsOf(generator.generate(points));
  }

  static inline std::unique_ptr<TemporaryFolder> folder_;
};

} // namespace

TEST_F(CliquesTool, WritesWhatTheGeneratorsSayAndKeepsEverythingElse)
{
  const std::string out = path("out.pcd");
  const CliqueGenerator::Cloud points = pointsIn(map());
  const Cliques cubes = listsOf(CubeCliques(0.7).generate(points));
  SupervoxelParameters parameters;
  parameters.seed_resolution = 0.5;
  const Cliques supervoxels = listsOf(SupervoxelCliques(parameters).generate(points));
  for (const auto& [method, expected] :
       {std::pair<std::string, Cliques>("cubes:0.7", cubes),
        {"supervoxel:0.5", supervoxels}}) {
    const std::string text =
        succeed("cliques " + map() + " " + out + " --method " + method);
    EXPECT_TRUE(holds(text, "cliques: " + std::to_string(expected.size()) + "\n"));
    EXPECT_TRUE(cliquesIn(out) == expected) << method;
    PcdTable table = readPcd(out);
    table.removeColumns("clique");
    writeCloudTable(out, table);
    EXPECT_EQ(readPcd(out).data, readPcd(map()).data);
  }
  EXPECT_TRUE(cliquesIn(map()).empty());
}

TEST_F(CliquesTool, SuperpixelsOfAFrameAtItsPose)
{
  const std::string tool = ofFrame();
  const Cliques expected = superpixels(pose());
  EXPECT_GT(expected.size(), 15u);
  succeed(tool + " --pose " + path("map/trajectory.txt") + ":1");
  EXPECT_TRUE(cliquesIn(path("out.pcd")) == expected);

  const Eigen::Quaterniond turn(pose().linear());
  std::ostringstream numbers;
  numbers << std::setprecision(17) << " --pose '" << pose().translation().transpose()
          << " " << turn.coeffs().transpose() << "'";
  succeed(tool + numbers.str());
  EXPECT_TRUE(cliquesIn(path("out.pcd")) == expected);

  PcdTable frame = readPcd(path("frame.pcd")); // its VIEWPOINT
  const Eigen::Vector3d place = pose().translation();
  frame.viewpoint = {place.x(), place.y(), place.z(), turn.w(),
                     turn.x(),  turn.y(),  turn.z()};
  writeCloudTable(path("viewed.pcd"), frame);
  const std::string viewed = "cliques " + map() + " " + path("out.pcd") +
                             " --method superpixel:40 --frame " + path("viewed.pcd");
  succeed(viewed);
  EXPECT_FALSE(cliquesIn(path("out.pcd")).empty());

  const Eigen::Vector3d origin(-3.0, 1.0, 0.5); // the map's, it says
  Eigen::Isometry3d moved = pose();
  moved.pretranslate(-origin);
  succeed(tool + " --pose " + path("map/trajectory.txt") + ":1 --map-origin -3,1,0.5");
  EXPECT_TRUE(cliquesIn(path("out.pcd")) == superpixels(moved));
  succeed(viewed + " --map-origin -3,1,0.5");
  EXPECT_TRUE(cliquesIn(path("out.pcd")) == superpixels(moved));
}

TEST_F(CliquesTool, ColoursTellCliquesApart)
{
  succeed(ofFrame() + " --pose " + path("map/trajectory.txt") + ":1 --coloured " +
          path("coloured.pcd"));
  const CliqueGenerator::Cloud coloured = pointsIn(path("coloured.pcd"));
  const Cliques cliques = cliquesIn(path("out.pcd"));
  std::set<std::uint32_t> colours;
  std::size_t members = 0, dark = 0;
  for (const std::vector<int>& clique : cliques) {
    std::set<std::uint32_t> of_clique;
    for (const int i : clique)
      of_clique.insert(coloured[std::size_t(i)].rgba & 0xFFFFFF);
    EXPECT_EQ(of_clique.size(), 1u);
    colours.insert(of_clique.begin(), of_clique.end());
    members += clique.size();
  }
  EXPECT_EQ(colours.size(), cliques.size());
  for (const pcl::PointXYZRGB& point : coloured)
    dark += (point.rgba & 0xFFFFFF) == 0x282828;
  EXPECT_EQ(dark, coloured.size() - members);
  EXPECT_GT(dark, 0u);
}

TEST_F(CliquesTool, MapsTakeEveryKindOfCliques)
{
  const std::string tool =
      mapOf(tinyStreet()) + " --crf hierarchical --output " + path("grouped");
  std::set<std::vector<std::uint8_t>> maps;
  std::ofstream(path("keep.yaml")) << "superpixel_keep: true\n";
  const std::vector<std::string> kinds = {
      " --cliques cubes", " --cliques superpixel:60",
      " --cliques superpixel:60 --config " + path("keep.yaml"),
      " --cliques superpixel:60 --superpixel-depth-jump 0",
      " --cliques supervoxel:0.5"};
  for (const std::string& kind : kinds) {
    succeed(tool + kind);
    maps.insert(readPcd(path("grouped/map.pcd")).data);
  }
  EXPECT_EQ(maps.size(), kinds.size()); // no two are the same
  // finish() groups voxels that were not refined yet, by the last frame.
  const auto labelsWith = [&](const std::string& options) {
    succeed(tool + options);
    return readLabelledCloud(path("grouped/map.pcd")).cloud;
  };
  const auto often = labelsWith(" --cliques superpixel:60");
  const auto seldom = labelsWith(" --cliques superpixel:60 --crf-every 4");
  ASSERT_EQ(often->size(), seldom->size());
  std::size_t same = 0;
  for (std::size_t i = 0; i < often->size(); ++i)
    same += (*often)[i].label == (*seldom)[i].label;
  EXPECT_GT(double(same) / double(often->size()), 0.99);
}

TEST_F(CliquesTool, ARunThatWasInterruptedEndsWithTheSameCliques)
{
  for (const std::string kind : {"superpixel:60", "supervoxel:0.5"}) {
    const std::string tool =
        mapOf(tinyStreet()) + " --crf hierarchical --cliques " + kind;
    succeed(tool + " --output " + path("once"));
    const std::string archive = path(kind.substr(0, 6) + ".sqlite");
    const std::string kept =
        tool + " --archive-every 1 --resume --archive " + archive + " --output ";
    succeed(kept + path("again"));
    EXPECT_EQ(readPcd(path("again/map.pcd")).data, readPcd(path("once/map.pcd")).data);
  }
}

TEST(CliquesToolBadInput, IsRefused)
{
  const auto cloud = [](const std::string& fields, int width, int height) {
    const std::string colour = fields.size() > 5 ? " 255" : "";
    std::string rows;
    for (int i = 0; i < width * height; ++i)
      rows += std::to_string(0.1 * i) + " 0 " + (i == 3 ? "1e12" : "5") + colour + "\n";
    return [=](const std::string& street) {
      std::ofstream(street + "/in.pcd") << asciiCloud(fields, rows, height);
    };
  };
  const std::string tool = "cliques STREET/in.pcd OUT.pcd ";
  const std::string frame = tool + "--method superpixel --frame STREET/in.pcd ";
  const auto image = cloud("x y z rgba", 1, 2);
  expectAllFail({
      {2, "expected IN.pcd OUT.pcd", "cliques a.pcd"},
      {2, "--method is missing", "cliques a.pcd OUT.pcd"},
      {2, "'best', expected planes", tool + "--method best"},
      {2, "seed resolution is 0.01", tool + "--method supervoxel:0.01"},
      {2, "superpixel:N with N 1", tool + "--method superpixel:0 --frame x"},
      {2, "--supervoxel-colour-weight: was removed, it had no effect",
       tool + "--method supervoxel --supervoxel-colour-weight=1"},
      {2, "passing distance is -1",
       tool + "--method superpixel --frame x --superpixel-depth-jump -1"},
      {2, "needs --frame", tool + "--method superpixel"},
      {2, "--frame has no effect with --method cubes",
       tool + "--method cubes --frame STREET/in.pcd"},
      {2, "--calibration is for",
       frame + "--pose '0 0 0 0 0 0 1' --calibration STREET/calib.txt", image},
      {3, "none.pcd", "cliques STREET/none.pcd OUT.pcd --method cubes"},
      {3, "point 3 lies at", tool + "--method cubes:0.001", cloud("x y z", 4, 2)},
      {3, "rgb or rgba", tool + "--method slic", cloud("x y z", 2, 2)},
      {3, "rgb or rgba", frame, cloud("x y z", 2, 2)},
      {3, "organized", frame, cloud("x y z rgba", 2, 1)},
      {2, "cliques: --pose has 6 numbers", frame + "--pose '0 0 0 0 0 1'",
       cloud("x y z rgba", 1, 2)},
      {2, "cliques: --pose", frame + "--pose here", image},
      {2, "quaternion of length 2", frame + "--pose '0 0 0 0 0 0 2'", image},
      {3, "has no pose 99", frame + "--pose STREET/poses.txt:99", image},
      {3, "--pose", frame + "--pose STREET/poses.txt:last", image},
      {3, "shows no voxel", frame + "--pose '0 0 1000 0 0 0 1'", image},
      {2, "voxel size is 0", frame + "--voxel-size 0", image},
      {2, "in.pcd: is given as an output",
       "cliques STREET/in.pcd STREET/in.pcd --method cubes", image},
      {2, "is given as an output", tool + "--method cubes --coloured OUT.pcd", image},
      {2, ".pcd", tool + "--method cubes --coloured OUT.png", image},
      {2, "cliques are 'superpixel', expected",
       "crf STREET/in.pcd OUT.pcd --crf pn-potts --cliques superpixel", image},
      {2, "--archive and superpixel_keep exclude",
       "--labels STREET/labels --config " PCL_SEMANTIC_SOURCE_DIR
       "/data/presets/zhao16.yaml --archive TEMP/map.sqlite"},
  });
}

} // namespace pcl_semantic
