// SPDX-License-Identifier: BSD-3-Clause

// The guides of doc/: every command runs, from the first to the last, in a folder that
// looks like the project once it is built; every file that is shown is written where
// its first line says; C++ is a part of an example, which is compiled.

#include "support/code_blocks.h"
#include "support/onnx_writer.h"
#include "support/own_camera.h"
#include "support/thrown_message.h"

#include <pcl_semantic/files/cloud_file.h>
#include <pcl_semantic/files/label_set_file.h>

#include <cctype>
#include <regex>

namespace {

using namespace pcl_semantic;
namespace fs = std::filesystem;

const std::string docs = PCL_SEMANTIC_SOURCE_DIR "/doc/";
const char* const guides[] = {"tutorial.md", "own_clouds.md", "own_network.md",
                              "how_it_works.md", "viewing.md"};

// The project, and what its reader brings along: cameras and networks.
void
layOut(const TemporaryFolder& folder)
{
  fs::create_directories(folder.path("build"));
  fs::create_directories(folder.path("park"));
  fs::create_directories(folder.path("nets"));
  for (const char* const name : {"bin", "examples"})
    fs::create_directory_symlink(PCL_SEMANTIC_BINARY_DIR + ("/" + std::string(name)),
                                 folder.path("build/" + std::string(name)));
  fs::create_directory_symlink(PCL_SEMANTIC_SOURCE_DIR "/data", folder.path("data"));
  writeOwnCamera(folder.path("rig"));
  folder.write("nets/espnetv2_s2.0_city_1280x480_halfres.onnx", cityNetwork());
  PointwiseNetwork park;
  park.width = 104;
  park.height = 32;
  park.channels = 7;
  park.weights.assign(21, 0.0f);
  park.bias = {0.0f, 0.0f, 3.0f, 0.0f, 0.0f, 0.0f, 0.0f}; // all is grass
  folder.write("park/park.onnx", park.file());
}

// The file that a block shows, by its first line: "# NAME". Empty if it shows none.
std::string
fileShownIn(const CodeBlock& block)
{
  std::smatch match;
  return !block.lines.empty() && std::regex_match(block.lines[0], match,
                                                  std::regex("# (\\S+\\.(yaml|pcd))"))
             ? match[1].str()
             : "";
}

void
writeShownFile(const TemporaryFolder& folder, const CodeBlock& block)
{
  std::string text;
  for (const std::string& line : block.lines)
    text += line + "\n";
  folder.write(fileShownIn(block), text);
}

void
runCommands(const TemporaryFolder& folder, const CodeBlock& block)
{
  for (const std::string& command : commandsOf(block)) {
    if (command.rfind("./dev ", 0) == 0)
      continue; // below
    const ToolResult result = runShell("{ HOME=" + folder.path() + "; cd " +
                                       folder.path() + "; " + command + "; } 2>&1");
    EXPECT_EQ(result.code, 0) << command << "\n" << result.text;
  }
}

bool
isInAnExample(const CodeBlock& block)
{
  for (const auto& entry :
       fs::directory_iterator(PCL_SEMANTIC_SOURCE_DIR "/apps/examples"))
    if (isPartOf(entry.path().string(), block))
      return true;
  return false;
}

std::string
textOf(const CodeBlock& block)
{
  return block.lines.empty() ? "an empty block" : block.lines[0];
}

// Follows a guide word by word.
void
follow(const std::string& guide, const TemporaryFolder& folder)
{
  layOut(folder);
  for (const CodeBlock& block : codeBlocksOf(docs + guide)) {
    if (block.language == "bash")
      runCommands(folder, block);
    else if (block.language == "cpp")
      EXPECT_TRUE(isInAnExample(block)) << "in no example: " << textOf(block);
    else if (!fileShownIn(block).empty())
      writeShownFile(folder, block);
    else // a drawing; blocks of commands have a language
      EXPECT_EQ(block.language, "text") << textOf(block);
  }
}

std::size_t
pointsIn(const std::string& path)
{
  return readLabelledCloud(path).cloud->size();
}

// How many points of a cloud have a label.
std::ptrdiff_t
countLabel(const std::string& path, std::uint32_t label)
{
  const auto cloud = readLabelledCloud(path).cloud;
  return std::count_if(cloud->begin(), cloud->end(),
                       [&](const auto& point) { return point.label == label; });
}

// Whether a Markdown file has a heading that the part of a link behind # leads to.
bool
hasHeading(const std::string& path, const std::string& anchor)
{
  for (const std::string& line : linesOf(path)) {
    if (line.rfind("## ", 0) != 0)
      continue;
    std::string name;
    for (const char c : line.substr(3))
      if (std::isalnum(static_cast<unsigned char>(c)) || c == ' ' || c == '-')
        name += c == ' ' ? '-' : char(std::tolower(static_cast<unsigned char>(c)));
    if (name == anchor)
      return true;
  }
  return false;
}

} // namespace

