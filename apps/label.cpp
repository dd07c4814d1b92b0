// SPDX-License-Identifier: BSD-3-Clause
#include "cloud_doubts.h"
#include "files/file_pattern.h"
#include "image_tool.h"
#include "messages.h"
#include "network_trial.h"
#include "sequence_options.h"

#include <pcl_semantic/core/camera_doubts.h>
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/no_return.h>
#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/dataset/camera_images.h>
#include <pcl_semantic/dataset/cloud_sequence.h>
#include <pcl_semantic/dataset/kitti_sequence.h>
#include <pcl_semantic/dataset/rgbd_sequence.h>
#include <pcl_semantic/dataset/undistorter.h>
#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/files/cloud_file.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/files/label_set_file.h>
#include <pcl_semantic/files/trajectory_file.h>
#include <pcl_semantic/images/distribution_file.h>
#include <pcl_semantic/images/image_file.h>
#include <pcl_semantic/labelling/carried_labels.h>
#include <pcl_semantic/labelling/network_predictor.h>
#include <pcl_semantic/labelling/stored_predictor.h>
#include <pcl_semantic/labelling/visible_points.h>
#include <pcl_semantic/stereo/disparity_to_cloud.h>

#include <pcl/common/io.h>
#include <pcl/common/point_tests.h>

#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <string>

namespace {

namespace fs = std::filesystem;
using namespace pcl_semantic;
using namespace pcl_semantic::tool;

const Usage usage{
    "pcl_semantic_label",
    R"((SEQUENCE | --left 'L*.png' --right 'R*.png' --calibration FILE.yaml)
  --network FILE.yaml --output DIR [options]
or (--images 'I*.png' | --rgbd DIR) --network FILE.yaml --output DIR [options]
or --clouds (DIR | CLOUD.pcd) (--network FILE.yaml | --labels (DIR | FILE))
  --output (DIR | OUT.pcd) [options]
or --clouds DIR (SEQUENCE | --left 'I*.png' --calibration CAMERA.yaml
  --sensor-pose FILE) (--network FILE.yaml | --labels DIR) --output DIR [options])",
    R"(Runs a segmentation network on the left images, or those of one camera, and stores the
label distributions of their pixels for pcl_semantic_map --labels. With --clouds it
labels clouds instead: organized clouds by their pixels, clouds of a laser scanner by
the camera images that show their points.)",
    R"(pcl_semantic_synthesize /tmp/street && \
  pcl_semantic_stereo /tmp/street/image_2 /tmp/street/image_3 /tmp/street/calib.txt \
    /tmp/street_clouds && \
  pcl_semantic_label --clouds /tmp/street_clouds --labels /tmp/street/labels \
    --output /tmp/street_labelled)",
    {{"clouds GLOB", "clouds to label, instead of images"},
     {"images GLOB", "images of one camera; --rgbd DIR: of an RGB-D sequence"},
     {"network FILE", "network description (.yaml)"},
     {"model FILE", "network (.onnx; default: the file that its description names)"},
     {"labels DIR", "label images or distributions instead of a network"},
     {"left GLOB, --right GLOB", "images of any camera, instead of SEQUENCE"},
     {"calibration FILE", "calibration of the cameras"},
     {"sensor-pose FILE", "pose of the clouds' sensor in the camera"},
     {"output DIR", "folder of the distributions, or of the labelled clouds"},
     {"frames A:B", "frames with numbers A <= n < B"}}};

struct Arguments {
  SequenceFiles sequence;
  std::string images;      ///< of one camera, instead of the sequence
  RgbdFiles rgbd;          ///< its folder, instead of the sequence
  std::string clouds;      ///< to label: organized, or visible in the sequence's images
  std::string sensor_pose; ///< of the clouds' sensor in the camera; empty = KITTI's Tr
  double max_depth = 0.0;  ///< of points labelled by images [m]; 0 = unlimited
  std::string occlusion_window = "3,7"; ///< half columns, half rows [px]
  std::string output, network, model, engine, labels, label_set, label_mapping;
  std::string scan_columns; ///< of `.bin` clouds
  std::string frames = ":";
  std::string format = "float32";
  double label_confidence = 0.8; ///< of a stored `.png`
  int threads = 0;

