// SPDX-License-Identifier: BSD-3-Clause
#include "cloud_doubts.h"
#include "image_tool.h"
#include "io/cloud_row_writer.h"
#include "large_cloud.h"
#include "messages.h"
#include "tile_cliques.h"
#include "tool.h"

#include <pcl_semantic/cliques/ranked_cliques.h>
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/no_return.h>
#include <pcl_semantic/core/sensor_pose.h>
#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/core/voxel_index.h>
#include <pcl_semantic/dataset/kitti_calibration.h>
#include <pcl_semantic/files/cloud_file.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/files/pose_doubts.h>
#include <pcl_semantic/files/trajectory_file.h>
#include <pcl_semantic/filters/crf_config.h>
#include <pcl_semantic/io/colour_cloud_file.h>
#include <pcl_semantic/odometry/pose_source.h>
#include <pcl_semantic/superpixels/clique_config.h>
#include <pcl_semantic/superpixels/superpixel_cliques.h>

#include <pcl/common/io.h>
#include <pcl/common/point_tests.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace pcl_semantic;
using namespace pcl_semantic::tool;

const Usage usage{
    "pcl_semantic_cliques",
    "IN.pcd OUT.pcd --method METHOD [options]",
    R"(Groups the points of a cloud that are likely to have one label. OUT.pcd is IN.pcd
with the field clique (0 = none), which pcl_semantic_crf --cliques field takes.
Methods: planes[:EDGE], supervoxel[:SEED_DISTANCE], cubes[:EDGE], superpixel[:NUMBER]
(of a frame, seen in a map), slic[:NUMBER] (of IN.pcd, an organized cloud).)",
    R"(pcl_semantic_synthesize /tmp/street && \
  pcl_semantic_map /tmp/street --labels /tmp/street/labels --crf none \
    --output /tmp/raw_map && \
  pcl_semantic_stereo /tmp/street/image_2/000000.png /tmp/street/image_3/000000.png \
    /tmp/street/calib.txt /tmp/frame.pcd && \
  pcl_semantic_cliques /tmp/raw_map/map.pcd /tmp/cliques.pcd --method superpixel \
    --frame /tmp/frame.pcd --pose /tmp/raw_map/trajectory.txt:0 \
    --coloured /tmp/coloured.pcd && \
  pcl_semantic_crf /tmp/cliques.pcd /tmp/grouped.pcd --crf hierarchical \
    --cliques field)",
    {{"method METHOD", "planes, supervoxel, cubes, superpixel or slic"},
     {"frame FILE", "organized cloud in the camera frame, for superpixel"},
     {"pose POSE", "pose of the frame: FILE:ROW, or x y z qx qy qz qw"},
     {"coloured FILE", "output cloud with one colour per clique"},
     {"voxel-size 0.1", "voxel size of the map [m]"},
     {"map-origin X,Y,Z", "map_origin in summary.json of the map [m]"}}};

// The frame whose superpixels are transferred to a map.
struct CliqueFrame {
  std::string path;        ///< organized cloud, camera frame
  std::string pose;        ///< see poseOf(); empty = the cloud's VIEWPOINT
  std::string calibration; ///< calib.txt, if the pose is of camera 0; may be empty
  Eigen::Vector3d map_origin = Eigen::Vector3d::Zero(); ///< of the map's points [m]
  double voxel_size = 0.1;                              ///< of the map [m]
};

struct Arguments {
  std::string input, output, method, coloured, scan_columns;
  CliqueFrame frame;
  CliqueParameters parameters;
  int threads = 0;
  double memory = 0.0; // [GB]
};

void
requireFittingOptions(const Arguments& arguments)
{
  const CliqueFrame& frame = arguments.frame;
  refuseIf(arguments.output.empty(), "expected IN.pcd OUT.pcd");
  refuseIf(arguments.method.empty(), "--method is missing");
  const bool superpixels = namesCliques(arguments.method, "superpixel");
  refuseIf(superpixels && frame.path.empty(), "--method superpixel needs --frame");
  refuseIf(!frame.calibration.empty() && frame.pose.find(':') == std::string::npos,
           "--calibration is for --pose FILE:N");
  requireOutput(arguments.output, ".pcd");
  requireOutput(arguments.coloured, ".pcd");
  refuseSameFiles({arguments.input, frame.path, frame.calibration,
                   frame.pose.substr(0, frame.pose.rfind(':'))},
                  {arguments.output, arguments.coloured});
}