TEST(Guides, TutorialMapsARig)
{
  const TemporaryFolder folder;
  follow("tutorial.md", folder);
  EXPECT_EQ(readKittiTrajectory(folder.path("poses.txt")).size(), 3u);
  EXPECT_EQ(linesOf(folder.path("tracking.csv")).size(), 4u);
  EXPECT_GT(pointsIn(folder.path("rig_map/map.pcd")), 5000u);
  // The network calls all of it cars: they have the most channels.
  EXPECT_EQ(countLabel(folder.path("rig_map/map.pcd"), 6),
            std::ptrdiff_t(pointsIn(folder.path("rig_map/map.pcd"))));
  EXPECT_EQ(readPng(folder.path("rig_map.png"), ImageKind::grey_or_colour).cols, 1600);
  EXPECT_EQ(readLabelledCloud(folder.path("clouds/shot9.pcd")).cloud->width, 208u);
}

TEST(Guides, OwnCloudsAreMendedAndMapped)
{
  const TemporaryFolder folder;
  follow("own_clouds.md", folder);
  const auto label = [&](const char* file, std::size_t point) {
    return (*readLabelledCloud(folder.path(file)).cloud)[point].label;
  };
  EXPECT_EQ(label("corner.pcd", 4), 1u);
  EXPECT_EQ(label("refined.pcd", 4), 3u);
  EXPECT_EQ(countLabel(folder.path("refined.pcd"), 3), 9);
  EXPECT_EQ(readLabelledCloud(folder.path("refined.pcd")).distributions.classes(), 11);
  EXPECT_FALSE(readLabelledCloud(folder.path("grouped.pcd")).cliques.empty());
  EXPECT_GT(countLabel(folder.path("scans_map.pcd"), 3), 2);
  EXPECT_GT(countLabel(folder.path("scans_map.pcd"), 1), 0);
  EXPECT_GT(countLabel(folder.path("scans_map/map.pcd"), 3), 2);
  EXPECT_TRUE(fs::exists(folder.path("scans_map.png")));
  EXPECT_EQ(pointsIn(folder.path("street_map/map.pcd")),
            pointsIn(folder.path("street_refined.pcd")));
  EXPECT_GT(countLabel(folder.path("street_refined.pcd"), 3), 1000);
}

TEST(Guides, OwnNetworkMapsItsOwnClasses)
{
  const TemporaryFolder folder;
  follow("own_network.md", folder);
  for (const char* const map : {"park_map/map.pcd", "park_map_ids/map.pcd"}) {
    EXPECT_EQ(readLabelledCloud(folder.path(map)).distributions.classes(), 5);
    EXPECT_GT(pointsIn(folder.path(map)), 5000u);
    EXPECT_EQ(countLabel(folder.path(map), 2),
              std::ptrdiff_t(pointsIn(folder.path(map))));
  }
  const LabelSet classes = readLabelSet(folder.path("park/classes.yaml"));
  const LabelMapping mapping =
      readLabelMapping(folder.path("park/from_raw.yaml"), classes);
  EXPECT_EQ(mapping(71), classes.find("tree"));
  EXPECT_EQ(mapping(99), kUnlabelled);
}

