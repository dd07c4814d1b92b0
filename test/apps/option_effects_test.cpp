// SPDX-License-Identifier: BSD-3-Clause

// Every option of every program, in every mode, changes the output or is refused with
// the option and the mode named. The options are those in `--help`; a new option needs
// a value here.

#include "support/bad_case.h"
#include "support/onnx_writer.h"
#include "support/own_camera.h"
#include "support/rgbd_street.h"
#include "support/served_program.h"

#include <pcl_semantic/files/cloud_file.h>

#include <opencv2/videoio.hpp>

#include <algorithm>
#include <iterator>
#include <map>
#include <regex>
#include <set>

namespace pcl_semantic {

namespace fs = std::filesystem;

namespace {

// A way to run a program. IN holds what inputs() makes, OUT is an empty folder. The
// command "fleet SEQUENCE --options" is a plan of one drive with the options of `map`.
struct Mode {
  std::string name; // its name in a refusal, or an option of the command
  std::string command;
  std::string only = ""; // of options: those whose names match; all of them elsewhere
};

void
PrintTo(const Mode& mode, std::ostream* stream)
{
  *stream << mode.command;
}

const std::string of_crf = "crf.*|clique.*|smoothness.*|appearance.*|colour.*|super.*";
// What depends on where frames and labels come from.
const std::string of_source =
    "left|right|calibration|extrinsics|times|strict|clouds|rgbd|depth-scale|sensor|"
    "scan-.*|labels|label-.*|network.*|model|poses|map-only|also|stereo|disparities|"
    "max-deviation|deviation-scale|min-hit-ratio";
const std::string small = " --voxel-size 0.25 --max-depth 12";
const std::string street_map =
    "map IN/street --labels IN/street/labels --output OUT/map" + small;
const std::string own_camera =
    "--left 'IN/own/left/*.png' --right 'IN/own/right/*.png' "
    "--calibration IN/own/stereo.yaml";

const std::vector<Mode> modes = {
    {"SEQUENCE", street_map},
    {"--crf none", street_map + " --crf none", of_crf},
    {"--crf pn-potts", street_map + " --crf pn-potts", of_crf},
    {"--crf hierarchical", street_map + " --crf hierarchical", of_crf},
    {"--network", "map IN/street --network IN/street/net.yaml --output OUT/map" + small,
     of_source},
    {"--left",
     "map " + own_camera +
         " --labels IN/own/labels --poses IN/own/poses.txt --output OUT/map" + small,
     of_source},
    {"--clouds",
     "map --clouds IN/clouds --poses IN/street/world.txt --output OUT/map" + small,
     of_source},
    {"--clouds",
     "map --clouds IN/clouds --calibration IN/street/calib.txt --poses "
     "IN/street/poses.txt --output OUT/map" +
         small,
     of_source},
    {"--rgbd",
     "map --rgbd IN/street/rgbd --calibration IN/street/camera.yaml --poses "
     "IN/street/world.txt --output OUT/map --labels IN/street/labels" +
         small,
     of_source},
    // One pair: which of several would be dropped is up to the moment.
    {"live", "live --left IN/left.avi --right IN/right.avi --calibration "
             "IN/own/stereo.yaml --labels IN/own/labels --poses IN/own/poses.txt "
             "--output OUT/map" +
                 small},
    {"drive 'a'",
     "fleet IN/street --labels IN/street/labels --frames 0:2 --submap-every 2" + small},
    {"info", "archive info IN/one.map"},
    {"verify", "archive verify IN/one.map"},
    {"export", "archive export IN/one.map OUT/map.pcd"},
    {"merge", "archive merge IN/one.map IN/two.map OUT/both.map"},
    {"changes", "archive changes IN/one.map IN/two.map OUT/changes.pcd"},
    {"planes", "cliques IN/map.pcd OUT/out.pcd --method planes"},
    {"cubes", "cliques IN/map.pcd OUT/out.pcd --method cubes"},
    {"supervoxel", "cliques IN/map.pcd OUT/out.pcd --method supervoxel"},
    {"superpixel", "cliques IN/map.pcd OUT/out.pcd --method superpixel --frame "
                   "IN/clouds/000000.pcd --pose IN/one/trajectory.txt:0"},
    {"slic", "cliques IN/clouds/000000.pcd OUT/out.pcd --method slic"},
    {"cloud", "cloud IN/map.pcd OUT/out.pcd" + of_kitti11 + "--drop car"},
    {"things", "things IN/map.pcd OUT/out.pcd --objects OUT/objects.json --boxes "
               "OUT/boxes.ply --planes OUT/planes.json --polygons OUT/polygons.ply"},
    {"--crf dense", "crf IN/map.pcd OUT/out.pcd"},
    {"--crf unary", "crf IN/map.pcd OUT/out.pcd --crf unary"},
    {"--crf pn-potts", "crf IN/map.pcd OUT/out.pcd --crf pn-potts --cliques cubes:1"},
    {"--crf hierarchical",
     "crf IN/map.pcd OUT/out.pcd --crf hierarchical --cliques cubes:1"},
    {"evaluate", "evaluate --prediction IN/one/labels --truth IN/gt" + of_kitti11},
    {"--panoptic",
     "evaluate --panoptic --prediction IN/objects --truth IN/true_objects" +
         of_kitti11},
    {".bt", "export IN/one.map OUT/map.bt"},
    {".ply", "export IN/one.map OUT/map.ply"},
    {".pgm", "export IN/one.map OUT/map.pgm"},
    {".bt", "export IN/one OUT/map.bt"},
    {".ply", "export IN/map.pcd OUT/map.ply"},
    {".pgm", "export IN/one OUT/map.pgm"},
    {"--crf dense",
     "image_crf IN/street/image_2/000000.png IN/street/labels/000000.bin "
     "OUT/labels.png"},
    {"--crf hierarchical", "image_crf IN/street/image_2/000000.png "
                           "IN/street/labels/000000.bin OUT/labels.png "
                           "--crf hierarchical --cliques slic"},
    {"SEQUENCE", "label IN/street --network IN/street/net.yaml --output OUT/labels"},
    {"--left",
     "label " + own_camera + " --network IN/street/net.yaml --output OUT/labels"},
    {"--clouds",
     "label --clouds IN/clouds --labels IN/street/labels --output OUT/labelled"},
    {"--clouds",
     "label --clouds IN/clouds --network IN/street/net.yaml --output OUT/labelled"},
    {"--clouds", "label --clouds IN/scans IN/street --labels IN/street/labels --output "
                 "OUT/labelled"},
    {"SEQUENCE", "odometry IN/street OUT/poses.txt"},
    {"--left", "odometry " + own_camera + " --output OUT/poses.txt"},
    {"render", "render IN/one OUT/map.png --size 320x200"},
    {"--view above", "render IN/one OUT/map.png --size 320x200 --view above"},
    {"--view camera", "render IN/one OUT/map.png --size 320x200 --view camera"},
    {"archive", "render IN/one.map OUT/map.png --size 320x200"},
    {"--from", "render IN/map.pcd OUT/map.png --size 320x200 --from 0,0,2 --look-at "
               "9,0,0"},
    {"--screenshot", "view IN/one --screenshot OUT/view.png --size 640x400"},
    {"rgbd", "rgbd IN/street/rgbd OUT/clouds --calibration IN/street/camera.yaml"},
    {"--intrinsics", "rgbd IN/street/rgbd OUT/clouds --intrinsics 120,120,104,32"},
    {"--rgbd", "odometry --rgbd IN/street/rgbd --calibration IN/street/camera.yaml "
               "OUT/poses.txt"},
    {"stereo", "stereo IN/street/image_2 IN/street/image_3 IN/street/calib.txt "
               "OUT/clouds"},
    {"a room", "synthesize OUT/room --scene room --frames 1 --size 104x78"},
    {"synthesize", "synthesize OUT/street --frames 1 --size 208x64"},
};

// One way to give an option: its value, and what else both runs are given.
struct Trial {
  std::string value;
  std::string with = "";
};

// What may change something, by option, or by program and option.
const std::map<std::string, std::vector<Trial>> trials = {
    {"also", {{"depth"}, {"scans"}, {"measured"}}},
    {"appearance-deviation", {{"0.7"}}},
    {"appearance-weight", {{"40"}}},
    {"archive", {{"OUT/own.map"}}},
    {"archive-every", {{"2"}, {"0", "--archive OUT/own.map"}}},
    {"below", {{"1"}}},
    {"box", {{"0,-5,-5,9,5,5"}}},
    {"calibration", {{"IN/street/calib.txt"}}},
    {"centres", {{""}}},
    {"class", {{"road"}}},
    {"clearing", {{"full", "--voxel-size 0.1 --hit-probability 0.55"}}},
    {"clique-appearance-weight", {{"30"}, {"30", "--clique-weight 9"}}},
    {"clique-free-label", {{"false"}, {"false", "--clique-weight 9"}}},
    {"clique-truncation", {{"0.9"}, {"0.9", "--clique-weight 9"}}},
    {"clique-start", {{"true"}, {"true", "--clique-weight 9"}}},
    {"clique-weight", {{"20"}}},
    {"cliques", {{"cubes:2"}}},
    {"clouds", {{"IN/clouds"}}},
    {"cloud colour", {{""}}},
    {"colour", {{"rgb"}}},
    {"colour-deviation", {{"60"}}},
    {"boxes", {{"OUT/more.ply"}}},
    {"coloured", {{"OUT/coloured.pcd"}}},
    {"compare", {{"IN/two.map"}, {"IN/two"}}},
    {"config", {{"IN/config.yaml"}, {"IN/unknown_key.yaml"}}},
    {"covered-by", {{"IN/one/labels"}, {"IN/objects"}}},
    {"crf", {{"unary"}, {"pn-potts", "--cliques cubes:1"}, {"none"}, {"pn-potts"}}},
    {"crf-every", {{"2"}}},
    {"crf-iterations", {{"7"}}},
    {"crf-sensor", {{"stereo"}, {"lidar"}, {"rgbd"}}},
    {"crf-keep-thin",
     {{"false"},
      {"false", "--smoothness-weight 900 --crf-iterations 5"},
      {"false", "--smoothness-weight 900 --crf-iterations 5 --label-set "
                "IN/other_set.yaml"},
      {"true", "--crf-iterations 5"}}},
    {"crf-logit-adjustment", {{"3"}, {"3", "--smoothness-weight 900"}}},
    {"crf-normalization", {{"none"}}},
    {"crf-temperature", {{"9"}, {"9", "--refined OUT/refined.bin"}}},
    {"crop", {{"0,-5,-5,9,5,5"}}},
    {"depth-scale", {{"700"}}},
    {"intrinsics", {{"130,130,100,30"}}},
    {"deviation-scale", {{"1"}}},
    {"disparities", {{"64"}}},
    {"disparity", {{"OUT/disparities"}, {"OUT/disparity.png"}}},
    {"drop", {{"road"}}},
    {"plane-area", {{"90"}}},
    {"plane-distance", {{"0.02"}}},
    {"plane-radius", {{"0.6"}}},
    {"planes", {{"OUT/more.json"}}},
    {"render planes", {{"IN/planes.json"}}},
    {"view planes", {{"IN/planes.json"}}},
    {"polygons", {{"OUT/more.ply"}}},
    {"print-config", {{""}}},
    {"extrinsics", {{"IN/own/extrinsics.yaml"}}},
    {"odometry features", {{"40"}}},
    {"files", {{"IN/two.map"}}},
    {"format", {{"ids"}, {"packed"}}},
    {"odometry format", {{"tum"}}},
    {"frame", {{"2"}}},
    {"cliques frame", {{"IN/clouds/000001.pcd"}}},
    {"frames", {{"1:2"}}},
    {"odometry frames", {{"0:2"}}},
    {"synthesize frames", {{"2"}}},
    {"scene", {{"room"}, {"street"}}},
    {"depth-noise", {{"0"}}},
    {"from", {{"0,0,4"}}},
    {"lens", {{"fisheye"}}},
    {"ground", {{"road"}}},
    {"ground-reach", {{"0.4"}}},
    {"gap", {{"0.3"}}},
    {"header", {{""}}},
    {"follow", {{""}}},
    {"hide", {{"road"}}},
    {"hit-probability", {{"0.55", "--voxel-size 0.1 --clearing full"}}},
    {"ignore", {{"road"}}},
    {"images", {{"IN/street"}}},
    {"intrinsics", {{"90,90,104,32"}}},
    {"keep", {{"road"}}},
    {"keys", {{"m"}}},
    {"label-calibration", {{"IN/calibration.yaml"}}},
    {"label-confidence",
     {{"0.5"},
      {"0.5", "--labels IN/street/gt"},
      {"0.5", "IN/labels.pcd"},
      {"0.5", "--clouds IN/labelled"},
      {"0.5", "--labels '{sequence}/gt'"}}},
    {"label-mapping",
     {{"IN/mapping.yaml"},
      {"IN/mapping.yaml", "--labels IN/street/gt"},
      {"IN/mapping.yaml", "--clouds IN/labelled"}}},
    {"label-noise", {{"1"}}},
    {"label-set",
     {{"IN/other_set.yaml"},
      {"IN/mast_set.yaml"},
      {"IN/street_set.yaml"},
      {"IN/mast_set.yaml", "--labels IN/street/gt"},
      {"IN/twelve_set.yaml"},
      {"IN/street_set.yaml", "--ground road"}}},
    {"labels", {{"IN/street/gt"}}},
    {"left", {{"'IN/own/left/*.png'"}}},
    {"look-at", {{"8,0,0"}}},
    {"map-only", {{""}}},
    {"map-origin", {{"0.5,0,0"}}},
    {"max-depth", {{"6"}}},
    {"max-deviation", {{"0.3"}, {"0.6"}}},
    {"max-height", {{"0.9"}}},
    {"method", {{"cubes"}}},
    {"min-height", {{"1.5"}}},
    {"min-hit-ratio", {{"0.9"}}},
    {"min-points", {{"1"}}},
    {"miss-probability", {{"0.1"}, {"0.1", "--voxel-size 0.1"}}},
    {"model", {{"IN/street/other.onnx"}}},
    {"network", {{"IN/street/other.yaml"}}},
    {"network-every", {{"2"}}},
    {"no-things", {{""}}},
    {"object-gap", {{"0.1"}}},
    {"object-min-voxels", {{"1"}, {"9999"}}},
    {"objects", {{"OUT/more.json"}}},
    {"render objects", {{"IN/objects.json"}}},
    {"occlusion-window", {{"15,15"}}},
    {"offset-drift", {{"0"}}},
    {"overlay", {{"OUT/overlay.png"}}},
    {"panoptic", {{""}}},
    {"pixel-fusion", {{"product"}}},
    {"pose", {{"IN/one/trajectory.txt:2"}}},
    {"poses", {{"IN/moved.txt"}}},
    {"range", {{"0:9", "--truth-depth IN/one/depth"}, {"0:9"}}},
    {"refined", {{"OUT/refined.bin"}}},
    {"relabel", {{"road=sidewalk"}}},
    {"report", {{"OUT/report.csv"}}},
    {"resume", {{""}, {"", "--archive OUT/own.map"}}},
    {"rgbd", {{"IN/street/rgbd"}}},
    {"right", {{"'IN/own/right/*.png'"}}},
    {"row", {{"street"}}},
    {"scan-columns", {{"x,y,z,_"}}},
    {"scans", {{"IN/scans"}}},
    {"scan-within", {{"1"}, {"1", "--also scans"}}},
    {"seed", {{"9"}}},
    {"sensor", {{"own"}, {"grey"}}},
    {"sensor-pose", {{"IN/sensor_pose.txt"}}},
    {"size", {{"280x160"}}},
    {"smoothness-deviation", {{"0.9"}}},
    {"smoothness-weight", {{"60"}}},
    {"stereo", {{"elas"}}},
    {"strict",
     {{""},
      {"", "--right IN/twin.avi"},
      {"", "IN/halved"},
      {"", "--left 'IN/halved/image_2/*.png' --right 'IN/halved/image_3/*.png' "
           "--calibration IN/halved/calib.txt"},
      {"", "--left 'IN/halved/image_2/*.png' --right 'IN/halved/image_3/*.png' "
           "--calibration IN/halved/calib.txt --labels IN/street/labels --poses "
           "IN/street/poses.txt"},
      {"", "IN/street/image_2 IN/street/image_3 IN/halved/calib.txt"}}},
    {"submap-every", {{"2"}, {"1"}}},
    {"superpixel-depth-jump",
     {{"0"},
      {"0", "--cliques superpixel:20"},
      {"0", "--cliques superpixel:20 --clique-weight 9"}}},
    {"every-frame", {{""}}},
    {"thin", {{"1"}}},
    {"things", {{"", "--label-set IN/no_things.yaml"}}},
    {"times",
     {{"IN/times.txt"},
      {"IN/times.txt", "--poses IN/timed.txt"},
      {"IN/times.txt", "--poses IN/timed_world.txt"},
      {"IN/times.txt", "--poses IN/timed_street.txt"}}},
    {"traffic", {{"2"}}},
    {"trajectory", {{"IN/moved.txt"}}},
    {"truth", {{"IN/one/labels"}}},
    {"truth-depth", {{"IN/one/depth", "--range 0:9"}, {"IN/one/depth"}}},
    {"view", {{"above"}}},
    {"view objects", {{"IN/objects.json"}}},
    {"voxel-size", {{"0.2"}, {"0.5"}}},
    {"window", {{"8,8,4"}}},
};

// Options that change no result here. `threads` gives the same bytes for any number,
// `engine` the same labels; `help` and its like are tested elsewhere, the others need a
// window, never end, or more frames than there are. Of clouds and of a fleet, which has
// no images of frames, `crf-every` costs time alone.
const std::set<std::string> unseen = {
    "help", "help-all", "version", "man", "quiet", "verbose", "json", "threads",
    "memory", "engine", "depth-within", "pose-gap", "view", "live view",
    "odometry window", "--clouds crf-every",
    // One frame contradicts no other, and has nothing thin that is outvoted.
    "live crf-every", "live clearing", "live hit-probability", "live miss-probability",
    "live deviation-scale", "live crf-keep-thin", "drive 'a' crf-every"};

// Those that are given by their place are in the commands.
const std::set<std::string> positional = {"sequence", "sequences",    "input", "output",
                                          "command",  "files",        "map",   "plan",
                                          "image",    "distributions"};

// A command with other values of options, and other words that are no options.
std::string
changed(const std::string& command, const std::string& with)
{
  std::vector<std::string> words = shellWords(command);
  std::size_t place = 1; // of the next word that is no option
  const std::vector<std::string> changes = shellWords(with);
  for (std::size_t i = 0; i < changes.size(); ++i) {
    if (changes[i].rfind("--", 0) == 0) {
      auto at = std::find(words.begin(), words.end(), changes[i]);
      if (at == words.end())
        at = words.insert(words.end(), {changes[i], ""});
      *std::next(at) = changes[++i];
      continue;
    }
    while (place < words.size() && words[place].rfind("--", 0) == 0)
      place += 2;
    if (place >= words.size())
      return "";
    words[place++] = changes[i];
  }
  std::string text;
  for (const std::string& word : words)
    text += word + " ";
  return text;
}

// The numbers of labels, each mapped to another class.
const std::string mapping = "classes: {road: [1, 2], building: [3], car: [4, 5], sign: "
                            "[6, 7, 8, 9, 10, 11, 0]}\n";

void
run(const std::string& folder, std::string command)
{
  command = replaceAll(command, "IN/", folder + "/");
  succeed(command);
}

// Of one image.
void
writeVideo(const std::string& path, const std::string& image)
{
  const cv::Mat frame = readPng(image, ImageKind::grey_or_colour);
  cv::VideoWriter writer(path, cv::CAP_FFMPEG,
                         cv::VideoWriter::fourcc('F', 'F', 'V', '1'), 5.0,
                         frame.size());
  ASSERT_TRUE(writer.isOpened());
  writer << frame;
}

void
dropProbabilities(const std::string& from, const std::string& to)
{
  PcdTable table = readCloudTable(from);
  table.removeColumns("probability");
  writeCloudTable(to, table);
}

// A TUM trajectory whose frames are half a second apart.
void
writeTimed(const std::string& path, const Trajectory& poses)
{
  std::vector<TimedPose> timed;
  for (const Eigen::Isometry3d& pose : poses)
    timed.push_back({0.5 * double(timed.size()), pose});
  writeTumTrajectory(path, timed);
}

void
writeScans(const std::string& folder)
{
  fs::create_directories(folder);
  for (const char* const name : {"/000000.bin", "/000001.bin", "/000002.bin"}) {
    std::ofstream file(folder + name, std::ios::binary);
    for (int i = 0; i < 600; ++i) {
      const float point[] = {4.0f + 0.01f * float(i), 0.2f * float(i % 40) - 4.0f,
                             0.1f * float(i % 17) - 1.6f, 0.5f};
      file.write(reinterpret_cast<const char*>(point), sizeof(point));
    }
  }
}

// Labels of a scan that writeScans() makes: a car, then road.
void
writeObjects(const std::string& folder, int points_of_car)
{
  fs::create_directories(folder);
  std::ofstream file(folder + "/000000.label", std::ios::binary);
  for (int i = 0; i < 600; ++i) {
    const std::uint32_t number = i < points_of_car ? 6 | 1u << 16 : 3;
    file.write(reinterpret_cast<const char*>(&number), sizeof(number));
  }
}

// Makes the inputs of the commands in `modes` and `trials`, named IN there.
void
makeInputs(const std::string& in)
{
  const std::string street = in + "/street";
  copyStreet(street);
  makeRgbd(street);
  writeOwnCamera(in + "/own");
  for (const auto& [name, side] :
       {std::pair("left", "left"), {"right", "right"}, {"twin", "left"}})
    writeVideo(in + "/" + name + ".avi", in + "/own/" + side + "/shot9.png");
  copyStreet(in + "/halved");
  halveCamera(in + "/halved/calib.txt");
  const auto write = [&](const std::string& name, const std::string& text) {
    std::ofstream(in + "/" + name, std::ios::binary) << text;
  };
  const std::string set = bytesOf(kitti11);
  write("other_set.yaml", replaceAll(set, "[128, 64, 128]", "[1, 64, 128]"));
  write("mapping.yaml", mapping);
  write("config.yaml", "crf_temperature: 9\nsmoothness_weight: 60\n");
  write("no_things.yaml", replaceAll(set, ", thing: true", ""));
  write("mast_set.yaml", replaceAll(set, "pole", "mast"));
  write("twelve_set.yaml", set + "  - {name: bridge, colour: [9, 9, 9]}\n");
  write("unknown_key.yaml", "speed: 3\n");
  write("street_set.yaml", replaceAll(set, "name: road", "name: street"));
  write("times.txt", "0\n0.5\n1\n");
  write("sensor_pose.txt", "0 -1 0 1 0 0 -1 0 1 0 0 0\n");
  for (const auto& [name, bias] : {std::pair("net", 0.1f), std::pair("other", 2.0f)}) {
    PointwiseNetwork network;
    network.channels = 4;
    network.weights = {2, -1, 0.5f, -2, 1, 1, 0.25f, 0.5f, -3, 1, 1, 1};
    network.bias = {bias, -0.2f, 0.3f, -5.0f};
    write("street/" + std::string(name) + ".onnx", network.file());
    write("street/" + std::string(name) + ".yaml",
          smallNetworkYaml(std::string(name) + ".onnx", "road, pole, building, '-'"));
  }
  fs::copy(street + "/gt", in + "/gt");
  fs::remove(in + "/gt/000002.png");
  writeScans(in + "/scans");
  writeObjects(in + "/objects", 250);
  writeObjects(in + "/true_objects", 300);
  Trajectory moved;
  for (Eigen::Isometry3d pose : readKittiTrajectory(street + "/poses.txt")) {
    pose.translation().x() += 1.0;
    moved.push_back(pose);
  }
  writeKittiTrajectory(in + "/moved.txt", moved);
  writeTimed(in + "/timed.txt", readKittiTrajectory(in + "/own/poses.txt"));
  writeTimed(in + "/timed_world.txt", readKittiTrajectory(street + "/world.txt"));
  writeTimed(in + "/timed_street.txt", readKittiTrajectory(street + "/poses.txt"));
  write("own/extrinsics.yaml", "R: [1, 0, 0, 0, 1, 0, 0, 0, 1]\nT: [-1, 0, 0]\n");
  for (const char* const command :
       {"stereo IN/street/image_2 IN/street/image_3 IN/street/calib.txt IN/depth",
        "label --clouds IN/depth --labels IN/street/labels --output IN/clouds",
        "map IN/street --labels IN/street/labels --output IN/one --voxel-size 0.25 "
        "--max-depth 12 --also depth --frames 0:2 --archive IN/one.map",
        "map IN/street --labels IN/street/labels --output IN/two --voxel-size 0.25 "
        "--max-depth 12 --frames 2:3 --archive IN/two.map"})
    run(in, command);
  fs::copy(in + "/one/map.pcd", in + "/map.pcd");
  run(in, "things IN/map.pcd IN/things.pcd --objects IN/objects.json --planes "
          "IN/planes.json --label-set "
          "IN/one/label_set.yaml --min-points 1");
  writeScans(street + "/velodyne");
  fs::create_directories(in + "/labelled");
  for (const char* const name : {"000000.pcd", "000001.pcd", "000002.pcd"})
    dropProbabilities(in + "/clouds/" + name, in + "/labelled/" + name);
  dropProbabilities(in + "/map.pcd", in + "/labels.pcd");
  std::ofstream(in + "/calibration.yaml")
      << "sharpness: 0.5\nground: [road]\nknots:\n  height: [0, 2]\nclasses:\n"
         "  road:\n    height: [1, -1]\n  building:\n    bias: 0.5\n";
}

const std::string&
inputs()
{
  static const TemporaryFolder folder;
  static const std::string path = [] {
    makeInputs(folder.path());
    return folder.path();
  }();
  return path;
}

struct Option {
  std::string name;
  bool takes_value = false;
};

std::vector<Option>
optionsOf(const std::string& program)
{
  std::vector<Option> options;
  std::istringstream lines(succeed(program + " --help-all"));
  for (std::string line; std::getline(lines, line);) {
    static const std::regex pattern("^  (-. \\[ )?--([a-z0-9-]+)( \\])?( [^ ]+)?.*");
    std::smatch match;
    if (std::regex_match(line, match, pattern))
      options.push_back({match[2], match[4].matched});
  }
  return options;
}

// Result of a command: its messages and files.
struct Outcome {
  int code = 0;
  std::string text;
  std::map<std::string, std::string> files;

