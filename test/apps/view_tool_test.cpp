// SPDX-License-Identifier: BSD-3-Clause
#include "support/ascii_cloud.h"
#include "support/bad_case.h"
#include "support/mapped_street.h"
#include "support/random_scene.h"
#include "support/run_tool.h"
#include "support/same_image.h"
#include "support/thrown_message.h"
#include "support/tiny_street.h"

#include <pcl_semantic/files/label_set_file.h>
#include <pcl_semantic/pictures/voxel_colours.h>

#include <opencv2/core.hpp>

// Windows and images of their content, on the display of xvfb-run: none is needed.

namespace pcl_semantic {

namespace fs = std::filesystem;

namespace {

const std::string program = PCL_SEMANTIC_BINARY_DIR "/bin/pcl_semantic_";

// Arguments of pcl_semantic_map for the tiny street.
std::string
mapInto(const std::string& output)
{
  return mapOf(tinyStreet()) + " --output " + output;
}

constexpr const char* without_display = "unset DISPLAY;";

// A floor of road, 30 x 30 voxels of 0.1 m, and on it a block of 8 x 8 x 4: a car.
std::string
floorAndBlock()
{
  std::string rows;
  const auto add = [&](int x, int y, int z, int label) {
    rows += cv::format("%.2f %.2f %.2f %d\n", 0.1 * x + 0.05, 0.1 * y + 0.05,
                       0.1 * z + 0.05, label);
  };
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 30; ++x) {
      add(x, y, 0, 3);
      for (int z = 1; x >= 11 && x < 19 && y >= 11 && y < 19 && z < 5; ++z)
        add(x, y, z, 6);
    }
  return asciiCloud("x y z label", rows);
}

// As in the pictures of pcl_semantic_render.
cv::Vec3b
colourOf(const std::string& name)
{
  static const LabelSet label_set = readLabelSet(kitti11);
  VoxelScene scene = emptyScene();
  addVoxel(scene, {0, 0, 0}, label_set.find(name));
  return classColours(scene, label_set).colours.at(0);
}

int
count(const cv::Mat& picture, const cv::Vec3b& colour)
{
  cv::Mat equal;
  cv::inRange(picture, cv::Scalar(colour), cv::Scalar(colour), equal);
  return cv::countNonZero(equal);
}

// Images of the viewer.
class Views {
public:
  Views()
  {
    folder_.write("block.pcd", floorAndBlock());
    folder_.write("objects.json", R"({"objects": [{"id": 4, "label": 6, "points": 256,
      "centre": [1.5, 1.5, 0.3], "box": {"min": [1.15, 1.15, 0.15], "max": [1.85, 1.85,
      0.45]}, "yaw_box": {"centre": [1.5, 1.5, 0.3], "size": [0.7, 0.7, 0.3],
      "yaw": 0}}]})");
  }

  std::string
  path(const std::string& name) const
  {
    return folder_.path(name);
  }

  /** \brief The screenshot with options; MAPS/ is the folder. */
  cv::Mat
  operator()(const std::string& arguments) const
  {
    const std::string picture = path("picture.png");
    EXPECT_EQ(succeed(commandFor(arguments, picture), without_display),
              "picture: " + picture + "\n");
    return read(picture);
  }

  /** \brief Images for several options, all on one display, which is faster. */
  std::vector<cv::Mat>
  operator()(const std::vector<std::string>& arguments) const
  {
    std::string script, text;
    std::vector<std::string> names;
    for (const std::string& each : arguments) {
      names.push_back(path(std::to_string(names.size()) + ".png"));
      script += program + commandFor(each, names.back()) + " || exit 1\n";
      text += "picture: " + names.back() + "\n";
    }
    const ToolResult result = runOnDisplay("sh " + folder_.write("script", script));
    EXPECT_EQ(result.code, 0) << result.text;
    EXPECT_EQ(result.text, text);
    std::vector<cv::Mat> pictures;
    for (const std::string& name : names)
      pictures.push_back(read(name));
    return pictures;
  }

