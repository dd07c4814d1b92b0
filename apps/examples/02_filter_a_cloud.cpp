// SPDX-License-Identifier: BSD-3-Clause

// 02: SemanticCRF is a pcl::Filter that makes the labels of a cloud consistent.
//
//   02_filter_a_cloud                      a cloud of the synthetic street
//   02_filter_a_cloud IN.pcd [OUT.pcd]     any .pcd with x y z label

#include "synthesize/sequence.h"

#include <pcl_semantic/files/cloud_file.h>
#include <pcl_semantic/filters/semantic_crf.h>
#include <pcl_semantic/stereo/disparity_to_cloud.h>

#include <pcl/common/io.h>

#include <iostream>

using namespace pcl_semantic;

namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZRGBL>;

// Sets the confidence of the labels and the input, and filters.
void
refine(LabelledCloud& labelled)
{
  SemanticCRF<pcl::PointXYZRGBL> crf;
  if (labelled.distributions.empty()) {
    int classes = 1;
    for (const pcl::PointXYZRGBL& point : *labelled.cloud)
      classes = std::max(classes, int(point.label));
    crf.setLabelConfidence(0.8, classes); // each label is correct with 80 %
  }
  else
    crf.setLabelDistributions(labelled.distributions);
  crf.setUseColour(labelled.has_colour); // otherwise positions only
  crf.setInputCloud(labelled.cloud);
  crf.filter(*labelled.cloud); // in place, or to another cloud
  labelled.distributions = crf.getLabelDistributions();
}

// The points of a stereo camera, with a network's class probabilities per pixel.
LabelledCloud
cloudOfTheStreet(const SyntheticSequence& street, const SyntheticView& view)
{
  LabelledCloud labelled;
  pcl::copyPointCloud(*disparityToCloud(view.disparity, view.left, view.camera),
                      *labelled.cloud);
  labelled.distributions = street.labels(0);
  for (std::size_t i = 0; i < labelled.cloud->size(); ++i)
    (*labelled.cloud)[i].label = labelled.distributions.mapLabel(Eigen::Index(i));
  labelled.has_colour = labelled.has_labels = true;
  return labelled;
}

template <typename IsWrong>
std::size_t
count(const Cloud& cloud, IsWrong is_wrong)
{
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i)
    wrong += pcl::isFinite(cloud[i]) && is_wrong(i, cloud[i].label);
  return wrong;
}

} // namespace

int
main(int argc, char** argv)
try {
  const SyntheticSequence street(1, 416, 128);
  const SyntheticView view = street.view(0);
  LabelledCloud labelled =
      argc > 1 ? readLabelledCloud(argv[1]) : cloudOfTheStreet(street, view);
  moveToVoxelCentres(labelled); // as in a map, for setVoxels()
  const Cloud before = *labelled.cloud;
  refine(labelled);
  std::cout << count(*labelled.cloud,
                     [&](auto i, auto label) { return label != before[i].label; })
            << " of " << before.size() << " labels changed\n";
  if (argc > 2)
    writeLabelledCloud(argv[2], labelled);
  if (argc > 1)
    return 0;
  const auto is_wrong = [&](auto i, auto label) {
    return label != view.labels.data[i];
  };
  std::cout << "wrong before: " << count(before, is_wrong)
            << "\nwrong after: " << count(*labelled.cloud, is_wrong) << "\n";
}
catch (const std::exception& error) {
  std::cerr << argv[0] << ": " << error.what() << "\n";
  return 1;
}
