// SPDX-License-Identifier: BSD-3-Clause

// Superpixels compared with OpenCV's (ximgproc, 200 segments, 10 iterations), in time
// and against manual ground truth; supervoxels compared with pcl::SupervoxelClustering.
// Two threads.

#include "bench/kitti_map.h"
#include "bench/ratio.h"

#include <pcl_semantic/cliques/supervoxel_cliques.h>
#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/images/image_file.h>
#include <pcl_semantic/stereo/disparity_engines.h>
#include <pcl_semantic/stereo/disparity_to_cloud.h>
#include <pcl_semantic/superpixels/superpixel_cliques.h>

#include <opencv2/imgproc.hpp>
#include <opencv2/ximgproc/slic.hpp>
#include <pcl/common/io.h>
#include <pcl/segmentation/supervoxel_clustering.h>

#include <algorithm>
#include <map>

namespace {

using namespace pcl_semantic;

// Images with manual ground truth.
const std::pair<const char*, int> truths[] = {{"15", 0}, {"15", 3}, {"05", 0}};

cv::Mat
superpixelsOfOpenCV(const cv::Mat& image)
{
  // Its documentation uses ten iterations and 200 segments for this image.
  const int size = int(std::sqrt(double(image.total()) / 200.0));
  cv::Mat lab, segments;
  cv::GaussianBlur(image, lab, cv::Size(3, 3), 0.0); // advised by its documentation
  cv::cvtColor(lab, lab, cv::COLOR_BGR2Lab);
  const auto slic =
      cv::ximgproc::createSuperpixelSLIC(lab, cv::ximgproc::SLIC, size, 10.0f);
  slic->iterate(10);
  slic->enforceLabelConnectivity(25);
  slic->getLabels(segments);
  return segments;
}

/** \brief Quality of superpixels against ground truth. */
struct Quality {
  double recall = 0.0; ///< of the ground truth's border pixels with a superpixel border
                       ///< within two pixels [%]
  double error = 0.0;  ///< undersegmentation: pixels outside the majority class
                       ///< of their superpixel [%]
  int count = 0;
};

// Pixels whose right or lower neighbour has another number.
cv::Mat1b
bordersOf(const cv::Mat& numbers)
{
  cv::Mat1b borders(numbers.size(), std::uint8_t(0));
  const auto at = [&](int v, int u) { return numbers.at<int>(v, u); };
  for (int v = 0; v + 1 < numbers.rows; ++v)
    for (int u = 0; u + 1 < numbers.cols; ++u)
      if (at(v, u) != at(v, u + 1) || at(v, u) != at(v + 1, u))
        borders(v, u) = 255;
  return borders;
}

Quality
qualityOf(const cv::Mat& segments, const cv::Mat& truth)
{
  cv::Mat classes, near;
  truth.convertTo(classes, CV_32S);
  const cv::Mat1b wanted = bordersOf(classes);
  cv::dilate(bordersOf(segments), near, cv::Mat::ones(5, 5, CV_8U));
  Quality quality;
  quality.recall =
      100.0 * cv::countNonZero(wanted & near) / double(cv::countNonZero(wanted));
  std::map<int, std::map<int, int>> counts;
  int labelled = 0;
  for (int v = 0; v < truth.rows; ++v)
    for (int u = 0; u < truth.cols; ++u)
      if (const int label = classes.at<int>(v, u); label != 0) {
        ++counts[segments.at<int>(v, u)][label];
        ++labelled;
      }
  int stray = 0;
  for (const auto& [segment, by_class] : counts) {
    int sum = 0, most = 0;
    for (const auto& [label, count] : by_class) {
      sum += count;
      most = std::max(most, count);
    }
    stray += sum - most;
  }
  quality.error = 100.0 * stray / labelled;
  quality.count = int(counts.size());
  return quality;
}

Quality
meanQuality(const std::string& data, const std::function<cv::Mat(const cv::Mat&)>& make)
{
  Quality mean;
  for (const auto& [sequence, number] : truths) {
    char name[16];
    std::snprintf(name, sizeof name, "/%06d.png", number);
    const std::string folder = data + "/kitti/" + sequence;
    const cv::Mat image =
        readPng(folder + "/image_2" + name, ImageKind::grey_or_colour);
    const Quality one =
        qualityOf(make(image), readPng(folder + "/gt" + name, ImageKind::labels));
    mean.recall += one.recall / double(std::size(truths));
    mean.error += one.error / double(std::size(truths));
    mean.count += one.count / int(std::size(truths));
  }
  return mean;
}

void
printQuality(const char* name, const Quality& quality)
{
  std::printf("  %-28s %4d superpixels, recall %.1f %%, error %.2f %%\n", name,
              quality.count, quality.recall, quality.error);
}

void
benchSuperpixels(const std::string& data)
{
  const KittiSequence sequence(data + "/kitti/15");
  const StereoFrame frame = sequence.frame(0);
  const double theirs = medianSeconds(5, [&] { superpixelsOfOpenCV(frame.left); });
  const double ours =
      medianSeconds(9, [&] { slicSuperpixels(frame.left, SlicParameters()); });
  std::printf("superpixels of %d x %d: ours %.1f ms, OpenCV's %.1f ms\n",
              frame.left.cols, frame.left.rows, 1e3 * ours, 1e3 * theirs);
  const Quality their_quality = meanQuality(data, superpixelsOfOpenCV);
  printQuality("OpenCV's, 200, 10 iterations", their_quality);
  const auto ourQuality = [&](int superpixels, int downscale) {
    SlicParameters parameters;
    parameters.superpixels = superpixels;
    parameters.downscale = downscale;
    return meanQuality(
        data, [&](const cv::Mat& image) { return slicSuperpixels(image, parameters); });
  };
  printQuality("ours, 150", ourQuality(150, 2));
  printQuality("ours, 200, at full size", ourQuality(200, 1));
  const Quality our_quality = ourQuality(200, 2); // the same number as OpenCV's
  printQuality("ours, 200", our_quality);
  printRatio("cliques_slic_vs_ximgproc", theirs / ours, 10);
  printRatio("cliques_slic_recall_vs_ximgproc",
             our_quality.recall / their_quality.recall, 1);
  printRatio("cliques_slic_error_vs_ximgproc", their_quality.error / our_quality.error,
             1);
}

void
benchProjection(const std::string& data, const VoxelCloud& voxels)
{
  const KittiSequence sequence(data + "/kitti/15");
  const std::size_t last = sequence.size() - 1;
  const StereoFrame frame = sequence.frame(last);
  const auto stereo = makeDisparityEstimator("sgm", 128);
  const auto cloud =
      disparityToCloud(stereo->estimate(frame.left, frame.right).disparity, frame.left,
                       sequence.camera());
  const auto poses = readPoses(sequence.posesPath(), sequence.T_camera0_camera());
  SuperpixelCliques generator;
  generator.setFrame(cloud, poses->pose(frame));
  generator.setVoxels(voxels.indices, voxels.voxel_size);
  CliqueGenerator::Cloud points;
  pcl::copyPointCloud(*voxels.cloud, points);
  std::size_t cliques = 0, members = 0;
  const double seconds = medianSeconds(9, [&] {
    members = 0;
    const auto made = generator.generate(points);
    cliques = made.size();
    for (const pcl::PointIndices& clique : made)
      members += clique.indices.size();
  });
  std::printf("superpixels in %zu voxels: %.1f ms; %zu cliques of %zu voxels\n",
              voxels.size(), 1e3 * seconds, cliques, members);
  printRatio("cliques_superpixel_frames_per_30ms", 0.03 / seconds, 1);
}

double
plainSupervoxels(const CliqueGenerator::Cloud::ConstPtr& points)
{
  return medianSeconds(3, [&] {
    pcl::SupervoxelClustering<pcl::PointXYZRGB> clustering(0.1f, 0.8f);
    clustering.setInputCloud(points);
    std::map<std::uint32_t, pcl::Supervoxel<pcl::PointXYZRGB>::Ptr> supervoxels;
    clustering.extract(supervoxels);
    clustering.getLabeledCloud();
  });
}

void
benchSupervoxels(const VoxelCloud& voxels)
{
  const auto points = std::make_shared<CliqueGenerator::Cloud>();
  pcl::copyPointCloud(*voxels.cloud, *points);
  const double theirs = plainSupervoxels(points);
  std::size_t cliques = 0, members = 0;
  const double ours = medianSeconds(5, [&] {
    const auto made = SupervoxelCliques().generate(*points);
    cliques = made.size();
    members = 0;
    for (const pcl::PointIndices& clique : made)
      members += clique.indices.size();
  });
  SupervoxelCliques again;
  const double unchanged = medianSeconds(5, [&] { again.generate(*points); });
  std::printf("supervoxels of %zu voxels: ours %.0f ms (%zu cliques of %zu voxels), "
              "nothing changed %.1f ms, PCL's %.0f ms\n",
              points->size(), 1e3 * ours, cliques, members, 1e3 * unchanged,
              1e3 * theirs);
  printRatio("cliques_supervoxel_vs_pcl", theirs / ours, 1);
  printRatio("cliques_supervoxel_unchanged_vs_pcl", theirs / unchanged, 10);
}

} // namespace

int
main()
{
  if (realDataFolder().empty()) {
    std::printf("PCL_SEMANTIC_DATA is not set: nothing to compare\n");
    return 0;
  }
  setNumberOfThreads(2);
  benchSuperpixels(realDataFolder());
  for (const double max_depth : {20.0, 40.0}) {
    const VoxelCloud voxels = makeKittiMap(max_depth);
    benchProjection(realDataFolder(), voxels);
    benchSupervoxels(voxels);
  }
  return 0;
}