private:
  std::string
  commandFor(const std::string& arguments, const std::string& picture) const
  {
    return "view " + replaceAll(arguments, "MAPS/", folder_.path() + "/") +
           " --size 400x300 --screenshot " + picture;
  }

  static cv::Mat
  read(const std::string& picture)
  {
    const cv::Mat image = readPng(picture, ImageKind::grey_or_colour);
    EXPECT_EQ(image.size(), cv::Size(400, 300));
    return image;
  }

  TemporaryFolder folder_;
};

class ViewTool : public testing::Test {
protected:
  void
  SetUp() override
  {
    if (!hasVirtualDisplay())
      GTEST_SKIP() << "xvfb or xauth is not installed";
  }
};

// Writes a program that stands in for the viewer beside a copy of pcl_semantic_map; the
// command that runs both.
std::string
mapWithViewer(const TemporaryFolder& folder, const std::string& script)
{
  fs::copy_file(program + "map", folder.path("pcl_semantic_map"),
                fs::copy_options::overwrite_existing);
  const std::string viewer =
      folder.write("pcl_semantic_view", "#!/bin/sh\n" + script + "\n");
  fs::permissions(viewer, fs::perms::owner_all);
  return "exec " + folder.path("pcl_semantic_") + mapInto(folder.path("seen")) +
         " --view 2>&1";
}

} // namespace

TEST_F(ViewTool, DrawsClassesHidesAndClipsThem)
{
  const Views view;
  const std::string above = "MAPS/block.pcd --view above --keys l";
  const cv::Vec3b road = colourOf("road"), car = colourOf("car");
  const std::vector<cv::Mat> seen =
      view({above, above + " --hide car", above + " --below 0.1", above + ",6",
            above + " --hide road", above + " --hide road,car"});
  // Seen from above, 64 of the 900 squares are the block.
  const int block = count(seen[0], car), floor = count(seen[0], road);
  EXPECT_GT(floor, 400 * 300 / 4);
  EXPECT_NEAR(double(block) / floor, 64.0 / 836.0, 0.02);
  for (std::size_t i = 1; i < 4; ++i) { // the floor below appears: it is complete
    EXPECT_EQ(count(seen[i], car), 0) << i;
    EXPECT_GT(count(seen[i], road), floor + block) << i;
  }
  EXPECT_EQ(count(seen[4], road), 0);
  EXPECT_EQ(count(seen[4], car), block);
  EXPECT_EQ(count(seen[5], car) + count(seen[5], road), 0);
}

TEST_F(ViewTool, KeysDoWhatOptionsDo)
{
  const Views view;
  const std::pair<std::string, std::string> same[] = {
      {"--hide car", "6"},
      {"--hide road,car", "a"},
      // Two layers of the block's four; back again; from the other end.
      {"--below 0.3", "Down"},
      {"--threads 1", "Down,Down,Home"},
      {"--view above", "v"},
      {"--keys l", "l,6,6,a,a,v,v,h,h,9,F7"},
      {"--keys h,h", "q"}};
  std::vector<std::string> all;
  for (const auto& [options, keys] : same) {
    all.push_back("MAPS/block.pcd " + options);
    all.push_back("MAPS/block.pcd --keys " + keys);
  }
  const std::vector<cv::Mat> pictures = view(all);
  for (std::size_t i = 0; i < pictures.size(); i += 2)
    EXPECT_TRUE(isSameImage(pictures[i], pictures[i + 1])) << all[i + 1];
  for (std::size_t i = 0; i < 10; i += 2) // each does something else
    for (std::size_t j = 0; j < i; j += 2)
      EXPECT_FALSE(isSameImage(pictures[i], pictures[j])) << all[i] << ", " << all[j];
}

