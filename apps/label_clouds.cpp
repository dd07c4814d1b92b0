// SPDX-License-Identifier: BSD-3-Clause
#include "default_label_set.h"
#include "label_arguments.h"
#include "messages.h"
#include "progress_bar.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/files/distribution_file.h>
#include <pcl_semantic/files/label_set_file.h>
#include <pcl_semantic/io/labelled_cloud_file.h>
#include <pcl_semantic/labelling/network_predictor.h>
#include <pcl_semantic/labelling/stored_predictor.h>
#include <pcl_semantic/stereo/disparity_to_cloud.h>

#include <pcl/common/io.h>
#include <pcl/common/point_tests.h>

#include <filesystem>

namespace pcl_semantic::tool {

namespace {

namespace fs = std::filesystem;

// The one file of labels that belongs to the one cloud.
class FilePredictor : public LabelPredictor {
public:
  FilePredictor(std::string path, int classes, float confidence)
      : path_(std::move(path)), classes_(classes), confidence_(confidence)
  {}

  LabelDistributions
  predict(const StereoFrame& frame) override
  {
    return readDistributions(path_, frame.left.cols, frame.left.rows, classes_,
                             confidence_);
  }

private:
  std::string path_;
  int classes_;
  float confidence_;
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
  const int classes = readLabelSetOrDefault(arguments.label_set).size();
  const auto confidence = float(arguments.label_confidence);
  if (isFolder(arguments.labels) || fs::path(arguments.clouds).extension() != ".pcd")
    return std::make_unique<StoredPredictor>(arguments.labels, classes, confidence);
  return std::make_unique<FilePredictor>(arguments.labels, classes, confidence);
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

// Gives the share of points that have a place and a label.
double
labelCloud(const std::string& path, int number, const std::string& output,
           LabelPredictor& predictor)
{
  const bool is_seen = dynamic_cast<NetworkPredictor*>(&predictor) != nullptr;
  LabelledCloud labelled = readLabelledCloud(path);
  pcl::PointCloud<pcl::PointXYZRGBL>& cloud = *labelled.cloud;
  if (cloud.empty())
    PCL_THROW_EXCEPTION(BadInputException, path << ": has no points");
  labelled.distributions = predictor.predict(frameOf(labelled, path, number, is_seen));
  std::size_t known = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    cloud[i].label = labelled.distributions.mapLabel(Eigen::Index(i));
    known += pcl::isXYZFinite(cloud[i]) && cloud[i].label != kUnlabelled;
  }
  writeLabelledCloud(output, labelled);
  return double(known) / double(cloud.size());
}

// Where each cloud goes: the same name in another folder.
std::string
outputOf(const LabelArguments& arguments, const std::string& path)
{
  if (fs::path(arguments.output).extension() == ".pcd")
    return arguments.output;
  return (fs::path(arguments.output) / fs::path(path).filename()).string();
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
  for (const std::size_t i : chosen)
    refuseSameFiles({clouds.path(i)}, {outputOf(arguments, clouds.path(i))});
  if (!is_cloud)
    makeOutputFolder(arguments.output);
  return chosen;
}

} // namespace

int
labelClouds(const LabelArguments& arguments)
{
  setNumberOfThreads(arguments.threads);
  const CloudSequence clouds(arguments.clouds);
  const auto predictor = makePredictor(arguments);
  const std::vector<std::size_t> chosen = prepareClouds(arguments, clouds);
  catchInterrupts();
  double share = 0.0;
  {
    ProgressBar progress("labelling", chosen.size(), "clouds");
    for (const std::size_t i : chosen) {
      const std::string& path = clouds.path(i);
      share += labelCloud(path, clouds.frameNumber(i), outputOf(arguments, path),
                          *predictor);
      if (interrupted())
        return exit_interrupted;
      progress.step();
    }
  }
  printResults({{"clouds", chosen.size()},
                {"share_labelled", share / double(chosen.size())},
                {"output", arguments.output}});
  return exit_done;
}

} // namespace pcl_semantic::tool