  /** \brief Whether the clouds are labelled by a camera's images. */
  bool
  carries() const
  {
    return !clouds.empty() &&
           (!sequence.folder.empty() || !sequence.files.left.empty());
  }

  /** \brief Whether single images are labelled, not the left ones of pairs. */
  bool
  hasSingleImages() const
  {
    return !images.empty() || !rgbd.folder.empty();
  }
};

void
requireSequenceAndNetwork(const Arguments& arguments)
{
  if (arguments.hasSingleImages())
    refuseIf(!arguments.sequence.folder.empty() ||
                 (!arguments.images.empty() && !arguments.rgbd.folder.empty()),
             "--images, --rgbd and a SEQUENCE exclude each other");
  else
    asUsage([&] { arguments.sequence.validate(); });
  refuseIf(arguments.output.empty(), "--output is missing");
  refuseIf(arguments.network.empty(), "--network is missing");
  const std::string& format = arguments.format;
  refuseIf(format != "float32" && format != "float16" && format != "packed" &&
               format != "ids",
           "--format is '" + format + "', expected float32, float16, packed or ids");
}

void
requireClouds(const Arguments& arguments)
{
  const ImagePairFiles& files = arguments.sequence.files;
  refuseIf(arguments.carries() && !arguments.sequence.folder.empty() &&
               arguments.sequence.hasFiles(),
           "both a SEQUENCE and --left, --calibration or --times");
  refuseIf(!files.left.empty() &&
               files.calibration.empty() == arguments.rgbd.intrinsics.empty(),
           "--left needs --calibration or --intrinsics, its camera");
  if (!arguments.rgbd.intrinsics.empty())
    asUsage([&] { pinholeCameraOf("", arguments.rgbd.intrinsics); });
  refuseIf(!files.left.empty() && arguments.sensor_pose.empty(),
           "--left needs --sensor-pose, where the scanner is");
  refuseIf(arguments.output.empty(), "--output is missing");
  refuseIf(arguments.labels.empty() == arguments.network.empty(),
           "expected either --labels or --network");
  refuseIf(!arguments.model.empty() && arguments.network.empty(),
           "--model needs --network");
  refuseIf(!arguments.label_mapping.empty() && arguments.labels.empty(),
           "--label-mapping is for --labels");
  refuseIf(!arguments.label_set.empty() && arguments.labels.empty(),
           "--label-set is for --labels; the description of a network names its own");
  refuseIf(!(arguments.max_depth >= 0.0), "--max-depth is less than 0");
}

// Options without effect for the kind of clouds or the source of labels.
std::vector<UnreadOptions>
unreadOptions(const Arguments& arguments)
{
  const bool clouds = !arguments.clouds.empty(), carries = arguments.carries();
  return {{arguments.hasSingleImages(),
           "with --images or --rgbd",
           {"left", "right", "extrinsics", "strict", "clouds"}},
          {arguments.rgbd.folder.empty(), "without --rgbd", {"depth-within"}},
          {!clouds || arguments.sequence.files.left.empty(),
           "without --clouds and --left",
           {"intrinsics"}},
          {!clouds,
           "without --clouds",
           {"labels", "label-set", "label-mapping", "scan-columns", "sensor-pose",
            "max-depth", "occlusion-window"}},
          {clouds,
           "with --clouds, which need one camera and become .pcd",
           {"right", "extrinsics", "strict", "format"}},
          {clouds && !carries,
           "with --clouds that have no SEQUENCE or --left",
           {"calibration", "sensor-pose", "max-depth", "occlusion-window"}},
          {!arguments.network.empty() || !clouds,
           "with --network",
           {"label-confidence", "label-mapping", "label-set"}},
          {true, "on labels, which belong to frame numbers", {"times"}},
          unreadOptionsOfLabels(arguments.labels)};
}