TEST_F(ViewTool, DrawsTheBoxesOfObjects)
{
  const Views view;
  const std::string plain = "MAPS/block.pcd --view above",
                    boxes = plain + " --objects MAPS/objects.json";
  const std::vector<cv::Mat> seen =
      view({plain, plain + " --objects none", boxes + " --keys b", boxes,
            boxes + " --keys b,b", boxes + " --keys n,n", // 3 to 5
            boxes + " --keys n", boxes + " --hide car", plain + " --hide car"});
  for (const auto& [i, j] : {std::pair(0, 1), {0, 2}, {3, 4}, {3, 5}, {7, 8}})
    EXPECT_TRUE(isSameImage(seen[std::size_t(i)], seen[std::size_t(j)])) << i << j;
  const cv::Vec3b car(128, 0, 64), red(60, 60, 235); // blue, green, red
  EXPECT_EQ(count(seen[0], car), 0);
  EXPECT_GT(count(seen[3], car), 100);
  EXPECT_EQ(count(seen[3], red), 0);
  EXPECT_GT(count(seen[6], red), 100) << "the selected one";
  EXPECT_EQ(count(seen[6], car), 0);
  EXPECT_FALSE(isSameImage(seen[6](cv::Rect(0, 150, 150, 150)),
                           seen[3](cv::Rect(0, 150, 150, 150))))
      << "the panel describes it";
}

TEST_F(ViewTool, HasALegendInTheColoursOfTheClasses)
{
  const Views view;
  const std::string nothing = "MAPS/block.pcd --below -1 ";
  const cv::Mat with = view(nothing); // by its own display
  const std::vector<cv::Mat> others =
      view({nothing + "--keys l", nothing + "--hide car"});
  for (const char* const name : {"road", "car"}) {
    EXPECT_EQ(count(with, colourOf(name)), 13 * 13) << name;
    EXPECT_EQ(count(others[0], colourOf(name)), 0) << name;
  }
  EXPECT_LT(count(others[1], colourOf("car")), 13 * 13 / 2);
}

TEST_F(ViewTool, ShowsMapsInAllTheirColours)
{
  const Views view;
  mapStreet(tinyStreet(), view.path("map"), "");
  succeed(mapInto(view.path("kept")) + " --archive " + view.path("map.archive"));
  const std::string map = "MAPS/map --keys l";
  const std::vector<cv::Mat> pictures =
      view({map + " --colour class", map + " --colour rgb", map + " --colour entropy",
            map + " --images " + tinyStreet(), map + ",t",
            map + " --from 5,3,2 --look-at 20,0,0", // all of these differ
            map, map + ",m", map + ",m,m",
            "MAPS/map.archive --trajectory MAPS/map/trajectory.txt --keys l"});
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = 0; j < i; ++j)
      EXPECT_FALSE(isSameImage(pictures[i], pictures[j])) << i << " and " << j;
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_TRUE(isSameImage(pictures[i], pictures[6 + i])) << i;
  EXPECT_TRUE(isSameImage(pictures[0], pictures[9]));
  EXPECT_GT(count(pictures[0], colourOf("road")), 300);
}

TEST_F(ViewTool, OpensAWindowAndIsSilent)
{
  const Views view;
  const ToolResult result = runOnDisplay(program + "view " + view.path("block.pcd") +
                                         " --keys 6,m,Down,v,h,t,i,q");
  EXPECT_EQ(result.code, 0);
  EXPECT_EQ(result.text, "");
}

TEST_F(ViewTool, TheMapInTheMakingIsTheSameWithAWindow)
{
  const TemporaryFolder folder;
  mapStreet(tinyStreet(), folder.path("plain"), "");
  const ToolResult result =
      runOnDisplay(program + mapInto(folder.path("seen")) + " --view --quiet");
  EXPECT_EQ(result.code, 0);
  EXPECT_EQ(result.text, "");
  expectSameMaps(folder.path("plain"), folder.path("seen"));
}

TEST_F(ViewTool, FollowsAMapFromBeforeItsFirstFrame)
{
  // The window, which only its key closes, opens before the folder exists.
  const TemporaryFolder folder;
  const std::string map = folder.path("map");
  const std::string script = program + "view " + map + " --follow --images " +
                             tinyStreet() + " --keys m,q &\n" + program + mapInto(map) +
                             " --quiet || exit 1\nwait $!\n";
  const ToolResult result = runOnDisplay("sh " + folder.write("script", script));
  EXPECT_EQ(result.code, 0);
  EXPECT_EQ(result.text, "following: " + map + "\n");
}