Arguments
parse(int argc, char** argv)
{
  Arguments arguments;
  CliqueFrame& frame = arguments.frame;
  ConfigParameters parameters = {
      {"voxel_size", "voxel size of the map [m]", &frame.voxel_size},
      {"map_origin", "map_origin X,Y,Z in summary.json of the map [m]",
       &frame.map_origin}};
  for (ConfigParameter& parameter : parametersOf(arguments.parameters))
    parameters.push_back(std::move(parameter));
  parameters.push_back(
      {"threads", "number of threads; 0 = all processors", &arguments.threads});
  const po::variables_map values = parseCommandLine(
      argc, argv, usage,
      {{"input", arguments.input, "input cloud"},
       {"output", arguments.output, "output cloud (.pcd)"},
       {"method", arguments.method,
        "method: planes[:EDGE], supervoxel[:SEED_DISTANCE], cubes[:EDGE], "
        "superpixel[:NUMBER] or slic[:NUMBER]; several, separated by commas, if the "
        "first have priority"},
       {"frame", frame.path,
        "organized cloud in the camera frame (.pcd), see pcl_semantic_stereo"},
       {"pose", frame.pose,
        "pose of the frame: 'x y z qx qy qz qw' in the world, or FILE:N = row N of a "
        "KITTI trajectory (default: VIEWPOINT of --frame)"},
       {"calibration", frame.calibration,
        "KITTI's calib.txt, if --pose is of camera 0 and --frame of camera 2"},
       {"scan-columns", arguments.scan_columns, kScanColumnsHelp},
       {"memory", arguments.memory, kMemoryHelp},
       {"coloured", arguments.coloured,
        "output cloud with one colour per clique, for pcl_viewer (.pcd)"}},
      {"input", "output"}, parameters);
  setParameters(values, parameters);
  const std::string& method = arguments.method;
  const bool superpixels = namesCliques(method, "superpixel");
  refuseUnread(values, {{!superpixels,
                         "with --method " + method,
                         {"frame", "pose", "calibration", "map-origin",
                          "superpixel-depth-jump"}},
                        {!superpixels && !namesCliques(method, "supervoxel"),
                         "with --method " + method,
                         {"voxel-size"}}});
  arguments.parameters.validate();
  // Only after the parsing: only supervoxels need voxels smaller than their seed
  // distance.
  arguments.parameters.supervoxel.voxel_resolution = frame.voxel_size;
  requireFittingOptions(arguments);
  return arguments;
}

Eigen::Isometry3d
poseOfRow(const std::string& text, const std::string& calibration)
{
  const std::size_t colon = text.rfind(':');
  const std::string path = text.substr(0, colon);
  const double row = parseNumber(text.substr(colon + 1), "--pose '" + text + "'");
  std::vector<std::string> doubts;
  const Trajectory trajectory = readKittiTrajectory(path, &doubts);
  warnOf(doubts);
  if (!(row >= 0.0 && row < double(trajectory.size())) || row != std::floor(row))
    fail<BadInputException>(path, ": has no pose ", row, ", but rows 0 to ",
                            double(trajectory.size()) - 1.0);
  Eigen::Isometry3d T_camera0_camera = Eigen::Isometry3d::Identity();
  if (!calibration.empty())
    T_camera0_camera =
        readKittiCalibration(calibration, KittiCameras::colour).T_camera0_camera;
  return worldFromFirstCamera() * trajectory[std::size_t(row)] * T_camera0_camera;
}

// Parses a pose: "x y z qx qy qz qw", the camera in the world, or FILE:N, row N of a
// KITTI trajectory (camera 0; with calib.txt converted to the left colour camera).
Eigen::Isometry3d
poseOf(const std::string& text, const std::string& calibration)
{
  if (text.find(':') != std::string::npos)
    return poseOfRow(text, calibration);
  const std::vector<double> numbers = parseNumbersOf("--pose", text);
  if (numbers.size() != 7)
    fail<InvalidParameterException>(
        "--pose has ", numbers.size(),
        " numbers, expected x y z qx qy qz qw, or a trajectory and its row: FILE:N");
  const Eigen::Quaterniond turn(numbers[6], numbers[3], numbers[4], numbers[5]);
  if (!(std::abs(turn.norm() - 1.0) <= 1e-2))
    fail<InvalidParameterException>("--pose has a quaternion of length ", turn.norm(),
                                    ", expected 1");
  const Eigen::Isometry3d pose(
      Eigen::Translation3d(numbers[0], numbers[1], numbers[2]) * turn.normalized());
  for (const std::string& doubt : doubtsOf({pose}, PoseFrame::sensor, true))
    warn("--pose: " + doubt);
  return pose;
}