Arguments
parse(int argc, char** argv)
{
  Arguments arguments;
  const po::variables_map values = parseCommandLine(
      argc, argv, usage,
      withSequence(
          arguments.sequence,
          {{"clouds", arguments.clouds,
            "clouds to label, one per frame: a .pcd, a folder or a pattern in quotes; "
            "organized clouds of pcl_semantic_stereo or, with SEQUENCE or --left, "
            "clouds of a laser scanner"},
           {"images", arguments.images,
            "images of one camera to label: folder or pattern in quotes; files are "
            "named by their numbers, or counted from 0 if they have none"},
           {"rgbd", arguments.rgbd.folder,
            "RGB-D sequence whose colour images are labelled: TUM's layout, or a "
            "folder with rgb/ and depth/"},
           {"depth-within", withDefault(arguments.rgbd.depth_within),
            "maximum difference between the times of a colour image and its depth "
            "image in TUM's layout [s]; as for pcl_semantic_map"},
           {"intrinsics", arguments.rgbd.intrinsics,
            "intrinsics fx,fy,cx,cy of --left instead of --calibration [px]"},
           {"sensor-pose", arguments.sensor_pose,
            "pose of the scanner in the camera frame (x right, y down, z forward): a "
            "file with one line, the upper 3 x 4 of its matrix (default: Tr in "
            "SEQUENCE's calib.txt)"},
           {"output,o", arguments.output,
            "output folder; for one cloud the output cloud (.pcd)"},
           {"network", arguments.network, "network description (.yaml)"},
           {"model", arguments.model,
            "network (.onnx; default: the file that its description names)"},
           {"engine", arguments.engine, kEngineHelp},
           {"labels", arguments.labels,
            "stored label distributions for --clouds: folder with one .bin, .npy, "
            ".npy.zst or .png per frame, or one file"},
           {"label-set", arguments.label_set,
            "label set of --labels (default: label_sets/kitti11.yaml)"},
           {"label-mapping", arguments.label_mapping, kPixelMappingHelp},
           {"scan-columns", arguments.scan_columns, kScanColumnsHelp},
           {"frames", arguments.frames,
            "A:B = frames with numbers A <= n < B; default: all"},
           {"format", withDefault(arguments.format),
            "output format of images: float32, float16 (.npy, half the size), packed "
            "(.npy.zst, rounded to 1/255 and compressed) or ids (.png, most probable "
            "class)"},
           {"max-depth", withDefault(arguments.max_depth),
            "maximum depth of a point that gets a label of an image [m]; 0 = "
            "unlimited"},
           {"occlusion-window", withDefault(arguments.occlusion_window),
            "half width and height COLUMNS,ROWS of the window in which nearer points "
            "hide a point [px]; it must cover the gaps between beams in the image"},
           {"label-confidence", withDefault(arguments.label_confidence),
            "probability of the class in a .png of --labels"},
           {"threads", withDefault(arguments.threads),
            "number of threads; 0 = all processors"}}),
      {"sequence"});
  refuseUnread(values, unreadOptions(arguments));
  asUsage([&] { requireEngine(arguments.engine, arguments.network); });
  if (arguments.clouds.empty())
    requireSequenceAndNetwork(arguments);
  else
    requireClouds(arguments);
  return arguments;
}

Eigen::Isometry3d
readSensorPose(const std::string& path)
{
  std::vector<std::string> doubts;
  const Trajectory poses = readKittiTrajectory(path, &doubts);
  if (poses.size() != 1)
    fail<BadInputException>(path, ": holds ", poses.size(), " poses, expected one");
  warnOf(doubts);
  return poses.front();
}