  bool
  operator==(const Outcome& other) const
  {
    return code == other.code && text == other.text && files == other.files;
  }
};

// What tells of the run but is no result of it: the parameters and times of a summary.
bool
isRecord(const fs::path& path)
{
  static const std::set<fs::path> names = {"summary.json", "log.csv", "plan.yaml"};
  return names.count(path.filename()) > 0 || path.extension() == ".map" ||
         path.extension() == ".made";
}

// The plan of a drive that the words of a command describe.
std::string
planOf(const std::vector<std::string>& words)
{
  std::string plan = "output: city\ndrives:\n  - name: a\n    sequence: " + words[1];
  for (std::size_t i = 2; i < words.size(); ++i) {
    const bool has_value = i + 1 < words.size() && words[i + 1].rfind("--", 0) != 0;
    plan += "\n    " + replaceAll(words[i].substr(2), "-", "_") + ": '";
    plan += (has_value ? words[++i] : "true") + "'";
  }
  return plan + "\n";
}

// Tiles tell how they were made, too: their voxels are the result.
ToolResult
runFleet(const std::string& folder, const std::string& command)
{
  const std::string plan = folder + "/plan.yaml";
  std::ofstream(plan) << planOf(shellWords(command));
  const ToolResult result = runServed("fleet " + plan);
  if (result.code == 0)
    runServed("archive export " + folder + "/city/map.tiles " + folder + "/city.pcd");
  return result;
}

Outcome
outcomeOf(std::string command)
{
  const TemporaryFolder folder;
  command = replaceAll(command, "IN/", inputs() + "/");
  command = replaceAll(command, "OUT/", folder.path() + "/");
  const ToolResult result = command.rfind("fleet ", 0) == 0
                                ? runFleet(folder.path(), command)
                                : runServed(command);
  Outcome outcome;
  outcome.code = result.code;
  static const std::regex seconds(
      "[0-9.]+ (s|ms|Hz|frames/s)\\b|latency_[a-z0-9]+: [0-9.e-]+");
  outcome.text =
      std::regex_replace(replaceAll(result.text, folder.path(), "OUT"), seconds, "T");
  for (const fs::directory_entry& entry :
       fs::recursive_directory_iterator(folder.path()))
    if (entry.is_regular_file())
      outcome.files[fs::relative(entry.path(), folder.path())] =
          isRecord(entry.path()) ? "" : bytesOf(entry.path().string());
  return outcome;
}

class OptionEffects : public testing::TestWithParam<Mode> {
protected:
  const Outcome&
  plain(const std::string& with)
  {
    const auto known = plain_.find(with);
    if (known != plain_.end())
      return known->second;
    return plain_[with] = outcomeOf(changed(GetParam().command, with));
  }

