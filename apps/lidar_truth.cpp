/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "progress_bar.h"
#include "tool.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/dataset/frame_range.h>
#include <pcl_semantic/dataset/kitti_sequence.h>
#include <pcl_semantic/dataset/semantic_kitti_labels.h>
#include <pcl_semantic/dataset/velodyne_scan.h>
#include <pcl_semantic/evaluation/lidar_truth.h>
#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/files/image_file.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/files/label_set_file.h>

#include <filesystem>
#include <iostream>

namespace {

using namespace pcl_semantic;

struct Options {
  std::string sequence;
  std::string output;
  std::string label_set;
  std::string label_mapping;
  std::string frames = ":";
  LidarTruthParameters parameters;
};

const tool::Usage usage{
    "pcl_semantic_lidar_truth",
    "SEQUENCE --output DIR --label-set FILE --label-mapping FILE [options]",
    "Projects the labelled laser scans of a KITTI sequence (velodyne/*.bin, "
    "labels/*.label)\ninto its left images: sparse 8-bit truth images, 0 = no truth.",
    "pcl_semantic_lidar_truth sequences/05 --output /tmp/truth \\\n"
    "    --label-set data/label_sets/kitti11.yaml \\\n"
    "    --label-mapping data/label_mappings/semantic_kitti_to_kitti11.yaml"};

bool
parse(int argc, char** argv, Options& options)
{
  namespace po = tool::po;
  po::options_description description("Options");
  LidarTruthParameters& parameters = options.parameters;
  description.add_options()("sequence", po::value(&options.sequence)->required(),
                            "folder of the sequence")(
      "output,o", po::value(&options.output)->required(), "folder of the truth images")(
      "label-set", po::value(&options.label_set)->required(),
      "classes (YAML)")("label-mapping", po::value(&options.label_mapping)->required(),
                        "SemanticKITTI ids to the classes (YAML)")(
      "max-depth",
      po::value(&parameters.max_depth)->default_value(parameters.max_depth),
      "largest depth kept [m]")(
      "frames", po::value(&options.frames)->default_value(options.frames),
      "A:B, only frames numbered A <= n < B");
  po::positional_options_description positional;
  positional.add("sequence", 1);
  po::variables_map values;
  return tool::parseCommandLine(argc, argv, usage, description, positional, values);
}

/** \brief Truth images bear the names of the images: they must not replace them. */
void
refuseImageFolders(const Options& options)
{
  std::error_code error;
  for (const char* images : {"/image_0", "/image_1", "/image_2", "/image_3"})
    if (std::filesystem::equivalent(options.sequence + images, options.output, error))
      PCL_THROW_EXCEPTION(InvalidParameterException,
                          "--output " << options.output
                                      << ": holds the images of the sequence");
}

int
project(const Options& options)
{
  refuseImageFolders(options);
  const FrameRange range = parseFrameRange(options.frames);
  if (!(options.parameters.max_depth > 0.0))
    PCL_THROW_EXCEPTION(InvalidParameterException, "--max-depth is "
                                                       << options.parameters.max_depth
                                                       << ", expected more than 0");
  const LabelSet label_set = readLabelSet(options.label_set);
  const LabelMapping mapping = readLabelMapping(options.label_mapping, label_set);
  const KittiSequence sequence(options.sequence);
  const Eigen::Isometry3d T_camera_velodyne =
      sequence.T_camera0_camera().inverse() * sequence.T_camera0_velodyne();
  std::vector<FrameFile> scans;
  for (const FrameFile& scan : listFrameFiles(options.sequence + "/velodyne", {".bin"}))
    if (range.contains(scan.frame))
      scans.push_back(scan);
  if (scans.empty())
    PCL_THROW_EXCEPTION(BadInputException,
                        options.sequence << "/velodyne: holds no scan of the frames "
                                         << options.frames);

  makeOutputFolder(options.output);
  tool::ProgressBar progress("projecting", scans.size());
  for (const FrameFile& file : scans) {
    const auto scan = readVelodyneScan(file.path);
    const std::vector<Label> labels = readSemanticKittiLabels(
        options.sequence + "/labels/" + frameFileName(file.frame, ".label"), mapping,
        scan->size());
    writePng(options.output + "/" + frameFileName(file.frame, ".png"),
             projectLidarTruth(*scan, labels, sequence.camera(), T_camera_velodyne,
                               options.parameters));
    progress.step();
  }
  std::cout << "wrote " << scans.size() << " truth images to " << options.output
            << "\n";
  return tool::exit_done;
}

} // namespace

int
main(int argc, char** argv)
{
  return tool::run(usage.name, [&] {
    Options options;
    return parse(argc, argv, options) ? project(options) : int(tool::exit_done);
  });
}