// Labels a scanner's clouds by a camera's images.
class LabelCarrier {
public:
  // Uses the images of a folder in KITTI's layout, or those of one camera: `left` and
  // its camera as `calibration` or intrinsics. Labels may be stored. Without a file the
  // scanner's pose in the camera is the sequence's.
  LabelCarrier(const SequenceFiles& images, const std::string& intrinsics,
               const std::string& sensor_pose, const VisibilityParameters& visibility,
               bool stored)
      : visibility_(visibility)
  {
    visibility.validate();
    if (!images.files.left.empty()) {
      const PinholeCamera camera =
          pinholeCameraOf(images.files.calibration, intrinsics);
      warnOf(camera.doubts);
      if (camera.isDistorted() && stored)
        warn("--labels have to be of the undistorted images; pcl_semantic_label "
             "--images --calibration stores these");
      images_.emplace(images.files.left, camera);
    }
    else {
      const KittiSequence kitti(images.folder);
      std::map<int, std::string> paths;
      for (std::size_t i = 0; i < kitti.size(); ++i)
        paths[kitti.frameNumber(i)] = kitti.leftPath(i);
      images_.emplace(std::move(paths), kitti.camera(), images.folder);
      if (sensor_pose.empty())
        T_camera_sensor_ =
            kitti.T_camera0_camera().inverse() * kitti.T_camera0_velodyne();
    }
    warnOf(doubtsOf(images_->camera()));
    if (!sensor_pose.empty())
      T_camera_sensor_ = readSensorPose(sensor_pose);
    const double distance = T_camera_sensor_.translation().norm();
    if (distance > 10.0)
      warn("the scanner is " + shown(distance) +
           " m away from the camera: is its pose in metres?");
  }

  // \a cloud is the path of the frame's cloud, for the message.
  void
  requireImage(const std::string& cloud, int frame) const
  {
    if (!images_->has(frame))
      fail<BadInputException>(cloud, ": the camera has no image of frame ", frame);
  }

  // Class distributions of a frame's points; invisible points are unlabelled.
  LabelDistributions
  label(const pcl::PointCloud<pcl::PointXYZRGBL>& cloud, int frame,
        LabelPredictor& predictor) const
  {
    return carryLabels(predictor.predict(images_->image(frame), frame),
                       images_->camera(),
                       seenPoints(pointsInCamera(cloud, T_camera_sensor_),
                                  images_->camera(), visibility_));
  }

private:
  VisibilityParameters visibility_;
  Eigen::Isometry3d T_camera_sensor_ = Eigen::Isometry3d::Identity();
  std::optional<CameraImages> images_; // of the camera
};

// One file of labels for one cloud.
class FilePredictor : public LabelPredictor {
public:
  FilePredictor(std::string path, int classes, float confidence, PixelMapping mapping)
      : path_(std::move(path)), classes_(classes), confidence_(confidence),
        mapping_(std::move(mapping))
  {}

  LabelDistributions
  predict(const cv::Mat& image, int /*frame*/) override
  {
    return readDistributions(path_, image.cols, image.rows, classes_, confidence_,
                             mapping_);
  }

private:
  std::string path_;
  int classes_;
  float confidence_;
  PixelMapping mapping_;
};

bool
isFolder(const std::string& path)
{
  std::error_code error;
  return fs::is_directory(path, error);
}

// \param[out] watch counts missing numbers of --labels
std::unique_ptr<LabelPredictor>
makePredictor(const Arguments& arguments, MappingWatch& watch)
{
  if (!arguments.network.empty())
    return openTriedNetwork(arguments.network, arguments.model, arguments.engine)
        .predictor;
  const LabelSet label_set = readLabelSetOrDefault(arguments.label_set);
  const int classes = label_set.size();
  PixelMapping mapping = readPixelMapping(arguments.label_mapping, label_set);
  watch = MappingWatch(arguments.label_mapping, mapping, "pixels");
  const auto confidence = float(arguments.label_confidence);
  if (arguments.carries() || isFolder(arguments.labels) ||
      fs::path(arguments.clouds).extension() != ".pcd")
    return std::make_unique<StoredPredictor>(arguments.labels, classes, confidence,
                                             std::move(mapping));
  return std::make_unique<FilePredictor>(arguments.labels, classes, confidence,
                                         std::move(mapping));
}

