// SPDX-License-Identifier: BSD-3-Clause
#include "default_label_set.h"
#include "label_carrier.h"
#include "messages.h"
#include "pair_watch.h"
#include "sequence_options.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/files/cloud_file.h>
#include <pcl_semantic/files/distribution_file.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/files/label_set_file.h>
#include <pcl_semantic/labelling/network_predictor.h>
#include <pcl_semantic/labelling/stored_predictor.h>
#include <pcl_semantic/stereo/disparity_to_cloud.h>

#include <pcl/common/io.h>
#include <pcl/common/point_tests.h>

#include <filesystem>
#include <limits>
#include <optional>
#include <string>

namespace pcl_semantic::tool {

/** \brief The command line of pcl_semantic_label. */
struct LabelArguments {
  SequenceOptions sequence;
  std::string clouds; ///< to label: organized ones, or what the sequence's camera saw
  std::string sensor_pose; ///< of the clouds' sensor in the camera; empty = KITTI's Tr
  double max_depth = 0.0;  ///< of points that get labels of images [m]; 0 = unlimited
  std::string occlusion_window = "3,7"; ///< half columns, half rows [px]
  std::string output, network, model, labels, label_set, label_mapping;
  std::string frames = ":";
  std::string format = "float32";
  double label_confidence = 0.8; ///< of a stored `.png`
  int threads = 0;