// Sets the frame and the voxels of a map, one per point, in a generator.
void
setFrame(const CliqueFrame& frame, const std::string& name, const LabelledCloud& map,
         SuperpixelCliques& generator)
{
  generator.setVoxels({}, frame.voxel_size); // checks the size
  LabelledCloud read = readLabelledCloud(frame.path, &anyLabels());
  addOrigin(read);
  if (!read.has_colour)
    fail<BadInputException>(frame.path, ": superpixels need points with rgb or rgba",
                            textOfDoubts(read.table.doubts, frame.path));
  if (!read.cloud->isOrganized())
    fail<BadInputException>(frame.path, ": superpixels need an organized cloud");
  const auto cloud = std::make_shared<CliqueGenerator::Cloud>();
  pcl::copyPointCloud(*read.cloud, *cloud);
  Eigen::Isometry3d T_map_camera = frame.pose.empty()
                                       ? viewpointOf(read.table, frame.path)
                                       : poseOf(frame.pose, frame.calibration);
  T_map_camera.pretranslate(-frame.map_origin);
  std::vector<VoxelIndex> voxels;
  for (const pcl::PointXYZRGBL& point : *map.cloud) {
    const Eigen::Vector3d position = point.getVector3fMap().cast<double>() + map.origin;
    const bool is_near =
        (position.array().abs() < kMaxVoxelIndex * frame.voxel_size).all(); // not NaN
    if (pcl::isXYZFinite(point) && !is_near)
      fail<BadInputException>(name, ": point ", voxels.size(), " lies at ",
                              position.transpose(), " m, in no voxel");
    voxels.push_back(is_near ? voxelOf(quantize(position, frame.voxel_size))
                             : VoxelIndex::Constant(kMaxVoxelIndex));
  }
  generator.setVoxels(voxels, frame.voxel_size);
  generator.setFrame(cloud, T_map_camera);
}

// Successive numbers get different colours; points outside cliques are dark.
void
colourCliques(const std::vector<pcl::PointIndices>& cliques,
              CliqueGenerator::Cloud& cloud)
{
  for (pcl::PointXYZRGB& point : cloud)
    point.r = point.g = point.b = 40;
  std::uint32_t turn = 0;
  for (const pcl::PointIndices& clique : cliques) {
    turn += 0x9E3779B9u; // golden angle
    const double hue = double(turn) / 4294967296.0 * 6.0;
    for (const pcl::index_t i : clique.indices) {
      const auto channel = [&](double offset) {
        const double position = std::fmod(hue + offset, 6.0);
        const double light = std::clamp(std::abs(position - 3.0) - 1.0, 0.0, 1.0);
        return std::uint8_t(60.0 + 195.0 * light);
      };
      pcl::PointXYZRGB& point = cloud[std::size_t(i)];
      point.r = channel(0.0);
      point.g = channel(4.0);
      point.b = channel(2.0);
    }
  }
}

// An estimate: points, table and neighbours of supervoxels.
constexpr CloudNeeds kNeeds{0.0, 600.0};

// Names the file in errors.
std::vector<pcl::PointIndices>
generate(const std::string& input, const LabelledCloud& read,
         CliqueGenerator& generator)
{
  try {
    return cliquesOf(read, generator);
  }
  catch (const BadInputException& error) { // the generator does not report the file
    fail<BadInputException>(input, ": ", error.what());
  }
}

std::size_t
countMembers(const std::vector<pcl::PointIndices>& cliques)
{
  std::size_t members = 0;
  for (const pcl::PointIndices& clique : cliques)
    members += clique.indices.size();
  return members;
}

// Numbers the cliques of a tile after those of the tiles before. A clique that the tile
// cuts has its points of the tile only.
std::vector<std::uint32_t>
numbersOf(const std::vector<pcl::PointIndices>& cliques, std::size_t points,
          std::size_t own, std::size_t before)
{
  std::vector<std::uint32_t> numbers(points, 0);
  std::size_t number = before;
  for (const pcl::PointIndices& clique : cliques) {
    if (countOwn(clique, own) == 0)
      continue;
    ++number;
    for (const pcl::index_t i : clique.indices)
      numbers[std::size_t(i)] = std::uint32_t(number);
  }
  return numbers;
}

