// SPDX-License-Identifier: BSD-3-Clause

// The guides of doc/ and the README: every command runs, from the first to the last, in
// a folder that looks like the project once it is built; every file that is shown is
// written where its first line says; C++ is a part of an example, which is compiled.

#include "core/text_stream.h"
#include "images/grey_image.h"
#include "support/onnx_writer.h"
#include "support/own_camera.h"
#include "support/thrown_message.h"

#include <pcl_semantic/files/cloud_file.h>
#include <pcl_semantic/files/label_set_file.h>
#include <pcl_semantic/files/trajectory_file.h>

#include <cctype>
#include <regex>

namespace {

using namespace pcl_semantic;
namespace fs = std::filesystem;

struct CodeBlock {
  std::string language; ///< "bash"; empty if unspecified
  std::vector<std::string> lines;
};

std::vector<CodeBlock>
codeBlocksOf(const std::string& path)
{
  std::vector<CodeBlock> blocks;
  bool inside = false;
  for (const std::string& line : linesOf(path)) {
    const bool is_fence = line.rfind("```", 0) == 0;
    if (is_fence && !inside)
      blocks.push_back({line.substr(3), {}});
    else if (!is_fence && inside)
      blocks.back().lines.push_back(line);
    inside = inside != is_fence;
  }
  EXPECT_FALSE(inside) << path << ": the last block does not end";
  return blocks;
}

// The commands of a bash block, continued lines joined.
std::vector<std::string>
commandsOf(const CodeBlock& block)
{
  std::vector<std::string> commands;
  bool continued = false;
  for (std::string line : block.lines) {
    const bool continues = !line.empty() && line.back() == '\\';
    if (continues)
      line.pop_back();
    if (continued)
      commands.back() += line;
    else if (!line.empty())
      commands.push_back(line);
    continued = continues;
  }
  return commands;
}

std::vector<std::string>
bashCommandsOf(const std::string& path)
{
  std::vector<std::string> commands;
  for (const CodeBlock& block : codeBlocksOf(path))
    if (block.language == "bash")
      for (const std::string& command : commandsOf(block))
        commands.push_back(command);
  return commands;
}

// Targets of the local links in a Markdown file.
std::vector<std::string>
localLinksOf(const std::string& path)
{
  std::vector<std::string> links;
  const std::string text = bytesOf(path);
  for (std::size_t at = 0; (at = text.find("](", at)) != std::string::npos; ++at) {
    const std::string target = text.substr(at + 2, text.find(')', at) - at - 2);
    if (target.rfind("http", 0) != 0)
      links.push_back(target);
  }
  return links;
}

// Whether the lines of a block are consecutive in a source file, at any indentation;
// empty lines are ignored.
bool
isPartOf(const std::string& source, const CodeBlock& block)
{
  const auto flatten = [](const std::vector<std::string>& lines) {
    std::string text = "\n";
    for (const std::string& line : lines) {
      const std::size_t begin = line.find_first_not_of(' ');
      if (begin != std::string::npos)
        text += line.substr(begin) + "\n";
    }
    return text;
  };
  const std::string wanted = flatten(block.lines);
  return wanted.size() > 1 &&
         flatten(linesOf(source)).find(wanted) != std::string::npos;
}

const std::string docs = PCL_SEMANTIC_SOURCE_DIR "/doc/";
const char* const readme = PCL_SEMANTIC_SOURCE_DIR "/README.md";
const char* const guides[] = {"tutorial.md",     "own_clouds.md", "own_network.md",
                              "how_it_works.md", "viewing.md",    "survey.md",
                              "rgbd.md",         "fisheye.md",    "euroc.md"};

// The project, and what its reader brings along: cameras and networks.
void
layOut(const TemporaryFolder& folder)
{
  fs::create_directories(folder.path("build"));
  fs::create_directories(folder.path("park"));
  fs::create_directories(folder.path("nets"));
  for (const std::string name : {"/bin", "/examples", "/python"})
    fs::create_directory_symlink(PCL_SEMANTIC_BINARY_DIR + name,
                                 folder.path("build" + name));
  for (const std::string name : {"/data", "/python"})
    fs::create_directory_symlink(PCL_SEMANTIC_SOURCE_DIR + name, folder.path() + name);
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

// The street in the layout of EuRoC, grey.
void
writeEuroc(const std::string& folder)
{
  const KittiSequence street(tinyStreet());
  const StereoCamera& camera = street.camera();
  for (const std::string side : {"cam0", "cam1"}) {
    const std::string images = folder + "/mav0/" + side + "/data";
    fs::create_directories(images);
    TextStream yaml;
    yaml.precision(17);
    yaml << "sensor_type: camera\nT_BS:\n  cols: 4\n  rows: 4\n  data: [1, 0, 0, "
         << (side == "cam0" ? 0.0 : camera.baseline)
         << ", 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]\nresolution: [" << camera.width
         << ", " << camera.height << "]\ncamera_model: pinhole\nintrinsics: ["
         << camera.fx << ", " << camera.fy << ", " << camera.cx << ", " << camera.cy
         << "]\ndistortion_model: radial-tangential\n"
            "distortion_coefficients: [0, 0, 0, 0]\n";
    std::ofstream(folder + "/mav0/" + side + "/sensor.yaml") << yaml.str();
    for (const int frame : {0, 1, 2}) {
      const StereoFrame pair = street.frame(std::size_t(frame));
      writePng(images + "/140363657976355558" + std::to_string(4 + frame) + ".png",
               greyImage(side == "cam0" ? pair.left : pair.right));
    }
  }
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

// What ./dev demo makes.
void
writeDemo(const TemporaryFolder& folder)
{
  const std::string demo = folder.path("build/demo");
  fs::create_directories(demo);
  copyStreet(demo + "/sequence");
  addScan(demo + "/sequence");
  succeed(mapOf(demo + "/sequence") + " --output " + demo + "/map");
}

// Runs commands, except those of ./dev (below) and the reader's own paths.
int
runCommands(const TemporaryFolder& folder, const std::vector<std::string>& commands,
            const std::string& variables = "")
{
  int run = 0;
  for (const std::string& command : commands)
    if (command.rfind("./dev ", 0) != 0 && command.rfind("SEQUENCE=", 0) != 0 &&
        command.rfind("MODEL=", 0) != 0) {
      ++run;
      const ToolResult result =
          runShell("{ HOME=" + folder.path() + "; cd " + folder.path() + "; " +
                   variables + command + "; } 2>&1");
      EXPECT_EQ(result.code, 0) << command << "\n" << result.text;
    }
  return run;
}

// The number of the commands of ./dev in a document, which --help has to list.
int
commandsOfDev(const std::string& document)
{
  static const std::string help =
      runShell("bash " PCL_SEMANTIC_SOURCE_DIR "/dev --help 2>&1").text;
  int found = 0;
  for (const std::string& command : bashCommandsOf(document))
    if (command.rfind("./dev ", 0) == 0) {
      ++found;
      EXPECT_TRUE(holds(help, "\n  " + command.substr(6))) << command;
    }
  return found;
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
  if (folder.entries() == 0)
    layOut(folder);
  for (const CodeBlock& block : codeBlocksOf(docs + guide)) {
    if (block.language == "bash")
      runCommands(folder, commandsOf(block));
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
  layOut(folder);
  writeDemo(folder);
  follow("viewing.md", folder);
  for (const char* const picture : {"view.png", "entropy.png"})
    EXPECT_EQ(readPng(folder.path(picture), ImageKind::grey_or_colour).cols, 1600);
}

TEST(Guides, ASurveyIsThinnedRefinedAndExported)
{
  const TemporaryFolder folder;
  layOut(folder);
  follow("survey.md", folder);
  EXPECT_TRUE(fs::exists(folder.path("refined.pcd")));
}

TEST(Guides, AnRgbdRecordingBecomesAMap)
{
  const TemporaryFolder folder;
  layOut(folder);
  follow("rgbd.md", folder);
  EXPECT_TRUE(fs::exists(folder.path("first_map/map.pcd")));
  EXPECT_EQ(readKittiTrajectory(folder.path("poses.txt")).size(), 24u);
  EXPECT_TRUE(fs::exists(folder.path("map.png")));
}

TEST(Guides, FisheyesBecomeMaps)
{
  const TemporaryFolder folder;
  layOut(folder);
  follow("fisheye.md", folder);
  for (const char* const picture : {"first_map.png", "room_map.png"})
    EXPECT_TRUE(fs::exists(folder.path(picture)));
}

TEST(Guides, AnEurocRecordingBecomesAMap)
{
  const TemporaryFolder folder;
  layOut(folder);
  writeEuroc(folder.path("V1_01_easy"));
  follow("euroc.md", folder);
  EXPECT_EQ(readTumTrajectory(folder.path("poses.txt")).size(), 3u);
  EXPECT_TRUE(fs::exists(folder.path("first_map.png")));
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
  const std::string text = bytesOf(readme);
  for (const std::string guide : guides) {
    EXPECT_TRUE(holds(text, "](doc/" + guide + ")")) << guide;
    EXPECT_FALSE(localLinksOf(docs + guide).empty());
    for (const std::string& link : localLinksOf(docs + guide)) {
      const std::string target = link.substr(0, link.find('#'));
      EXPECT_TRUE(fs::exists(docs + target)) << guide << ": " << target;
      EXPECT_TRUE(target == link ||
                  hasHeading(docs + target, link.substr(target.size() + 1)))
          << guide << ": " << link;
    }
  }
  const std::vector<std::string> links = localLinksOf(readme);
  for (const std::string& target : links)
    EXPECT_TRUE(fs::exists(fs::path(PCL_SEMANTIC_SOURCE_DIR) / target)) << target;
  EXPECT_GE(links.size(), 5u);
}

TEST(Guides, TheirCommandsOfDevExist)
{
  int found = 0;
  for (const std::string guide : guides)
    found += commandsOfDev(docs + guide);
  EXPECT_GT(found, 0);
  EXPECT_EQ(commandsOfDev(readme), 3);
  const std::string ci =
      bytesOf(PCL_SEMANTIC_SOURCE_DIR "/.ci/run"); // runs them itself
  for (const std::string& command : bashCommandsOf(readme))
    EXPECT_TRUE(command.rfind("./dev ", 0) != 0 || holds(ci, command)) << command;
}

// And those of doc/kitti.md, with a tiny street instead of KITTI.
TEST(Readme, ItsCommandsRun)
{
  const TemporaryFolder folder;
  layOut(folder);
  writeDemo(folder);
  std::vector<std::string> commands = bashCommandsOf(readme);
  for (const std::string& command : bashCommandsOf(docs + "kitti.md"))
    commands.push_back(command);
  EXPECT_GE(runCommands(folder, commands,
                        "SEQUENCE=" + folder.path("build/demo/sequence") +
                            "; MODEL=" + folder.write("city.onnx", cityNetwork()) +
                            "; PATH=/usr/bin:$PATH; "), // Debian's Python
            5);
  for (const char* file :
       {"map_05/map.pcd", "map_coarse/map.pcd", "truth_05/000000.png", "refined.pcd",
        "refined.png", "overlay.png"})
    EXPECT_TRUE(fs::exists(folder.path(file))) << file;
}

TEST(Readme, ItsTableNamesEveryTool)
{
  const std::string text = bytesOf(readme), prefix = "pcl_semantic_";
  int tools = 0;
  for (const auto& entry : fs::directory_iterator(PCL_SEMANTIC_BINARY_DIR "/bin")) {
    ++tools;
    const std::string name = entry.path().filename().string();
    ASSERT_EQ(name.rfind(prefix, 0), 0u) << name;
    EXPECT_TRUE(holds(text, "`" + name.substr(prefix.size()) + "`")) << name;
  }
  EXPECT_GE(tools, 4);
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
