/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

// The dense CRF over a voxel map of the synthetic street, against pcl::DenseCrf: what
// PCL users have today. Same kernels, weights and updates on both sides.

#include "bench/ratio.h"
#include "support/street_scans.h"

#include <pcl_semantic/filters/semantic_crf.h>

#include <pcl/ml/densecrf.h>

#include <cstdio>

namespace {

using namespace pcl_semantic;

void
runOurs(const VoxelCloud& voxels, int iterations)
{
  SemanticCRFParameters parameters;
  parameters.iterations = iterations;
  SemanticCRF<pcl::PointXYZRGBL> crf;
  crf.setParameters(parameters);
  crf.setInputCloud(voxels.cloud);
  crf.setLabelDistributions(voxels.measured);
  pcl::PointCloud<pcl::PointXYZRGBL> output;
  crf.filter(output);
}

void
runPcl(const VoxelCloud& voxels, int iterations)
{
  using IntVectors =
      std::vector<Eigen::Vector3i, Eigen::aligned_allocator<Eigen::Vector3i>>;
  IntVectors positions, colours;
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    const pcl::PointXYZRGBL& point = (*voxels.cloud)[i];
    positions.push_back(voxels.indices[i]);
    colours.emplace_back(point.r, point.g, point.b);
  }
  const Eigen::MatrixXf unary = -voxels.measured.matrix().array().max(1e-6f).log();
  const int labels = voxels.measured.classes();
  pcl::DenseCrf crf(int(voxels.size()), labels);
  crf.setDataVector(positions);
  crf.setColorVector(colours);
  crf.setUnaryEnergy(std::vector<float>(unary.data(), unary.data() + unary.size()));
  crf.addPairwiseGaussian(2, 2, 2, 3); // 0.2 m in voxels
  crf.addPairwiseBilateral(2, 2, 2, 8, 8, 8, 8);
  std::vector<float> result(voxels.size() * std::size_t(labels));
  crf.inference(iterations, result, 1.0f);
}

} // namespace

int
main()
{
  const VoxelCloud voxels = makeStreetMap(6);
  std::printf("%zu voxels, %d labels\n", voxels.size(), voxels.measured.classes());
  for (const int iterations : {1, 5}) {
    const double ours = medianSeconds(5, [&] { runOurs(voxels, iterations); });
    const double pcl = medianSeconds(1, [&] { runPcl(voxels, iterations); });
    std::printf("%d update(s), set-up included: %.3f s, pcl::DenseCrf %.3f s\n",
                iterations, ours, pcl);
    printRatio("crf_" + std::to_string(iterations) + "_updates_vs_pcl", pcl / ours, 5);
  }
  return 0;
}