// Converts the cloud to the input of a predictor.
cv::Mat
imageOf(const LabelledCloud& labelled, const std::string& path, bool is_seen)
{
  if (is_seen && !labelled.has_colour)
    fail<BadInputException>(path, ": has no colours; a network needs rgb or rgba");
  if (is_seen && !labelled.cloud->isOrganized())
    fail<BadInputException>(path,
                            ": is no organized cloud; a network needs the whole image");
  pcl::PointCloud<pcl::PointXYZRGB> cloud;
  pcl::copyPointCloud(*labelled.cloud, cloud);
  return imageOfCloud(cloud);
}

VisibilityParameters
visibilityOf(const Arguments& arguments)
{
  VisibilityParameters parameters;
  parameters.max_depth = arguments.max_depth > 0.0
                             ? arguments.max_depth
                             : std::numeric_limits<double>::infinity();
  char comma = 0, rest = 0;
  std::istringstream stream(arguments.occlusion_window);
  refuseIf(!(stream >> parameters.window_columns >> comma >> parameters.window_rows) ||
               comma != ',' || stream >> rest,
           "--occlusion-window is '" + arguments.occlusion_window +
               "', expected COLUMNS,ROWS");
  return parameters;
}

// Statistics of the points of clouds.
struct PointCounts {
  double fractions = 0.0; ///< sum over the clouds of their labelled fraction
  std::size_t clouds = 0; ///< with points
  std::size_t without_return = 0;
  std::vector<std::string> doubts; ///< of the first doubtful cloud
};

// \param[in] carrier null: the cloud is an image itself
void
labelCloud(const std::string& path, int number, const Arguments& arguments,
           const std::string& output, LabelPredictor& predictor,
           const LabelCarrier* carrier, PointCounts& counts)
{
  const bool is_seen = dynamic_cast<NetworkPredictor*>(&predictor) != nullptr;
  LabelledCloud labelled = readLabelledCloud(
      path, &anyLabels(), parseScanColumns(arguments.scan_columns, path));
  if (counts.doubts.empty()) {
    counts.doubts = labelled.table.doubts;
    warnOf(counts.doubts);
  }
  addOrigin(labelled);
  pcl::PointCloud<pcl::PointXYZRGBL>& cloud = *labelled.cloud;
  if (cloud.empty()) {
    warn(path + ": has no points");
    return writeLabelledCloud(output, labelled);
  }
  labelled.distributions =
      carrier ? carrier->label(cloud, number, predictor)
              : predictor.predict(imageOf(labelled, path, is_seen), number);
  std::size_t known = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    cloud[i].label = labelled.distributions.mapLabel(Eigen::Index(i));
    known += isReturn(cloud[i]) && cloud[i].label != kUnlabelled;
    counts.without_return += !isReturn(cloud[i]);
  }
  if (carrier && known == 0)
    warn(path +
         ": the camera sees none of its points: is the pose of the scanner right?");
  writeLabelledCloud(output, labelled);
  counts.fractions += double(known) / double(cloud.size());
  ++counts.clouds;
}

// Output path of a cloud: the same name in another folder.
std::string
outputOf(const Arguments& arguments, const std::string& path)
{
  if (fs::path(arguments.output).extension() == ".pcd")
    return arguments.output;
  fs::path name = fs::path(path).stem();
  if (name.extension() == ".pcd") // of a .pcd.bin
    name = name.stem();
  return (fs::path(arguments.output) / name).string() + ".pcd";
}

