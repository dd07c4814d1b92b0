// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/pipeline/calibration_trial.h>
#include <pcl_semantic/pipeline/frame_calibration.h>
#include <pcl_semantic/stereo/disparity_engines.h>
#include <pcl_semantic/stereo/disparity_to_cloud.h>

namespace pcl_semantic {

namespace {

// Columns of the pixels that have truth.
void
appendSamples(const cv::Mat& truth, const LabelDistributions& network,
              const std::vector<PointFeatures>& features, CalibrationSamples& samples)
{
  std::vector<Eigen::Index> pixels;
  for (Eigen::Index i = 0; i < network.size(); ++i)
    if (truth.data[i] != kUnlabelled)
      pixels.push_back(i);
  LabelDistributions::Matrix& all = samples.network.matrix();
  const Eigen::Index before = all.cols();
  all.conservativeResize(network.classes(), before + Eigen::Index(pixels.size()));
  for (std::size_t k = 0; k < pixels.size(); ++k) {
    all.col(before + Eigen::Index(k)) = network.matrix().col(pixels[k]);
    samples.features.push_back(features[std::size_t(pixels[k])]);
    samples.truth.push_back(truth.data[pixels[k]]);
  }
}

CalibrationSamples
pooled(const std::vector<CalibrationSamples>& sequences, std::size_t left_out)
{
  CalibrationSamples pool;
  pool.of = sequences.front().of;
  Eigen::Index count = 0;
  for (std::size_t s = 0; s < sequences.size(); ++s)
    if (s != left_out) {
      const CalibrationSamples& each = sequences[s];
      pool.features.insert(pool.features.end(), each.features.begin(),
                           each.features.end());
      pool.weights.insert(pool.weights.end(), each.weights.begin(), each.weights.end());
      pool.truth.insert(pool.truth.end(), each.truth.begin(), each.truth.end());
      count += each.network.size();
    }
  pool.network.matrix().resize(sequences.front().network.classes(), count);
  for (std::size_t s = 0, at = 0; s < sequences.size(); ++s)
    if (s != left_out) {
      const auto size = std::size_t(sequences[s].network.size());
      pool.network.matrix().middleCols(Eigen::Index(at), Eigen::Index(size)) =
          sequences[s].network.matrix();
      at += size;
    }
  return pool;
}

void
count(const LabelDistributions& distributions, const CalibrationSamples& samples,
      ConfusionMatrix& confusion)
{
  for (std::size_t i = 0; i < samples.truth.size(); ++i)
    confusion.add(samples.truth[i], distributions.mapLabel(Eigen::Index(i)),
                  samples.weights.empty() ? 1 : std::uint64_t(samples.weights[i]));
}

} // namespace

CalibrationSamples
calibrationSamples(const CalibrationSequence& sequence, const MapperConfig& config,
                   const std::vector<Label>& ground)
{
  const auto predictor = sequence.makePredictor(config.label_confidence);
  const auto stereo = makeDisparityEstimator(config.stereo, config.disparities);
  CalibrationSamples samples;
  for (std::size_t i = 0; i < sequence.frames().size(); ++i) {
    if (sequence.truth(i).empty())
      continue;
    const StereoFrame& frame = sequence.frames()[i];
    DisparityImage image = stereo->estimate(frame.left, frame.right);
    eraseUnsure(image, config.max_deviation);
    const LabelDistributions network = predictor->predict(frame);
    const auto cloud = disparityToCloud(image.disparity, frame.left, sequence.camera());
    appendSamples(sequence.truth(i), network, frameFeatures(*cloud, network, ground),
                  samples);
  }
  return samples;
}

CalibrationTrial
tryCalibration(const std::vector<CalibrationSamples>& sequences,
               const std::vector<Label>& ground, const CalibrationOptions& options)
{
  if (sequences.empty())
    PCL_THROW_EXCEPTION(BadInputException, "calibration: no sequence");
  const int classes = sequences.front().network.classes();
  CalibrationTrial trial{{},
                         {},
                         ConfusionMatrix(classes),
                         ConfusionMatrix(classes),
                         ConfusionMatrix(classes)};
  const auto fitTo = [&](std::size_t left_out) {
    LabelCalibration calibration = fitCalibration(pooled(sequences, left_out), options);
    calibration.ground = ground;
    return calibration;
  };
  trial.all = fitTo(sequences.size());
  for (std::size_t s = 0; s < sequences.size(); ++s) {
    const CalibrationSamples& each = sequences[s];
    count(each.network, each, trial.network);
    count(calibrate(trial.all, each.network, each.features), each, trial.fitted);
    if (sequences.size() < 2)
      continue;
    trial.without.push_back(fitTo(s));
    count(calibrate(trial.without.back(), each.network, each.features), each,
          trial.held_out);
  }
  return trial;
}

} // namespace pcl_semantic
