// SPDX-License-Identifier: BSD-3-Clause
#include "support/bad_case.h"
#include "support/same_image.h"
#include "support/thrown_message.h"
#include "support/tiny_street.h"

#include <pcl_semantic/files/trajectory_file.h>
#include <pcl_semantic/images/image_file.h>

#include <opencv2/core.hpp>

namespace pcl_semantic {

namespace fs = std::filesystem;

namespace {

// Maps of the tiny street, with and without CRF, as folder and as archive.
class Maps {
public:
  Maps()
  {
    const std::string street = tinyStreet() + " --labels " + tinyStreet() + "/labels";
    EXPECT_EQ(runTool("map " + street + " --output " + path("map") + " --archive " +
                      path("map.archive"))
                  .code,
              0);
    EXPECT_EQ(runTool("map " + street + " --crf none --output " + path("none")).code,
              0);
  }

  std::string
  path(const std::string& name) const
  {
    return folder_.path(name);
  }

  /** \brief The picture that render makes. */
  cv::Mat
  render(const std::string& arguments) const
  {
    const ToolResult result =
        runTool("render " + replaceAll(arguments, "MAPS/", folder_.path() + "/") + " " +
                path("picture.png") + " --size 320x200");
    EXPECT_EQ(result.code, 0) << result.text;
    EXPECT_EQ(result.text, "picture: " + path("picture.png") + "\n");
    return readPng(path("picture.png"), ImageKind::grey_or_colour);
  }

private:
  TemporaryFolder folder_;
};

BadCase::Damage
cloud(const std::string& fields, const std::string& points, int count)
{
  return [=](const std::string& street) {
    const bool has_label = fields == "x y z label";
    std::ofstream(street + "/a.pcd")
        << "VERSION 0.7\nFIELDS " << fields
        << (has_label ? "\nSIZE 4 4 4 4\nTYPE F F F U\nCOUNT 1 1 1 1\nWIDTH "
                      : "\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH ")
        << count << "\nHEIGHT 1\nPOINTS " << count << "\nDATA ascii\n"
        << points;
  };
}

BadCase::Damage
summary(const std::string& text)
{
  return [=](const std::string& street) {
    std::ofstream(street + "/summary.json") << text;
  };
}

} // namespace

TEST(RenderTool, DrawsFoldersCloudsAndArchivesAlike)
{
  const Maps maps;
  const cv::Mat folder = maps.render("MAPS/map");
  EXPECT_EQ(folder.cols, 320);
  EXPECT_GT(folder.rows, 200);
  const std::string path = " --trajectory MAPS/map/trajectory.txt";
  EXPECT_TRUE(isSameImage(folder, maps.render("MAPS/map.archive" + path)));
  // Its grid is found, not read: the same cubes to a rounding.
  const cv::Mat cloud = maps.render("MAPS/map/map.pcd" + path);
  ASSERT_EQ(cloud.size(), folder.size());
  cv::Mat difference;
  cv::absdiff(cloud, folder, difference);
  EXPECT_LT(cv::mean(difference)[0], 1.0);
  EXPECT_FALSE(
      isSameImage(folder, maps.render("MAPS/map.archive"))); // without its path
  EXPECT_TRUE(isSameImage(folder, maps.render("MAPS/map --threads 3")));
}

TEST(RenderTool, DrawsEveryViewAndColour)
{
  const Maps maps;
  std::vector<cv::Mat> pictures;
  for (const char* const options :
       {"", " --view above", " --view camera --frame 1", " --colour rgb",
        " --colour entropy", " --compare MAPS/none", " --from 5,3,2 --look-at 20,0,0"})
    pictures.push_back(maps.render(std::string("MAPS/map") + options));
  for (std::size_t i = 0; i < pictures.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      EXPECT_FALSE(isSameImage(pictures[i], pictures[j])) << i << " and " << j;
  // Nothing changes against itself: all grey but the path, on both sides of the camera.
  const cv::Mat same = maps.render("MAPS/map --compare MAPS/map --view camera");
  int coloured = 0;
  for (int v = 0; v < 180; ++v)
    for (int u = 0; u < same.cols; ++u) {
      const cv::Vec3b& pixel = same.at<cv::Vec3b>(v, u);
      coloured += std::abs(pixel[0] - pixel[2]) > 24;
    }
  EXPECT_EQ(coloured, 0);
}

TEST(BadUsage, RenderTool)
{
  const std::string one = "0.05 0.05 0.05 1\n0.15 0.05 0.05 2\n";
  const auto labelled = cloud("x y z label", one, 2);
  const std::string draw = "render STREET/a.pcd OUT.png";
  const std::vector<BadCase> cases = {
      {"nothing", 2, "MAP or OUT.png is missing", "render"},
      {"no output", 2, "MAP or OUT.png is missing", "render STREET/a.pcd"},
      {"no png", 2, "ends in .png", "render STREET/a.pcd OUT.jpg"},
      {"no map", 3, "none.pcd: cannot be read", "render STREET/none.pcd OUT.png"},
      {"no summary", 3, "summary.json: cannot be read", "render STREET OUT.png"},
      {"no such summary", 3, "summary.json: is no summary", "render STREET OUT.png",
       summary("{\"finished\": true}")},
      {"unfinished", 3, "summary.json: the map is not finished",
       "render STREET OUT.png", summary("{\"finished\": false}")},
      {"no archive", 3, "calib.txt", "render STREET/calib.txt OUT.png"},
      {"archive and voxels", 2, "--voxel-size is for clouds",
       "render STREET/calib.txt OUT.png --voxel-size 1"},
      {"empty", 3, "a.pcd: has no point: there is nothing to draw", draw,
       cloud("x y z label", "", 0)},
      {"all NaN", 3, "a.pcd: has no point", draw,
       cloud("x y z label", "nan 0 0 1\n", 1)},
      {"no labels", 3, "a.pcd: has no labels", draw,
       cloud("x y z", "0 0 0\n0.1 0 0\n", 2)},
      {"one point", 3, "--voxel-size", draw, cloud("x y z label", "0 0 0 1\n", 1)},
      {"no grid", 3, "a.pcd: points are not voxel centres", draw,
       cloud("x y z label", "0 0 0 1\n0.1 0 0 1\n0.25 0 0 1\n", 3)},
      {"too far", 3, "too far for voxels of", draw + " --voxel-size 1e-11", labelled},
      {"voxels < 0", 2, "--voxel-size is less than 0", draw + " --voxel-size -1"},
      {"beyond the set", 2, "label 12 is beyond the 11 classes", draw,
       cloud("x y z label", "0 0 0 1\n0.1 0 0 12\n", 2)},
      {"no colour", 2, "no colour", draw + " --colour rgb", labelled},
      {"no entropy", 2, "no distributions", draw + " --colour entropy", labelled},
      {"colour", 2, "--colour is 'clique', expected class, rgb or entropy (changes:",
       draw + " --colour clique"},
      {"small", 2, "--small was removed: any image program", draw + " --small"},
      {"field", 2, "--field-of-view was removed: it is 60 degrees",
       draw + " --field-of-view=90"},
      {"view", 2, "--view is 'below', expected angle", draw + " --view below"},
      {"class and compare", 2, "--colour has no effect with --compare",
       draw + " --colour class --compare STREET/a.pcd"},
      {"from alone", 2, "--from and --look-at belong together", draw + " --from 1,2,3"},
      {"from two", 2, "--from has 2 numbers, expected 3",
       draw + " --from 1,2 --look-at 1,2,3", labelled},
      {"from words", 2, "--from", draw + " --from a,b,c --look-at 1,2,3", labelled},
      {"from itself", 2, "the position to look from is the one to look at",
       draw + " --from 1,2,3 --look-at 1,2,3", labelled},
      {"inside", 2, "the camera is inside a voxel",
       draw + " --from 0.04,0.04,0.04 --look-at 1,0,0", labelled},
      {"no pose", 2, "none for --frame 0", draw + " --view camera", labelled},
      {"size 0", 2, "--size is 0x0", draw + " --size 0x0"},
      {"size one", 2, "--size is 500, expected WIDTHxHEIGHT", draw + " --size 500"},
      {"size huge", 2, "--size is 99999x9", draw + " --size 99999x9"},
      {"threads", 2, "threads is -1", draw + " --threads -1"},
      {"trajectory", 3, "calib.txt", draw + " --trajectory STREET/calib.txt", labelled},
      {"below a file", 5, "calib.txt", "render STREET/a.pcd STREET/calib.txt/b.png",
       labelled},
      {"label set", 3, "none.yaml", draw + " --label-set none.yaml", labelled},
  };
  for (const BadCase& bad : cases)
    expectFails(bad);
}

} // namespace pcl_semantic
