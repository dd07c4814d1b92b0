// SPDX-License-Identifier: BSD-3-Clause
#include "support/ascii_cloud.h"
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
    const std::string map = mapOf(tinyStreet()) + " --output ";
    succeed(map + path("map") + " --archive " + path("map.archive"));
    succeed(map + path("none") + " --crf none");
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
    EXPECT_EQ(succeed("render " + replaceAll(arguments, "MAPS", path("")) + " " +
                      path("picture.png") + " --size 320x200"),
              "picture: " + path("picture.png") + "\n");
    return readPng(path("picture.png"), ImageKind::grey_or_colour);
  }

private:
  TemporaryFolder folder_;
};

BadCase::Damage
cloud(const std::string& fields, const std::string& points)
{
  return [=](const std::string& street) {
    std::ofstream(street + "/a.pcd") << asciiCloud(fields, points);
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

TEST(RenderTool, DrawsMapsOfEveryKindAlikeAndEveryViewAndColour)
{
  const Maps maps;
  const cv::Mat folder = maps.render("MAPS/map");
  EXPECT_EQ(folder.cols, 320);
  EXPECT_GT(folder.rows, 200);
  const std::string path = " --trajectory MAPS/map/trajectory.txt";
  EXPECT_TRUE(isSameImage(folder, maps.render("MAPS/map.archive" + path)));
  // Its grid is found, not read: the same cubes to a rounding.
  const cv::Mat cloud =
      maps.render("MAPS/map/map.pcd --objects MAPS/map/objects.json" + path);
  ASSERT_EQ(cloud.size(), folder.size());
  cv::Mat difference;
  cv::absdiff(cloud, folder, difference);
  EXPECT_LT(cv::mean(difference)[0], 1.0);
  EXPECT_FALSE(
      isSameImage(folder, maps.render("MAPS/map.archive"))); // without its path
  EXPECT_TRUE(isSameImage(folder, maps.render("MAPS/map --threads 3")));

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

TEST(RenderTool, DrawsTheBoxesOfAMapFolder)
{
  const Maps maps;
  const cv::Mat plain = maps.render("MAPS/map --objects none"),
                changes = maps.render("MAPS/map --compare MAPS/none");
  EXPECT_FALSE(isSameImage(maps.render("MAPS/map"), plain));
  succeed("things " + maps.path("map/map.pcd") + " " + maps.path("things.pcd") +
          " --objects " + maps.path("map/objects.json"));
  const cv::Mat boxes = maps.render("MAPS/map");
  EXPECT_FALSE(isSameImage(boxes, plain));
  EXPECT_TRUE(
      isSameImage(maps.render("MAPS/map/map.pcd --trajectory MAPS/map/trajectory.txt "
                              "--objects MAPS/map/objects.json"),
                  boxes));
  EXPECT_TRUE(isSameImage(maps.render("MAPS/map --compare MAPS/none"), changes));
}

TEST(RenderTool, DrawsTheBoxesOfAnArchive)
{
  const Maps maps;
  EXPECT_FALSE(isSameImage(maps.render("MAPS/map.archive"),
                           maps.render("MAPS/map.archive --objects none")));
}

TEST(BadUsage, RenderTool)
{
  const std::string one = "0.05 0.05 0.05 1\n0.15 0.05 0.05 2\n";
  const auto labelled = cloud("x y z label", one);
  const std::string draw = "render STREET/a.pcd OUT.png";
  expectAllFail({
      {2, "MAP or OUT.png is missing", "render"},
      {2, "MAP or OUT.png is missing", "render STREET/a.pcd"},
      {2, "ends in .png", "render STREET/a.pcd OUT.jpg"},
      {3, "none.pcd: cannot be read", "render STREET/none.pcd OUT.png"},
      {3, "summary.json: cannot be read", "render STREET OUT.png"},
      {3, "summary.json: is no summary", "render STREET OUT.png",
       summary("{\"finished\": true}")},
      {3, "summary.json: the map is not finished", "render STREET OUT.png",
       summary("{\"finished\": false}")},
      {3, "calib.txt", "render STREET/calib.txt OUT.png"},
      {2, "--voxel-size is for clouds",
       "render STREET/calib.txt OUT.png --voxel-size 1"},
      {3, "a.pcd: has no point: there is nothing to draw", draw,
       cloud("x y z label", "")},
      {3, "a.pcd: has no point", draw, cloud("x y z label", "nan 0 0 1\n")},
      {3, "a.pcd: has no labels", draw, cloud("x y z", "0 0 0\n0.1 0 0\n")},
      {3, "--voxel-size", draw, cloud("x y z label", "0 0 0 1\n")},
      {3, "a.pcd: points are not voxel centres", draw,
       cloud("x y z label", "0 0 0 1\n0.1 0 0 1\n0.25 0 0 1\n")},
      {3, "too far for voxels of", draw + " --voxel-size 1e-11", labelled},
      {2, "--voxel-size is less than 0", draw + " --voxel-size -1"},
      {2, "label 12 is beyond the 11 classes", draw,
       cloud("x y z label", "0 0 0 1\n0.1 0 0 12\n")},
      {2, "no colour", draw + " --colour rgb", labelled},
      {2, "no distributions", draw + " --colour entropy", labelled},
      {2, "--colour is 'clique', expected class, rgb or entropy (changes:",
       draw + " --colour clique"},
      {2, "--small was removed: any image program", draw + " --small"},
      {2, "--field-of-view was removed: it is 60 degrees",
       draw + " --field-of-view=90"},
      {2, "--view is 'below', expected angle", draw + " --view below"},
      {2, "--colour has no effect with --compare",
       draw + " --colour class --compare STREET/a.pcd"},
      {2, "--from and --look-at belong together", draw + " --from 1,2,3"},
      {2, "--from has 2 numbers, expected 3", draw + " --from 1,2 --look-at 1,2,3",
       labelled},
      {2, "--from", draw + " --from a,b,c --look-at 1,2,3", labelled},
      {2, "the position to look from is the one to look at",
       draw + " --from 1,2,3 --look-at 1,2,3", labelled},
      {2, "the camera is inside a voxel",
       draw + " --from 0.04,0.04,0.04 --look-at 1,0,0", labelled},
      {2, "none for --frame 0", draw + " --view camera", labelled},
      {2, "--size is 0x0", draw + " --size 0x0"},
      {2, "--size is 500, expected WIDTHxHEIGHT", draw + " --size 500"},
      {2, "--size is 99999x9", draw + " --size 99999x9"},
      {2, "threads is -1", draw + " --threads -1"},
      {3, "calib.txt", draw + " --trajectory STREET/calib.txt", labelled},
      {5, "calib.txt", "render STREET/a.pcd STREET/calib.txt/b.png", labelled},
      {3, "none.yaml", draw + " --label-set none.yaml", labelled},
      {3, "calib.txt: byte", draw + " --objects STREET/calib.txt", labelled},
  });
}

} // namespace pcl_semantic
