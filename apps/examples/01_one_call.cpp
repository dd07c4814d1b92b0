// SPDX-License-Identifier: BSD-3-Clause

// 01: a folder of stereo images becomes a labelled voxel map, in one call.
//
//   01_one_call                        maps four frames of a synthetic street
//   01_one_call SEQUENCE [MAP.pcd]     maps a folder in KITTI's layout with labels/

#include "synthesize/sequence.h"

#include <pcl_semantic/dataset/kitti_sequence.h>
#include <pcl_semantic/files/data_folder.h>
#include <pcl_semantic/files/label_set_file.h>
#include <pcl_semantic/io/voxel_cloud_file.h>
#include <pcl_semantic/labelling/stored_predictor.h>
#include <pcl_semantic/pipeline/map_sequence.h>

#include <iostream>

using namespace pcl_semantic;

namespace {

// Labels come from a folder (here), a network (NetworkPredictor), or a class of your
// own like StreetLabels below.
VoxelCloud
mapFolder(const std::string& folder, const LabelSet& classes)
{
  const KittiSequence sequence(folder);
  return mapSequence(
      sequence, classes,
      std::make_unique<StoredPredictor>(folder + "/labels", classes.size(), 0.8f));
}

// The street's labels with typical mistakes of networks.
class StreetLabels : public LabelPredictor {
public:
  explicit StreetLabels(const SyntheticSequence& street) : street_(street) {}

  LabelDistributions
  predict(const cv::Mat& /*image*/, int frame) override
  {
    return street_.labels(std::size_t(frame));
  }

private:
  const SyntheticSequence& street_;
};

VoxelCloud
mapStreet(const LabelSet& classes)
{
  const SyntheticSequence street(4, 310, 94);
  return mapSequence(street, classes, std::make_unique<StreetLabels>(street));
}

void
print(const VoxelCloud& map, const LabelSet& classes)
{
  std::vector<int> counts(std::size_t(classes.size()) + 1);
  for (const pcl::PointXYZRGBL& voxel : *map.cloud)
    ++counts[voxel.label];
  std::cout << map.size() << " voxels of " << map.voxel_size << " m\n";
  for (std::size_t label = 0; label < counts.size(); ++label)
    if (counts[label] > 0)
      std::cout << counts[label] << " " << classes[Label(label)].name << "\n";
}

} // namespace

int
main(int argc, char** argv)
try {
  const LabelSet classes = readLabelSet(findDataFile("label_sets/kitti11.yaml"));
  const VoxelCloud map = argc > 1 ? mapFolder(argv[1], classes) : mapStreet(classes);
  print(map, classes);
  if (argc > 2) // for pcl_viewer
    writeVoxelCloud(argv[2], map, classes, VoxelColour::classes);
}
catch (const std::exception& error) {
  std::cerr << argv[0] << ": " << error.what() << "\n";
  return 1;
}