  // Whether a line refuses an option for what else the command asks for.
  bool
  isRefusal(const Outcome& outcome, const std::string& option)
  {
    const std::string line = outcome.text.substr(0, outcome.text.find(" (see "));
    const bool is_named =
        line.find(option) != std::string::npos ||
        line.find(replaceAll(option, "-", " ")) != std::string::npos ||
        line.find(replaceAll(option, "-", "_")) != std::string::npos;
    if (is_named && holds(line, "is no option of a drive"))
      return true;
    if (outcome.code != 2 || !is_named)
      return false;
    const std::string rest = replaceAll(line, "--" + option, "");
    for (const char* const word :
         {"no effect", "are for", "archive", "SEQUENCE", " --"})
      if (rest.find(word) != std::string::npos)
        return true;
    return rest.find(GetParam().name) != std::string::npos;
  }

  // Of two runs that differ in an option at least one has to come to its end.
  bool
  isEffect(const Outcome& outcome, const Outcome& without)
  {
    return outcome.code == 0 ? !(outcome == without)
                             : outcome.code != 2 && without.code == 0;
  }

  std::map<std::string, Outcome> plain_;
};

const std::vector<Trial>&
trialsOf(const std::string& program, const std::string& option)
{
  static const std::vector<Trial> none;
  auto found = trials.find(program + " " + option);
  if (found == trials.end())
    found = trials.find(option);
  return found == trials.end() ? none : found->second;
}

TEST_P(OptionEffects, OrARefusal)
{
  const std::string command = GetParam().command;
  if (command.rfind("view ", 0) == 0 &&
      !fs::exists(PCL_SEMANTIC_BINARY_DIR "/bin/pcl_semantic_view"))
    GTEST_SKIP() << "the viewer was left out";
  const std::string program = command.substr(0, command.find(' '));
  ASSERT_EQ(plain("").code, 0) << plain("").text;

  for (const Option& option : optionsOf(program == "fleet" ? "map" : program)) {
    if (unseen.count(program + " " + option.name) > 0 ||
        unseen.count(GetParam().name + " " + option.name) > 0 ||
        (unseen.count(option.name) > 0 && !(program != "map" && option.name == "view")))
      continue;
    if (!GetParam().only.empty() &&
        !std::regex_match(option.name, std::regex(GetParam().only)))
      continue;
    if (positional.count(option.name) > 0 ||
        (command + " ").find(" --" + option.name + " ") != std::string::npos)
      continue;
    const std::vector<Trial>& all = trialsOf(program, option.name);
    EXPECT_FALSE(all.empty()) << program << " --" << option.name
                              << " is new: give it a value in `trials`";
    bool is_good = false;
    std::string seen;
    for (const Trial& trial : all) {
      const std::string other = changed(command, trial.with);
      if (other.empty())
        continue;
      const Outcome outcome =
          outcomeOf(other + " --" + option.name + " " + trial.value);
      is_good = isRefusal(outcome, option.name) || isEffect(outcome, plain(trial.with));
      seen += "\n  exit code " + std::to_string(outcome.code) + ": " + outcome.text;
      if (is_good)
        break;
    }
    EXPECT_TRUE(is_good || all.empty())
        << command << ": --" << option.name
        << " neither changes anything nor is refused:" << seen;
  }
}

INSTANTIATE_TEST_SUITE_P(Programs, OptionEffects, testing::ValuesIn(modes));

} // namespace

} // namespace pcl_semantic