TEST(LiveView, AWindowThatClosesStopsNothing)
{
  const TemporaryFolder folder;
  mapStreet(tinyStreet(), folder.path("plain"), "");
  const ToolResult result =
      runShell(mapWithViewer(folder, "echo following: $1") + " --quiet");
  EXPECT_EQ(result.code, 0);
  EXPECT_EQ(result.text, "");
  expectSameMaps(folder.path("plain"), folder.path("seen"));
}

TEST(LiveView, AWindowThatDoesNotOpenIsSaidAtOnce)
{
  const TemporaryFolder folder;
  const auto expectLine = [&](const std::string& command, const std::string& line) {
    const ToolResult result = runShell(command);
    EXPECT_EQ(result.code, 2);
    EXPECT_EQ(result.text, "pcl_semantic_map: --view: " + line + "\n");
    EXPECT_FALSE(fs::exists(folder.path("seen")));
  };
  expectLine(mapWithViewer(folder, "echo no colours >&2"), "no colours");
  expectLine(mapWithViewer(folder, "exit 1"), "the window did not open");
  const std::string map = mapWithViewer(folder, "");
  fs::remove(folder.path("pcl_semantic_view"));
  expectLine(map, folder.path("pcl_semantic_view") +
                      " cannot be started; is pcl_semantic_view installed?");
}

TEST(BadUsage, ViewToolWithoutADisplay)
{
  const TemporaryFolder folder;
  const std::string view = "view " + folder.write("block.pcd", floorAndBlock()),
                    none = "there is no display";
  for (const auto& [command, before, says] :
       {std::tuple(view, std::string(without_display), none),
        {view, "DISPLAY=:9999", none},
        {view + " --screenshot " + folder.path("a.png"),
         without_display + ("PATH=" + folder.path() + ";"),
         "xvfb-run, which is missing: packages xvfb and xauth"},
        {mapInto(folder.path("map")) + " --view", without_display, none}}) {
    const ToolResult result = runTool(command, before);
    EXPECT_EQ(result.code, 2);
    EXPECT_TRUE(holds(result.text, says)) << result.text;
    EXPECT_EQ(std::count(result.text.begin(), result.text.end(), '\n'), 1);
  }
}

TEST(BadUsage, ViewTool)
{
  const std::string draw = "view STREET/a.pcd --screenshot OUT.png";
  const auto cloud = [](const std::string& street) {
    std::ofstream(street + "/a.pcd") << floorAndBlock();
  };
  expectAllFail({
      {2, "MAP is missing", "view"},
      {2, "--follow needs a window", draw + " --follow"},
      {2, "ends in .png", "view STREET/a.pcd --screenshot OUT.jpg"},
      {2, "--colour is 'red', expected class", draw + " --colour red"},
      {2, "--above was removed: --below", draw + " --above 1"},
      {2, "--small was removed", draw + " --small"},
      {2, "--view is 'below', expected angle", draw + " --view below"},
      {2, "--below", draw + " --below high"},
      {2, "threads is -1", draw + " --threads -1"},
  });
  if (!hasVirtualDisplay())
    return;
  expectAllFail({
      {3, "none.pcd: cannot be read", "view STREET/none.pcd --screenshot OUT.png"},
      {2, "has no colours for --colour entropy, expected class",
       draw + " --colour entropy", cloud},
      {3, "a.pcd: has neither labels nor colours", draw + " --voxel-size 1",
       [](const std::string& street) {
         std::ofstream(street + "/a.pcd") << asciiCloud("x y z", "1 2 3\n");
       }},
      {2, "--hide: no class is called 'cat'", draw + " --hide cat", cloud},
      {3, "a.pcd: byte 1 is no JSON", draw + " --objects STREET/a.pcd", cloud},
      {2, "--images needs the poses of the camera", draw + " --images STREET", cloud},
      {2, "none for --frame 0", draw + " --view camera", cloud},
      {5, "calib.txt", "view STREET/a.pcd --screenshot STREET/calib.txt/b.png", cloud},
  });
}

} // namespace pcl_semantic