  /** \brief Whether clouds get the labels of a camera's images. */
  bool
  carries() const
  {
    return !clouds.empty() &&
           (!sequence.folder.empty() || !sequence.files.left.empty());
  }
};

extern const Usage label_usage;

/** \brief Reads it.
 * \return false if nothing is left to do, see parseCommandLine()
 * \throws InvalidParameterException */
bool parseLabelArguments(int argc, char** argv, LabelArguments& arguments);

/** \brief Labels clouds, by their own pixels or a camera's images: writes a labelled
 * cloud for each. \return exit code
 * \throws BadInputException, BadModelException, OutputException */
int labelClouds(const LabelArguments& arguments);

const Usage label_usage{
    "pcl_semantic_label",
    "(SEQUENCE | --left 'L*.png' --right 'R*.png' --calibration FILE.yaml)\n"
    "  --network FILE.yaml --output DIR [options]\n"
    "or --clouds (DIR | CLOUD.pcd) (--network FILE.yaml | --labels (DIR | FILE))\n"
    "  --output (DIR | OUT.pcd) [options]\n"
    "or --clouds DIR (SEQUENCE | --left 'I*.png' --calibration CAMERA.yaml\n"
    "  --sensor-pose FILE) (--network FILE.yaml | --labels DIR) --output DIR [options]",
    "Runs a segmentation network over the left images and stores the class "
    "distributions\nof their pixels, once for many runs of pcl_semantic_map --labels; "
    "or "
    "gives clouds\nlabels: organized ones those of their pixels, those of a laser "
    "scanner "
    "those of the\nimages in which a camera saw the points.",
    "pcl_semantic_synthesize /tmp/street && \\\n"
    "  pcl_semantic_stereo /tmp/street/image_2 /tmp/street/image_3 "
    "/tmp/street/calib.txt \\\n"
    "    /tmp/street_clouds && \\\n"
    "  pcl_semantic_label --clouds /tmp/street_clouds --labels /tmp/street/labels \\\n"
    "    --output /tmp/street_labelled"};

namespace {

po::options_description
describeOptions(LabelArguments& arguments)
{
  po::options_description visible("Options");
  addSequenceOptions(arguments.sequence, visible);
  visible.add_options()(
      "clouds", po::value(&arguments.clouds),
      "clouds to label, one per frame, a .pcd, a folder or a pattern "
      "in quotes: organized ones, of pcl_semantic_stereo, or those of "
      "a scanner beside SEQUENCE or --left")(
      "sensor-pose", po::value(&arguments.sensor_pose),
      "pose of the scanner in the camera (x right, y down, z forward): a file with one "
      "line, the upper 3 x 4 of its matrix (default: Tr of SEQUENCE's calib.txt)")(
      "output,o", po::value(&arguments.output),
      "output folder; for one cloud the output cloud (.pcd)")(
      "network", po::value(&arguments.network), "network description (.yaml)")(
      "model", po::value(&arguments.model),
      "network (.onnx; default: as its description says)")(
      "labels", po::value(&arguments.labels),
      "stored label distributions for --clouds: folder with one .bin, .npy or .png per "
      "frame, or one file")("label-set", po::value(&arguments.label_set),
                            "label set of --labels (default: "
                            "label_sets/kitti11.yaml)")(
      "label-mapping", po::value(&arguments.label_mapping), pixel_mapping_help)(
      "frames", po::value(&arguments.frames), "A:B = frames with numbers A <= n < B");
  addOption(visible, "format", arguments.format,
            "output format for SEQUENCE: float32, float16 (.npy, half the size) or ids "
            "(.png, most probable class)");
  addOption(visible, "max-depth", arguments.max_depth,
            "farthest points that get labels of images [m]; 0 = all");
  addOption(
      visible, "occlusion-window", arguments.occlusion_window,
      "nearer points hide a point within so many columns, rows [px]: as far as the "
      "beams are apart in the image");
  addOption(visible, "label-confidence", arguments.label_confidence,
            "probability of the class that a .png of --labels gives");
  addOption(visible, "threads", arguments.threads,
            "number of threads; 0 = all processors");
  return visible;
}

void
requireSequenceAndNetwork(const LabelArguments& arguments)
{
  requireSequence(arguments.sequence, label_usage.name);
  if (!arguments.labels.empty() || !arguments.label_set.empty() ||
      !arguments.label_mapping.empty())
    failUsage(label_usage,
              "--labels, --label-set and --label-mapping are for --clouds");
  if (arguments.output.empty())
    failUsage(label_usage, "--output is missing");
  if (arguments.network.empty())
    failUsage(label_usage, "--network is missing");
  if (arguments.format != "float32" && arguments.format != "float16" &&
      arguments.format != "ids")
    failUsage(label_usage, "--format is '" + arguments.format +
                               "', expected float32, float16 or ids");
}

void
requireClouds(const LabelArguments& arguments, bool has_format)
{
  const ImagePairFiles& files = arguments.sequence.files;
  if (!arguments.carries() &&
      (arguments.sequence.hasFiles() || arguments.sequence.strict))
    failUsage(label_usage,
              "--clouds without SEQUENCE or --left take no options of them");
  if (arguments.carries() && !arguments.sequence.folder.empty() &&
      arguments.sequence.hasFiles())
    failUsage(label_usage, "both a SEQUENCE and --left, --calibration or --times");
  if (!files.left.empty() && files.calibration.empty())
    failUsage(label_usage, "--left needs --calibration, its intrinsics");
  if (!files.left.empty() && arguments.sensor_pose.empty())
    failUsage(label_usage, "--left needs --sensor-pose, where the scanner is");
  if (!files.right.empty() || !files.extrinsics.empty())
    failUsage(label_usage, "--clouds need one camera, not --right or --extrinsics");
  if (!arguments.carries() && !arguments.sensor_pose.empty())
    failUsage(label_usage, "--sensor-pose is for the images of SEQUENCE or --left");
  if (arguments.output.empty())
    failUsage(label_usage, "--output is missing");
  if (arguments.labels.empty() == arguments.network.empty())
    failUsage(label_usage, "expected either --labels or --network");
  if (!arguments.model.empty() && arguments.network.empty())
    failUsage(label_usage, "--model needs --network");
  if (!arguments.label_mapping.empty() && arguments.labels.empty())
    failUsage(label_usage, "--label-mapping is for --labels");
  if (!arguments.label_set.empty() && arguments.labels.empty())
    failUsage(label_usage, "--label-set is for --labels; the description of a network "
                           "names its own");
  if (has_format)
    failUsage(label_usage, "--format is for a SEQUENCE: clouds are written as .pcd");
  if (!(arguments.max_depth >= 0.0))
    failUsage(label_usage, "--max-depth is less than 0");
}

} // namespace

bool
parseLabelArguments(int argc, char** argv, LabelArguments& arguments)
{
  const po::options_description visible = describeOptions(arguments);
  po::positional_options_description positional;
  positional.add("sequence", 1);
  po::variables_map values;
  if (!parseCommandLine(argc, argv, label_usage, visible, positional, values))
    return false;
  if (arguments.clouds.empty())
    requireSequenceAndNetwork(arguments);
  else
    requireClouds(arguments, !values["format"].defaulted());
  return true;
}

namespace {

namespace fs = std::filesystem;

// The one file of labels that belongs to the one cloud.
class FilePredictor : public LabelPredictor {
public:
  FilePredictor(std::string path, int classes, float confidence, PixelMapping mapping)
      : path_(std::move(path)), classes_(classes), confidence_(confidence),
        mapping_(std::move(mapping))
  {}

