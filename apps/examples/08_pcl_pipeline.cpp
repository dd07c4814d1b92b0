// SPDX-License-Identifier: BSD-3-Clause

// 08: SemanticCRF between PCL's own filters, on clouds with fields found by name.
//
//   08_pcl_pipeline IN.pcd OUT.pcd CLASS    any .pcd with x y z label
//   08_pcl_pipeline                         two walls, every seventh label wrong
//
// Keep one point per voxel, drop outliers, make labels consistent, extract a class. All
// fields of IN.pcd are in OUT.pcd.

#include <pcl_semantic/filters/label_voxel_grid.h>
#include <pcl_semantic/filters/semantic_crf.h>

#include <pcl/common/io.h>
#include <pcl/conversions.h>
#include <pcl/filters/extract_indices.h>
#include <pcl/filters/statistical_outlier_removal.h>
#include <pcl/io/pcd_io.h>
#include <pcl/point_types.h>

#include <cstdlib>
#include <iostream>

namespace {

using Blob = pcl::PCLPointCloud2;

// A wall of class 1 and one of class 2, every seventh label wrong.
void
drawWalls(Blob& cloud)
{
  pcl::PointCloud<pcl::PointXYZL> walls;
  for (int i = 0; i < 10000; ++i) {
    const auto along = 0.05f * (0.5f + float(i % 100)),
               up = 0.05f * (0.5f + float(i / 100 % 50));
    const bool first = i < 5000, wrong = i % 7 == 0;
    pcl::PointXYZL point;
    point.getVector3fMap() << along, (first ? 0.0f : 3.0f), up;
    point.label = first != wrong ? 1 : 2;
    walls.push_back(point);
  }
  pcl::toPCLPointCloud2(walls, cloud);
}

// Replaces the cloud by the output of a filter.
template <typename Filter>
void
apply(Filter& filter, Blob::Ptr& cloud)
{
  Blob::Ptr output(new Blob);
  filter.setInputCloud(cloud);
  filter.filter(*output);
  cloud = output;
}

} // namespace

int
main(int argc, char** argv)
try {
  Blob::Ptr cloud(new Blob);
  if (argc < 4)
    drawWalls(*cloud);
  else if (pcl::io::loadPCDFile(argv[1], *cloud) < 0)
    throw std::runtime_error(std::string(argv[1]) + ": cannot be read");
  const auto wanted = argc < 4 ? 1u : unsigned(std::atoi(argv[3]));

  // One point per voxel; pcl::VoxelGrid would average labels.
  pcl_semantic::LabelVoxelGrid grid;
  grid.setLeafSize(0.1);
  apply(grid, cloud);

  pcl::StatisticalOutlierRemoval<Blob> outliers;
  outliers.setMeanK(16);
  outliers.setStddevMulThresh(3.0);
  apply(outliers, cloud);

  pcl_semantic::SemanticCRF<Blob> crf;
  if (pcl::getFieldIndex(*cloud, "probability") < 0)
    crf.setLabelConfidence(0.8, 255);
  apply(crf, cloud);

  pcl::PointCloud<pcl::PointXYZL> labelled;
  pcl::fromPCLPointCloud2(*cloud, labelled);
  const pcl::IndicesPtr of_class(new pcl::Indices);
  for (std::size_t i = 0; i < labelled.size(); ++i)
    if (labelled[i].label == wanted)
      of_class->push_back(pcl::index_t(i));
  pcl::ExtractIndices<Blob> extract;
  extract.setIndices(of_class);
  apply(extract, cloud);

  std::cout << cloud->width * cloud->height << " points of class " << wanted << "\n";
  if (argc > 3 && pcl::io::savePCDFile(argv[2], *cloud) < 0)
    throw std::runtime_error(std::string(argv[2]) + ": cannot be written");
}
catch (const std::exception& error) {
  std::cerr << argv[0] << ": " << error.what() << "\n";
  return 1;
}
