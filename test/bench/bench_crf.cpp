// SPDX-License-Identifier: BSD-3-Clause

// The CRF over voxel clouds, compared with alternatives: a plain single-thread
// permutohedral mean field, and pcl::DenseCrf. All have the same kernels, weights and
// self-interaction. The CRF uses two threads, or OMP_NUM_THREADS.

#include "bench/exact_mean_field.h"
#include "bench/kitti_map.h"
#include "bench/ratio.h"
#include "support/plain_lattice.h"
#include "support/street_scans.h"

#include <pcl_semantic/cliques/cube_cliques.h>
#include <pcl_semantic/core/threads.h>

#include <pcl/common/io.h>
#include <pcl/ml/densecrf.h>

#include <malloc.h>

#include <cstdio>
#include <fstream>
#include <random>

namespace {

using namespace pcl_semantic;
using Crf = SemanticCRF<pcl::PointXYZRGBL>;

SemanticCRFParameters
benchParameters(int iterations)
{
  SemanticCRFParameters parameters; // 0.2 m weight 3; 0.2 m and 8 levels weight 8
  parameters.iterations = iterations;
  parameters.self_interaction = true; // like the others
  return parameters;
}

LabelDistributions
runOurs(const VoxelCloud& voxels, int iterations)
{
  Crf crf;
  crf.setParameters(benchParameters(iterations));
  crf.setInputCloud(voxels.cloud);
  crf.setLabelDistributions(voxels.measured);
  pcl::PointCloud<pcl::PointXYZRGBL> output;
  crf.filter(output);
  return crf.getLabelDistributions();
}

void
runHierarchical(const VoxelCloud& voxels, int iterations,
                const std::vector<pcl::PointIndices>& cliques)
{
  Crf crf;
  crf.setModel(CRFModelType::hierarchical);
  crf.setParameters(benchParameters(iterations));
  crf.setCliques(cliques);
  crf.setInputCloud(voxels.cloud);
  crf.setLabelDistributions(voxels.measured);
  pcl::PointCloud<pcl::PointXYZRGBL> output;
  crf.filter(output);
}

std::vector<pcl::PointIndices>
cubesOf(const VoxelCloud& voxels)
{
  pcl::PointCloud<pcl::PointXYZRGB> cloud;
  pcl::copyPointCloud(*voxels.cloud, cloud);
  return CubeCliques(1.0).generate(cloud);
}

Eigen::MatrixXf
costsOf(const VoxelCloud& voxels)
{
  return -voxels.measured.matrix().array().max(1e-6f).log();
}

void
runPlainLattice(const VoxelCloud& voxels, int iterations)
{
  const auto count = Eigen::Index(voxels.size());
  Eigen::MatrixXf places(3, count), both(6, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const pcl::PointXYZRGBL& point = (*voxels.cloud)[std::size_t(i)];
    places.col(i) = point.getVector3fMap() / 0.2f;
    both.col(i) << places.col(i), float(point.r) / 8.0f, float(point.g) / 8.0f,
        float(point.b) / 8.0f;
  }
  plainLatticeMeanField(costsOf(voxels), {places, both}, {3.0f, 8.0f}, iterations,
                        true);
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
  const Eigen::MatrixXf unary = costsOf(voxels);
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

// Prints a figure with an upper limit, as ratio of limit to value.
void
printLimit(const std::string& name, double value, double limit)
{
  std::printf("%s: %.4f, expected at most %g\n", name.c_str(), value, limit);
  printRatio(name, limit / value, 1);
}

void
compareModels(const std::string& name, const VoxelCloud& voxels, double target_plain,
              double target_pcl)
{
  std::printf("%s: %zu voxels, %d labels\n", name.c_str(), voxels.size(),
              voxels.measured.classes());
  const auto cubes = cubesOf(voxels);
  for (const int iterations : {1, 5}) {
    const double ours = medianSeconds(7, [&] { runOurs(voxels, iterations); });
    const double hierarchical =
        medianSeconds(7, [&] { runHierarchical(voxels, iterations, cubes); });
    const double plain = medianSeconds(1, [&] { runPlainLattice(voxels, iterations); });
    const double pcl = secondsOf([&] { runPcl(voxels, iterations); });
    std::printf("%d update(s), set-up included: dense %.4f s, hierarchical %.4f s, "
                "plain lattice %.3f s, pcl::DenseCrf %.3f s\n",
                iterations, ours, hierarchical, plain, pcl);
    const std::string what = name + "_" + std::to_string(iterations) + "_updates_";
    printRatio("crf_" + what + "vs_plain_lattice", plain / ours,
               iterations == 1 ? 10 : target_plain);
    printRatio("crf_" + what + "vs_pcl", pcl / ours, iterations == 1 ? 0 : target_pcl);
    printLimit("crf_" + what + "hierarchical_over_dense", hierarchical / ours, 1.15);
  }
}

void
compareWithExact(const std::string& name, const VoxelCloud& voxels)
{
  const ExactKernel exact(voxels, benchParameters(1));
  for (const int iterations : {1, 5}) {
    const MarginalError error(runOurs(voxels, iterations).matrix(),
                              exact.run(voxels.measured, iterations));
    const std::string what = name + "_" + std::to_string(iterations) + "_updates_";
    printRatio("crf_" + what + "equal_labels", 100.0 * error.equal, 99.5);
    printLimit("crf_" + what + "mean_error", error.mean, 0.02);
    printLimit("crf_" + what + "percentile_99", error.percentile99, 0.1);
  }
}

// Returns copies of a map side by side, or its first voxels.
VoxelCloud
resized(const VoxelCloud& voxels, std::size_t count, int labels)
{
  VoxelCloud result;
  result.voxel_size = voxels.voxel_size;
  std::mt19937 random(1);
  std::uniform_real_distribution<float> weight(0.01f, 1.0f);
  Eigen::MatrixXf weights(labels, Eigen::Index(count));
  for (std::size_t i = 0; i < count; ++i) {
    pcl::PointXYZRGBL point = (*voxels.cloud)[i % voxels.size()];
    point.y += 200.0f * float(i / voxels.size());
    result.cloud->push_back(point);
    for (int k = 0; k < labels; ++k)
      weights(k, Eigen::Index(i)) = std::pow(weight(random), 4.0f);
  }
  result.measured = LabelDistributions(std::move(weights));
  return result;
}

long
statusOf(const std::string& field)
{
  std::ifstream file("/proc/self/status");
  for (std::string line; std::getline(file, line);)
    if (line.rfind(field, 0) == 0)
      return std::atol(line.c_str() + field.size() + 1);
  return 0;
}

void
measureGrowth(const VoxelCloud& voxels)
{
  std::vector<double> seconds;
  for (const std::size_t count : {10000, 100000, 1000000}) {
    const VoxelCloud part = resized(voxels, count, 11);
    malloc_trim(0);                                // returns freed memory
    std::ofstream("/proc/self/clear_refs") << "5"; // resets the peak
    const long before = statusOf("VmRSS:");
    seconds.push_back(
        medianSeconds(count < 1000000 ? 5 : 1, [&] { runOurs(part, 1); }));
    std::printf("%zu voxels: %.4f s\n", count, seconds.back());
    if (count == 1000000)
      printLimit("crf_bytes_a_voxel",
                 double(statusOf("VmHWM:") - before) * 1024.0 / double(count), 1000);
  }
  printLimit("crf_slope_in_points", std::log10(seconds[2] / seconds[0]) / 2.0, 1.1);
  std::vector<double> by_labels;
  for (const int labels : {2, 64}) {
    const VoxelCloud part = resized(voxels, 50000, labels);
    by_labels.push_back(medianSeconds(5, [&] { runOurs(part, 5); }));
    std::printf("%d labels: %.4f s\n", labels, by_labels.back());
  }
  printLimit("crf_slope_in_labels",
             std::log(by_labels[1] / by_labels[0]) / std::log(32.0), 1.1);
}

void
measure(const std::string& name, const VoxelCloud& voxels, double target_plain,
        double target_pcl)
{
  compareModels(name, voxels, target_plain, target_pcl);
  compareWithExact(name, voxels);
}

} // namespace

int
main()
{
  VoxelCloud street = makeStreetMap(12);
  street.moveToCentres();
  measure("street", street, 8, 40);
  VoxelCloud kitti;
  if (!realDataFolder().empty()) {
    kitti = makeKittiMap(20.0);
    measure("kitti_20m", kitti, 8, 40);
    measure("kitti_40m", makeKittiMap(40.0), 10, 80);
  }
  measureGrowth(kitti.size() > 0 ? kitti : street);
  return 0;
}
