// SPDX-License-Identifier: BSD-3-Clause
#include "messages.h"
#include "tool.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/dataset/frame_sequence.h>
#include <pcl_semantic/dataset/kitti_sequence.h>
#include <pcl_semantic/dataset/lidar_scan.h>
#include <pcl_semantic/evaluation/depth_file.h>
#include <pcl_semantic/evaluation/lidar_truth.h>
#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/files/image_file.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/files/label_set_file.h>

#include <filesystem>

namespace {

using namespace pcl_semantic;
using namespace pcl_semantic::tool;

struct Options {
  std::string sequence;
  std::string output;
  std::string depth, scan_labels, scan_depth; // folders, empty = not written
  std::string label_set;
  std::string label_mapping;
  std::string frames = ":";
  VisibilityParameters parameters;
};

const Usage usage{
    "pcl_semantic_lidar_truth",
    "SEQUENCE --output DIR --label-set FILE --label-mapping FILE [options]",
    R"(Projects the labelled laser scans of a KITTI sequence (velodyne/*.bin,
labels/*.label) into its left images: sparse 8-bit ground truth, 0 = unknown.
Also writes its depth, and the ground truth point by point for maps in 3D.)",
    R"(pcl_semantic_lidar_truth sequences/05 --output /tmp/truth \
    --label-set data/label_sets/kitti11.yaml \
    --label-mapping data/label_mappings/semantic_kitti_to_kitti11.yaml)"};

Options
parse(int argc, char** argv)
{
  Options options;
  VisibilityParameters& parameters = options.parameters;
  parseCommandLine(
      argc, argv, usage,
      {{"sequence", required(options.sequence), "folder of the sequence"},
       {"output,o", required(options.output), "folder of the ground truth images"},
       {"depth", options.depth,
        "folder for the depth of their pixels (16-bit PNG, 256 x metres)"},
       {"scan-labels", options.scan_labels,
        "folder for the class of each point that the camera sees, 0 of others "
        "(.label)"},
       {"scan-depth", options.scan_depth,
        "folder for the depth of these points (.bin, float32)"},
       {"label-set", required(options.label_set), "classes (YAML)"},
       {"label-mapping", required(options.label_mapping),
        "SemanticKITTI ids to the classes (YAML)"},
       {"max-depth", withDefault(parameters.max_depth), "largest depth kept [m]"},
       {"frames", withDefault(options.frames), "A:B, only frames numbered A <= n < B"}},
      {"sequence"});
  return options;
}

// Truth bears the names of images and scans: it must not replace them.
void
refuseInputFolders(const Options& options)
{
  std::error_code error;
  for (const char* name :
       {"/image_0", "/image_1", "/image_2", "/image_3", "/labels", "/velodyne"})
    for (const auto& [option, folder] :
         {std::pair("--output ", options.output), std::pair("--depth ", options.depth),
          std::pair("--scan-labels ", options.scan_labels),
          std::pair("--scan-depth ", options.scan_depth)})
      if (std::filesystem::equivalent(options.sequence + name, folder, error))
        fail<InvalidParameterException>(option, folder,
                                        ": holds files of the sequence");
  if (!options.depth.empty() &&
      std::filesystem::weakly_canonical(options.depth, error) ==
          std::filesystem::weakly_canonical(options.output, error))
    fail<InvalidParameterException>("--depth and --output are one folder");
}

// Writes what is asked for of one scan.
void
writeTruth(const Options& options, int frame,
           const pcl::PointCloud<pcl::PointXYZI>& scan, std::vector<Label> labels,
           const StereoCamera& camera, const Eigen::Isometry3d& T_camera_velodyne)
{
  const LidarTruth truth =
      projectLidarTruth(scan, labels, camera, T_camera_velodyne, options.parameters);
  writePng(options.output + "/" + frameFileName(frame, ".png"), truth.labels);
  if (!options.depth.empty())
    writeDepthImage(options.depth + "/" + frameFileName(frame, ".png"), truth.depth);
  if (options.scan_labels.empty() && options.scan_depth.empty())
    return;
  const std::vector<float> seen =
      seenDepths(scan, camera, T_camera_velodyne, options.parameters);
  for (std::size_t i = 0; i < seen.size(); ++i)
    if (seen[i] == 0.0f)
      labels[i] = kUnlabelled;
  if (!options.scan_labels.empty())
    writeScanLabels(options.scan_labels + "/" + frameFileName(frame, ".label"), labels);
  if (!options.scan_depth.empty())
    writePointDepths(options.scan_depth + "/" + frameFileName(frame, ".bin"), seen);
}

int
project(const Options& options)
{
  refuseInputFolders(options);
  const FrameRange range = parseFrameRange(options.frames);
  if (!(options.parameters.max_depth > 0.0))
    fail<InvalidParameterException>("--max-depth is ", options.parameters.max_depth,
                                    ", expected more than 0");
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
    fail<BadInputException>(options.sequence, "/velodyne: holds no scan of the frames ",
                            options.frames);

  for (const std::string& folder :
       {options.output, options.depth, options.scan_labels, options.scan_depth})
    if (!folder.empty())
      makeOutputFolder(folder);
  ProgressBar progress("projecting", scans.size());
  for (const FrameFile& file : scans) {
    const auto scan = readVelodyneScan(file.path);
    writeTruth(options, file.frame, *scan,
               readSemanticKittiLabels(options.sequence + "/labels/" +
                                           frameFileName(file.frame, ".label"),
                                       mapping, scan->size()),
               sequence.camera(), T_camera_velodyne);
    progress.step();
  }
  printResults({{"images", scans.size()}, {"truth", options.output}});
  return exit_done;
}

} // namespace

int
main(int argc, char** argv)
{
  return run(usage.name, [&] { return project(parse(argc, argv)); });
}