TEST(Guides, ViewingDrawsTheDemo)
{
  if (!fs::exists(PCL_SEMANTIC_BINARY_DIR "/bin/pcl_semantic_view") ||
      runShell("command -v xvfb-run").code != 0)
    GTEST_SKIP() << "pcl_semantic_view or xvfb is missing";
  const TemporaryFolder folder;
  const std::string street = folder.path("build/demo/sequence");
  fs::create_directories(folder.path("build/demo"));
  copyStreet(street);
  succeed(mapOf(street) + " --output " + folder.path("build/demo/map"));
  follow("viewing.md", folder);
  for (const char* const picture : {"view.png", "entropy.png"})
    EXPECT_EQ(readPng(folder.path(picture), ImageKind::grey_or_colour).cols, 1600);
}

TEST(Guides, HowItWorksNamesFilesThatAreThere)
{
  const TemporaryFolder folder;
  follow("how_it_works.md", folder);
  const std::string text = bytesOf(docs + "how_it_works.md");
  const std::regex pattern("`([a-z_0-9]+/[a-z_0-9/]+\\.(h|cpp))`");
  int found = 0;
  for (std::sregex_iterator match(text.begin(), text.end(), pattern), end; match != end;
       ++match, ++found) {
    const std::string path = (*match)[1];
    EXPECT_TRUE(fs::exists(PCL_SEMANTIC_SOURCE_DIR "/" + path) ||
                fs::exists(PCL_SEMANTIC_SOURCE_DIR "/include/pcl_semantic/" + path))
        << path;
  }
  EXPECT_GT(found, 20);
}

TEST(Guides, LinksLeadSomewhereAndTheReadmeToThem)
{
  const std::string readme = bytesOf(PCL_SEMANTIC_SOURCE_DIR "/README.md");
  for (const std::string guide : guides) {
    EXPECT_TRUE(holds(readme, "](doc/" + guide + ")")) << guide;
    EXPECT_FALSE(localLinksOf(docs + guide).empty());
    for (const std::string& link : localLinksOf(docs + guide)) {
      const std::string target = link.substr(0, link.find('#'));
      EXPECT_TRUE(fs::exists(docs + target)) << guide << ": " << target;
      EXPECT_TRUE(target == link ||
                  hasHeading(docs + target, link.substr(target.size() + 1)))
          << guide << ": " << link;
    }
  }
}

TEST(Guides, TheirCommandsOfDevExist)
{
  const std::string help =
      runShell("bash " PCL_SEMANTIC_SOURCE_DIR "/dev --help 2>&1").text;
  int found = 0;
  for (const std::string guide : guides)
    for (const std::string& command : bashCommandsOf(docs + guide)) {
      if (command.rfind("./dev ", 0) != 0)
        continue;
      ++found;
      EXPECT_TRUE(holds(help, "\n  " + command.substr(6))) << command;
    }
  EXPECT_GT(found, 0);
}

TEST(Reference, IsMadeWithoutWarnings)
{
  if (runShell("doxygen --version 2>/dev/null").code != 0)
    GTEST_SKIP() << "doxygen is not installed";
  const TemporaryFolder folder;
  const ToolResult result = runShell("cd " PCL_SEMANTIC_SOURCE_DIR
                                     "; { cat doc/Doxyfile; echo OUTPUT_DIRECTORY = " +
                                     folder.path() + "; } | doxygen - 2>&1");
  EXPECT_EQ(result.code, 0) << result.text;
  EXPECT_TRUE(
      fs::exists(folder.path("html/classpcl__semantic_1_1SemanticVoxelMap.html")));
}