// Selects the clouds to label, after checking all output paths.
std::vector<std::size_t>
prepareClouds(const Arguments& arguments, const CloudSequence& clouds)
{
  const std::vector<std::size_t> chosen =
      chooseFrames(arguments.clouds, clouds, arguments.frames);
  const bool is_cloud = fs::path(arguments.output).extension() == ".pcd";
  refuseIf(is_cloud && chosen.size() > 1,
           "--output is one cloud, but --clouds are " + std::to_string(chosen.size()));
  std::vector<std::string> written;
  for (const std::size_t i : chosen) {
    written.push_back(outputOf(arguments, clouds.path(i)));
    refuseSameFiles({clouds.path(i)}, {written.back()});
  }
  if (!is_cloud) {
    makeOutputFolder(arguments.output);
    warnOfOtherFiles(arguments.output, written);
  }
  return chosen;
}

// Labels clouds, by their own pixels or a camera's images, and writes one labelled
// cloud each.
int
labelClouds(const Arguments& arguments)
{
  setNumberOfThreads(arguments.threads);
  const CloudSequence clouds(arguments.clouds, "",
                             parseScanColumns(arguments.scan_columns));
  MappingWatch watch;
  const auto predictor = makePredictor(arguments, watch);
  std::optional<LabelCarrier> carrier;
  if (arguments.carries())
    carrier.emplace(arguments.sequence, arguments.rgbd.intrinsics,
                    arguments.sensor_pose, visibilityOf(arguments),
                    !arguments.labels.empty());
  const std::vector<std::size_t> chosen = prepareClouds(arguments, clouds);
  std::vector<int> frames;
  for (const std::size_t i : chosen) {
    frames.push_back(clouds.frameNumber(i));
    if (carrier)
      carrier->requireImage(clouds.path(i), frames.back());
  }
  predictor->requireFrames(frames);
  PointCounts counts;
  const auto label = [&](std::size_t i) {
    const std::string& path = clouds.path(chosen[i]);
    labelCloud(path, frames[i], arguments, outputOf(arguments, path), *predictor,
               carrier ? &*carrier : nullptr, counts);
  };
  forEachStep("labelling", chosen.size(), label, "clouds");
  const double clouds_with_points = double(std::max<std::size_t>(counts.clouds, 1));
  printResults({{"clouds", chosen.size()},
                {"labelled_fraction", counts.fractions / clouds_with_points},
                {"without_return", counts.without_return},
                {"output", arguments.output}});
  return exit_done;
}

// Images and scans have the same names as the output, and a frame must not have two
// files of labels.
void
refuseOtherFiles(const Arguments& options, const std::string& extension)
{
  std::error_code error;
  const ImagePairFiles& files = options.sequence.files;
  std::vector<fs::path> images = {fs::path(files.left).parent_path(),
                                  fs::path(files.right).parent_path()};
  for (const char* name : {"image_0", "image_1", "image_2", "image_3"})
    images.push_back(fs::path(options.sequence.folder) / name);
  for (const fs::path& folder : images)
    refuseIf(fs::equivalent(folder, options.output, error),
             "--output " + options.output +
                 ": holds images, expected a folder without images");
  if (!fs::is_directory(options.output, error))
    return;
  for (const FrameFile& file : listFrameFiles(options.output, distributionExtensions()))
    refuseIf(fs::path(file.path).filename() != frameFileName(file.frame, extension),
             "--output holds " + file.path + ", where only " + extension +
                 " files would be written");
}

void
writeLabels(const Arguments& options, int frame, int width,
            const LabelDistributions& distributions)
{
  const std::string path = options.output + "/";
  if (options.format == "ids")
    writeLabelIds(path + frameFileName(frame, ".png"), distributions, width);
  else if (options.format == "packed")
    writeDistributions(path + frameFileName(frame, ".npy.zst"), distributions, width,
                       NpyType::uint8);
  else
    writeDistributions(path + frameFileName(frame, ".npy"), distributions, width,
                       options.format == "float16" ? NpyType::float16
                                                   : NpyType::float32);
}

std::string
extensionOf(const std::string& format)
{
  return format == "ids" ? ".png" : format == "packed" ? ".npy.zst" : ".npy";
}

