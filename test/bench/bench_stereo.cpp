// SPDX-License-Identifier: BSD-3-Clause

// Disparities against lidar, on all frames of five KITTI sequences, two threads; every
// engine is compared with OpenCV's semi-global matching in three directions. A second
// comparison uses Middlebury's cones.
//
// Ground truth: returns projected into the left image, the nearest per pixel, without
// those that seenPoints() finds hidden from the camera.

#include "bench/ratio.h"

#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/dataset/kitti_sequence.h>
#include <pcl_semantic/dataset/lidar_scan.h>
#include <pcl_semantic/images/image_file.h>
#include <pcl_semantic/labelling/visible_points.h>
#include <pcl_semantic/stereo/disparity_engines.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>

namespace {

using namespace pcl_semantic;

constexpr double max_depth = 200.0; // above the scanner's range [m]
const char* const sequences[] = {"00", "03", "05", "07", "09"};

struct Engine {
  const char *name, *engine; // printed name; name for makeDisparityEstimator()
};

// The first is the reference.
const Engine engines[] = {{"sgbm_3way", "sgbm"}, {"elas", "elas"}, {"sgm", "sgm"}};

/** \brief Result of an engine at the pixels of the ground truth. */
struct Result {
  std::vector<double> seconds;  ///< per frame
  std::vector<float> disparity; ///< 0 = none
  std::vector<float> deviation; ///< estimated by the engine
};

struct Score {
  double share = 0.0;  ///< of all pixels [%]
  double median = 0.0; ///< error [px]
  double wrong = 0.0;  ///< of the pixels counted [%]
};

struct Truth {
  std::vector<float> disparity;
  double wrong_above;       ///< threshold of a gross error [px] ...
  double wrong_above_share; ///< ... and above this fraction of the disparity
};

double
median(std::vector<double> values)
{
  if (values.empty())
    return 0.0;
  std::nth_element(values.begin(), values.begin() + long(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

template <typename Counted>
Score
scoreOf(const Truth& truth, const Result& result, Counted&& counted)
{
  std::vector<double> errors;
  double wrong = 0.0;
  for (std::size_t i = 0; i < truth.disparity.size(); ++i) {
    if (!counted(i))
      continue;
    const double error = std::abs(double(result.disparity[i] - truth.disparity[i]));
    errors.push_back(error);
    wrong += error > truth.wrong_above &&
             error > truth.wrong_above_share * double(truth.disparity[i]);
  }
  const double count = std::max(1.0, double(errors.size()));
  return {100.0 * double(errors.size()) / double(truth.disparity.size()),
          median(errors), 100.0 * wrong / count};
}

Score
scoreOfValid(const Truth& truth, const Result& result)
{
  return scoreOf(truth, result, [&](std::size_t i) { return result.disparity[i] > 0; });
}

// Pixels without a disparity count as wrong.
double
wrongOfAll(const Truth& truth, const Result& result)
{
  const Score valid = scoreOfValid(truth, result);
  return 100.0 - valid.share * (1.0 - valid.wrong / 100.0);
}

// Fraction of correct pixels with an error within the deviation; 68 % for a standard
// deviation.
double
withinDeviation(const Truth& truth, const Result& result)
{
  double right = 0.0, within = 0.0;
  for (std::size_t i = 0; i < truth.disparity.size(); ++i) {
    const double error = std::abs(double(result.disparity[i] - truth.disparity[i]));
    if (result.disparity[i] <= 0 || error > truth.wrong_above)
      continue;
    ++right;
    within += error <= double(result.deviation[i]);
  }
  return 100.0 * within / std::max(1.0, right);
}

cv::Mat1f
lidarDisparities(const KittiSequence& sequence, int number)
{
  char name[16];
  std::snprintf(name, sizeof name, "/%06d.bin", number);
  const auto scan = readVelodyneScan(sequence.folder() + "/velodyne" + name);
  const Eigen::Isometry3d T_camera_scanner =
      sequence.T_camera0_camera().inverse() * sequence.T_camera0_velodyne();
  const StereoCamera& camera = sequence.camera();
  VisibilityParameters parameters;
  parameters.max_depth = max_depth;
  cv::Mat1f disparities(camera.height, camera.width, 0.0f);
  for (const SeenPoint& point :
       seenPoints(pointsInCamera(*scan, T_camera_scanner), camera, parameters))
    if (point.depth > 0.0f) {
      float& disparity = disparities(point.row, point.column);
      disparity = std::max(disparity, float(camera.fx * camera.baseline / point.depth));
    }
  return disparities;
}

void
estimate(DisparityEstimator& engine, const StereoFrame& frame, const cv::Mat1f& truth,
         Result& result)
{
  DisparityImage image;
  result.seconds.push_back(
      secondsOf([&] { image = engine.estimate(frame.left, frame.right); }));
  for (int v = 0; v < truth.rows; ++v)
    for (int u = 0; u < truth.cols; ++u)
      if (truth(v, u) > 0.0f) {
        result.disparity.push_back(image.disparity.at<float>(v, u));
        result.deviation.push_back(image.deviation.at<float>(v, u));
      }
}

void
append(const cv::Mat1f& disparities, Truth& truth)
{
  std::copy_if(disparities.begin(), disparities.end(),
               std::back_inserter(truth.disparity), [](float d) { return d > 0.0f; });
}

void
printTable(const Truth& truth, const std::vector<Result>& results)
{
  std::printf("%zu pixels with truth; wrong: more than %g px and %g %% off\n",
              truth.disparity.size(), truth.wrong_above,
              100.0 * truth.wrong_above_share);
  std::printf(
      "  %-12s %8s %8s %11s %8s %8s %8s | valid in both: median, its; D1, its\n",
      "engine", "time", "valid", "median", "D1", "D1 all", "in sigma");
  for (std::size_t e = 0; e < results.size(); ++e) {
    const Score score = scoreOfValid(truth, results[e]);
    const auto in_both = [&](std::size_t i) {
      return results[0].disparity[i] > 0 && results[e].disparity[i] > 0;
    };
    const Score ours = scoreOf(truth, results[e], in_both);
    const Score its = scoreOf(truth, results[0], in_both);
    std::printf("  %-12s %6.1f ms %6.2f %% %8.4f px %6.2f %% %6.2f %% %6.1f %% | %.4f "
                "px, %.4f px; %.2f %%, %.2f %%\n",
                engines[e].name, 1e3 * median(results[e].seconds), score.share,
                score.median, score.wrong, wrongOfAll(truth, results[e]),
                withinDeviation(truth, results[e]), ours.median, its.median, ours.wrong,
                its.wrong);
  }
}

void
printRatios(const Truth& truth, const std::vector<Result>& results)
{
  for (std::size_t e = 1; e < results.size(); ++e) {
    const std::string name = std::string("stereo_") + engines[e].name + "_";
    const auto in_both = [&](std::size_t i) {
      return results[0].disparity[i] > 0 && results[e].disparity[i] > 0;
    };
    const Score ours = scoreOf(truth, results[e], in_both);
    const Score its = scoreOf(truth, results[0], in_both);
    printRatio(name + "valid_percent", scoreOfValid(truth, results[e]).share, 90);
    printRatio(name + "d1_in_both_vs_sgbm_3way", its.wrong / ours.wrong, 1);
    printRatio(name + "median_in_both_vs_sgbm_3way", its.median / ours.median, 1);
    printRatio(name + "d1_all_points_below_sgbm_3way",
               wrongOfAll(truth, results[0]) - wrongOfAll(truth, results[e]), 10);
    printRatio(name + "time_vs_sgbm_3way",
               median(results[0].seconds) / median(results[e].seconds), 2);
  }
}

void
benchKitti(const std::string& data)
{
  Truth truth{{}, 3.0, 0.05};
  std::vector<Result> results(std::size(engines));
  std::vector<std::unique_ptr<DisparityEstimator>> estimators;
  for (const Engine& engine : engines)
    estimators.push_back(makeDisparityEstimator(engine.engine, 128));
  for (const char* const name : sequences) {
    const KittiSequence sequence(data + "/kitti/" + name);
    Truth part{{}, truth.wrong_above, truth.wrong_above_share};
    std::vector<Result> part_results(std::size(engines));
    for (std::size_t i = 0; i < sequence.size(); ++i) {
      const StereoFrame frame = sequence.frame(i);
      const cv::Mat1f disparities = lidarDisparities(sequence, frame.number);
      append(disparities, truth);
      append(disparities, part);
      for (std::size_t e = 0; e < estimators.size(); ++e) {
        if (i == 0) // not counted: memory and images are touched for the first time
          estimators[e]->estimate(frame.left, frame.right);
        estimate(*estimators[e], frame, disparities, part_results[e]);
      }
    }
    std::printf("KITTI %s, %zu frames: ", name, sequence.size());
    printTable(part, part_results);
    for (std::size_t e = 0; e < results.size(); ++e) {
      const auto add = [](auto& all, const auto& some) {
        all.insert(all.end(), some.begin(), some.end());
      };
      add(results[e].seconds, part_results[e].seconds);
      add(results[e].disparity, part_results[e].disparity);
      add(results[e].deviation, part_results[e].deviation);
    }
  }
  std::printf("KITTI, all: ");
  printTable(truth, results);
  printRatios(truth, results);
}

void
benchCones(const std::string& data)
{
  const std::string folder = data + "/middlebury_cones/";
  StereoFrame frame;
  frame.left = readPng(folder + "im2.png", ImageKind::grey_or_colour);
  frame.right = readPng(folder + "im6.png", ImageKind::grey_or_colour);
  const cv::Mat stored = readPng(folder + "disp2.png", ImageKind::labels);
  cv::Mat1f disparities;
  stored.convertTo(disparities, CV_32F, 0.25);
  Truth truth{{}, 1.0, 0.0};
  append(disparities, truth);
  std::vector<Result> results;
  for (const Engine& engine : engines) {
    const auto estimator = makeDisparityEstimator(engine.engine, 64);
    estimator->estimate(frame.left, frame.right);
    estimate(*estimator, frame, disparities, results.emplace_back());
  }
  std::printf("Middlebury cones, hidden pixels included: ");
  printTable(truth, results);
}

} // namespace

int
main()
{
  const char* const data = std::getenv("PCL_SEMANTIC_DATA");
  if (!data) {
    std::printf("PCL_SEMANTIC_DATA is not set: nothing to compare\n");
    return 0;
  }
  setNumberOfThreads(2);
  benchKitti(data);
  benchCones(data);
  return 0;
}