// Groups the points of a binary .pcd tile by tile.
int
groupTiles(const Arguments& arguments, CliqueGenerator& generator, std::size_t memory)
{
  refuseIf(!arguments.coloured.empty() || !arguments.frame.path.empty(),
           "--coloured and --frame need the whole cloud in memory: a larger --memory");
  refuseIf(namesCliques(arguments.method, "slic"),
           "--method " + arguments.method +
               " needs the whole cloud in memory: a larger --memory");
  PcdReader reader(arguments.input);
  const CloudSurvey survey = surveyWithProgress(reader, &anyLabels(), true);
  if (generator.usesColour() && !survey.has_colour)
    fail<BadInputException>(arguments.input, ": this method needs rgb or rgba");
  TileOptions options;
  options.reach = 10.0 * survey.sample.spacing; // shows which cliques are cut
  options.most = pointsOfTile(kNeeds, reader.header().point_step, memory);
  const auto tiles = divideWithProgress(reader, survey, options, arguments.output);
  CloudRowWriter writer(arguments.output, reader.size());
  CliqueCounts counts;
  std::size_t members = 0;
  forEachTileOf(*tiles, "grouping", [&](CloudTile tile) {
    const std::size_t own = tile.numbers.size();
    LabelledCloud read =
        labelledCloudOf(std::move(tile.table), arguments.input, &anyLabels());
    setMeanPositions(read, generator);
    moveToVoxelCentres(read);
    const auto cliques = generate(arguments.input, read, generator);
    const std::vector<std::uint32_t> numbers =
        numbersOf(cliques, read.cloud->size(), own, counts.of_tile);
    read.table.setColumn("clique", numbers);
    const CliqueCounts found = countCliques(cliques, own);
    counts.of_tile += found.of_tile;
    counts.cut += found.cut;
    members += own - std::size_t(std::count(numbers.begin(),
                                            numbers.begin() + std::ptrdiff_t(own), 0u));
    writer.append(read.table, tile.numbers);
  });
  writer.write(reader.header());
  printResults({{"cliques", counts.of_tile},
                {"cliques_cut_by_tiles", counts.cut},
                {"members", members},
                {"points", reader.size()},
                {"cloud", arguments.output}});
  return exit_done;
}

int
group(const Arguments& arguments)
{
  const auto generator = makeCliqueGenerator(arguments.method, arguments.parameters);
  setNumberOfThreads(arguments.threads);
  const std::size_t memory = memoryOf(arguments.memory);
  const ScanColumns columns = parseScanColumns(arguments.scan_columns);
  if (columns.empty() && needsTiles(arguments.input, kNeeds, memory))
    return groupTiles(arguments, *generator, memory);
  LabelledCloud read = readLabelledCloud(arguments.input, &anyLabels(), columns);
  if (generator->usesColour() && !read.has_colour && !read.cloud->empty())
    fail<BadInputException>(arguments.input, ": this method needs rgb or rgba",
                            textOfDoubts(read.table.doubts, arguments.input));
  warnOf(read.table.doubts);
  warnOfNoReturns(arguments.input, countNoReturns(*read.cloud));
  if (read.cloud->empty())
    warn(arguments.input + ": no point is left");
  setMeanPositions(read, *generator);
  moveToVoxelCentres(read);
  for (const auto& each : generatorsOf(generator))
    if (auto* const superpixels = dynamic_cast<SuperpixelCliques*>(each.get()))
      setFrame(arguments.frame, arguments.input, read, *superpixels);
  read.cliques = generate(arguments.input, read, *generator);
  const std::size_t members = countMembers(read.cliques);
  if (members == 0 && !arguments.frame.path.empty() && !read.cloud->empty())
    fail<BadInputException>(arguments.frame.path, ": shows no voxel of ",
                            arguments.input,
                            "; do --pose, --map-origin and --voxel-size fit?");
  if (!arguments.coloured.empty()) {
    CliqueGenerator::Cloud cloud;
    pcl::copyPointCloud(*read.cloud, cloud);
    colourCliques(read.cliques, cloud);
    writeColourCloud(arguments.coloured, cloud, read.origin);
  }
  writeCliques(arguments.output, read);
  printResults({{"cliques", read.cliques.size()},
                {"members", members},
                {"points", read.cloud->size()},
                {"cloud", arguments.output}});
  return exit_done;
}

} // namespace

int
main(int argc, char** argv)
{
  return runWithImages(usage.name, [&] { return group(parse(argc, argv)); });
}