// Paths of single images by frame number.
std::map<int, std::string>
singleImages(const Arguments& options)
{
  std::map<int, std::string> all;
  if (options.images.empty()) {
    std::vector<std::string> doubts;
    all = RgbdSequence::colourImages(options.rgbd.folder, options.rgbd.depth_within,
                                     &doubts);
    warnOf(doubts);
  }
  else {
    const std::vector<std::string> paths = findFiles(options.images, imageExtensions());
    const std::vector<int> numbers = frameNumbersOf(paths);
    for (std::size_t i = 0; i < paths.size(); ++i)
      all[numbers.empty() ? int(i) : numbers[i]] = paths[i];
  }
  const FrameRange range = parseFrameRange(options.frames);
  std::map<int, std::string> images;
  std::error_code error;
  for (const auto& [frame, path] : all) {
    refuseIf(fs::equivalent(fs::path(path).parent_path(), options.output, error),
             "--output " + options.output +
                 ": holds images, expected a folder without images");
    if (range.contains(frame))
      images[frame] = path;
  }
  if (images.empty())
    fail<BadInputException>(options.images.empty() ? options.rgbd.folder
                                                   : options.images,
                            ": has no frame in ", options.frames);
  return images;
}

// Labels images and stores the distributions.
// \param[in] imageOf gives the i-th image and the number of its frame
template <typename ImageOf>
Results
labelEach(const Arguments& options, std::size_t images, ImageOf&& imageOf)
{
  const OpenedNetwork network =
      openTriedNetwork(options.network, options.model, options.engine);
  makeOutputFolder(options.output);
  forEachStep("labelling", images, [&](std::size_t i) {
    const auto& [image, frame] = imageOf(i);
    writeLabels(options, frame, image.cols, network.predictor->predict(image, frame));
  });
  return {{"frames", images},
          {"classes", std::size_t(network.label_set.size())},
          {"label_set", network.label_set_path},
          {"labels", options.output}};
}

Results
labelImages(const Arguments& options)
{
  const std::map<int, std::string> images = singleImages(options);
  const std::string& calibration = options.sequence.files.calibration;
  std::optional<PinholeCamera> camera;
  std::optional<Undistorter> undistorter;
  if (!calibration.empty()) {
    camera = readPinholeCamera(calibration);
    warnOf(camera->doubts);
  }
  auto next = images.begin();
  DarkWatch dark;
  return labelEach(options, images.size(), [&](std::size_t) {
    const auto& [frame, path] = *next++;
    const cv::Mat image =
        undistorter
            ? readImage(path,
                        {undistorter->camera().width, undistorter->camera().height},
                        " as " + images.begin()->second)
            : readImage(path);
    dark.look(image, path);
    if (camera && !undistorter)
      undistorter.emplace(*camera, image.cols, image.rows, path);
    return std::pair(undistorter ? undistorter->undistort(image) : image, frame);
  });
}

Results
labelSequence(const Arguments& options)
{
  const auto sequence = openSequenceOf(options.sequence);
  const auto frames = chooseFrames(options.sequence.name(), *sequence, options.frames);
  PairWatch watch(options.sequence.strict, sequence->camera());
  return labelEach(options, frames.size(), [&](std::size_t i) {
    const StereoFrame frame = sequence->frame(frames[i]);
    watch.look(frame);
    return std::pair(frame.left, frame.number);
  });
}

int
storeLabels(const Arguments& options)
{
  refuseOtherFiles(options, extensionOf(options.format));
  setNumberOfThreads(options.threads);
  printResults(options.hasSingleImages() ? labelImages(options)
                                         : labelSequence(options));
  return exit_done;
}

} // namespace

int
main(int argc, char** argv)
{
  if (const auto trial = runAsNetworkTrial(argc, argv))
    return *trial;
  return runWithImages(usage.name, [&] {
    const Arguments arguments = parse(argc, argv);
    return arguments.clouds.empty() ? storeLabels(arguments) : labelClouds(arguments);
  });
}