  LabelDistributions
  predict(const StereoFrame& frame) override
  {
    return readDistributions(path_, frame.left.cols, frame.left.rows, classes_,
                             confidence_, mapping_);
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

std::unique_ptr<LabelPredictor>
makePredictor(const LabelArguments& arguments)
{
  if (!arguments.network.empty()) {
    const NetworkDescription network = readNetworkDescription(arguments.network);
    return std::make_unique<NetworkPredictor>(
        network, readLabelSet(network.label_set_path), arguments.model);
  }
  const LabelSet label_set = readLabelSetOrDefault(arguments.label_set);
  const int classes = label_set.size();
  PixelMapping mapping = readPixelMapping(arguments.label_mapping, label_set);
  const auto confidence = float(arguments.label_confidence);
  if (arguments.carries() || isFolder(arguments.labels) ||
      fs::path(arguments.clouds).extension() != ".pcd")
    return std::make_unique<StoredPredictor>(arguments.labels, classes, confidence,
                                             std::move(mapping));
  return std::make_unique<FilePredictor>(arguments.labels, classes, confidence,
                                         std::move(mapping));
}

// The cloud as a predictor takes it.
StereoFrame
frameOf(const LabelledCloud& labelled, const std::string& path, int number,
        bool is_seen)
{
  if (is_seen && !labelled.has_colour)
    PCL_THROW_EXCEPTION(BadInputException,
                        path << ": has no colours; a network needs rgb or rgba");
  if (is_seen && !labelled.cloud->isOrganized())
    PCL_THROW_EXCEPTION(BadInputException,
                        path << ": is no organized cloud; a network needs the whole "
                                "image");
  pcl::PointCloud<pcl::PointXYZRGB> cloud;
  pcl::copyPointCloud(*labelled.cloud, cloud);
  StereoFrame frame;
  frame.number = number;
  frame.left = imageOfCloud(cloud);
  return frame;
}

VisibilityParameters
visibilityOf(const LabelArguments& arguments)
{
  VisibilityParameters parameters;
  parameters.max_depth = arguments.max_depth > 0.0
                             ? arguments.max_depth
                             : std::numeric_limits<double>::infinity();
  char comma = 0, rest = 0;
  std::istringstream stream(arguments.occlusion_window);
  if (!(stream >> parameters.window_columns >> comma >> parameters.window_rows) ||
      comma != ',' || stream >> rest)
    failUsage(label_usage, "--occlusion-window is '" + arguments.occlusion_window +
                               "', expected COLUMNS,ROWS");
  return parameters;
}

// Gives the fraction of points with a finite position and a label.
// \param[in] carrier null: the cloud is an image itself
double
labelCloud(const std::string& path, int number, const std::string& output,
           LabelPredictor& predictor, const LabelCarrier* carrier)
{
  const bool is_seen = dynamic_cast<NetworkPredictor*>(&predictor) != nullptr;
  LabelledCloud labelled = readLabelledCloud(path);
  pcl::PointCloud<pcl::PointXYZRGBL>& cloud = *labelled.cloud;
  if (cloud.empty())
    PCL_THROW_EXCEPTION(BadInputException, path << ": has no points");
  labelled.distributions =
      carrier ? carrier->label(cloud, number, predictor)
              : predictor.predict(frameOf(labelled, path, number, is_seen));
  std::size_t known = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    cloud[i].label = labelled.distributions.mapLabel(Eigen::Index(i));
    known += pcl::isXYZFinite(cloud[i]) && cloud[i].label != kUnlabelled;
  }
  if (carrier && known == 0)
    warn(path +
         ": the camera sees none of its points: is the pose of the scanner right?");
  writeLabelledCloud(output, labelled);
  return double(known) / double(cloud.size());
}

// Where each cloud goes: the same name in another folder.
std::string
outputOf(const LabelArguments& arguments, const std::string& path)
{
  if (fs::path(arguments.output).extension() == ".pcd")
    return arguments.output;
  return (fs::path(arguments.output) / fs::path(path).stem()).string() + ".pcd";
}

// The clouds to label, once it is clear that each has a place to go to.
std::vector<std::size_t>
prepareClouds(const LabelArguments& arguments, const CloudSequence& clouds)
{
  const std::vector<std::size_t> chosen =
      chooseClouds(arguments.clouds, clouds, arguments.frames);
  const bool is_cloud = fs::path(arguments.output).extension() == ".pcd";
  if (is_cloud && chosen.size() > 1)
    failUsage(label_usage, "--output is one cloud, but --clouds are " +
                               std::to_string(chosen.size()));
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

} // namespace

int
labelClouds(const LabelArguments& arguments)
{
  setNumberOfThreads(arguments.threads);
  const CloudSequence clouds(arguments.clouds);
  const auto predictor = makePredictor(arguments);
  std::optional<LabelCarrier> carrier;
  if (arguments.carries())
    carrier.emplace(arguments.sequence, arguments.sensor_pose, visibilityOf(arguments));
  const std::vector<std::size_t> chosen = prepareClouds(arguments, clouds);
  std::vector<int> frames;
  for (const std::size_t i : chosen) {
    frames.push_back(clouds.frameNumber(i));
    if (carrier)
      carrier->requireImage(clouds.path(i), frames.back());
  }
  predictor->requireFrames(frames);
  catchInterrupts();
  double fraction = 0.0;
  {
    ProgressBar progress("labelling", chosen.size(), "clouds");
    for (const std::size_t i : chosen) {
      const std::string& path = clouds.path(i);
      fraction += labelCloud(path, clouds.frameNumber(i), outputOf(arguments, path),
                             *predictor, carrier ? &*carrier : nullptr);
      if (interrupted())
        return exit_interrupted;
      progress.step();
    }
  }
  printResults({{"clouds", chosen.size()},
                {"labelled_fraction", fraction / double(chosen.size())},
                {"output", arguments.output}});
  return exit_done;
}

} // namespace pcl_semantic::tool

using namespace pcl_semantic;

namespace {

namespace fs = std::filesystem;

using tool::LabelArguments;

// Images and scans bear the names of what is written here, and a frame must not have
// two files of labels.
void
refuseOtherFiles(const LabelArguments& options, const std::string& extension)
{
  std::error_code error;
  const ImagePairFiles& files = options.sequence.files;
  std::vector<fs::path> images = {fs::path(files.left).parent_path(),
                                  fs::path(files.right).parent_path()};
  for (const char* name : {"image_0", "image_1", "image_2", "image_3"})
    images.push_back(fs::path(options.sequence.folder) / name);
  for (const fs::path& folder : images)
    if (fs::equivalent(folder, options.output, error))
      tool::failUsage(tool::label_usage,
                      "--output " + options.output + ": holds images");
  if (!fs::is_directory(options.output, error))
    return;
  for (const FrameFile& file : listFrameFiles(options.output, {".bin", ".npy", ".png"}))
    if (fs::path(file.path).extension() != extension)
      tool::failUsage(tool::label_usage, "--output holds " + file.path +
                                             ", where only " + extension +
                                             " files would be written");
}

void
writeLabels(const LabelArguments& options, int frame, int width,
            const LabelDistributions& distributions)
{
  const std::string path = options.output + "/";
  if (options.format == "ids")
    writeLabelIds(path + frameFileName(frame, ".png"), distributions, width);
  else
    writeDistributions(path + frameFileName(frame, ".npy"), distributions, width,
                       options.format == "float16" ? NpyType::float16
                                                   : NpyType::float32);
}

int
labelSequence(const LabelArguments& options)
{
  refuseOtherFiles(options, options.format == "ids" ? ".png" : ".npy");
  setNumberOfThreads(options.threads);
  const NetworkDescription network = readNetworkDescription(options.network);
  const LabelSet label_set = readLabelSet(network.label_set_path);
  const auto sequence = tool::openSequence(options.sequence);
  const auto frames = tool::chooseFrames(options.sequence, *sequence, options.frames);
  NetworkPredictor predictor(network, label_set, options.model);
  makeOutputFolder(options.output);
  tool::catchInterrupts();
  {
    tool::PairWatch watch(options.sequence.strict, sequence->camera());
    tool::ProgressBar progress("labelling", frames.size());
    for (const std::size_t i : frames) {
      const StereoFrame frame = sequence->frame(i);
      watch.look(frame);
      writeLabels(options, frame.number, frame.left.cols, predictor.predict(frame));
      if (tool::interrupted())
        return tool::exit_interrupted;
      progress.step();
    }
  }
  tool::printResults({{"frames", frames.size()},
                      {"classes", std::size_t(label_set.size())},
                      {"label_set", network.label_set_path},
                      {"labels", options.output}});
  return tool::exit_done;
}

} // namespace

int
main(int argc, char** argv)
{
  return tool::run(tool::label_usage.name, [&] {
    LabelArguments arguments;
    if (!tool::parseLabelArguments(argc, argv, arguments))
      return int(tool::exit_done);
    return arguments.clouds.empty() ? labelSequence(arguments)
                                    : tool::labelClouds(arguments);
  });
}
