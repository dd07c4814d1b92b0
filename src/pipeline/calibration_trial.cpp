// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/pipeline/calibration_trial.h>

#include "core/fail.h"
#include "frame_calibration.h"
#include "map_cliques.h"

#include <pcl_semantic/evaluation/voxel_lookup.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/images/image_file.h>
#include <pcl_semantic/labelling/stored_predictor.h>
#include <pcl_semantic/odometry/trajectory_poses.h>
#include <pcl_semantic/pipeline/semantic_mapper.h>
#include <pcl_semantic/stereo/disparity_engines.h>
#include <pcl_semantic/stereo/disparity_to_cloud.h>

#include <opencv2/core.hpp>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <map>
#include <set>

namespace pcl_semantic {

namespace fs = std::filesystem;

namespace {

std::string
lastPartOf(const std::string& path)
{
  const fs::path normal = (fs::path(path) / "").lexically_normal().parent_path();
  return normal.filename().string();
}

} // namespace

CalibrationSequence::CalibrationSequence(const CalibrationFolders& folders, int classes)
    : folders_(folders), sequence_(folders.sequence), classes_(classes),
      name_(lastPartOf(folders.sequence))
{
  const std::string poses = sequence_.posesPath();
  if (poses.empty())
    badInput(folders.sequence, ": has no poses.txt; write it with "
                               "pcl_semantic_odometry");
  trajectory_ = readTrajectory(poses, PoseFrame::first_camera);
  const std::vector<std::size_t> chosen = selectFrames(sequence_, folders.frames);
  for (const std::size_t i : chosen)
    frames_.push_back(sequence_.frame(i));
  makePoses()->requirePoses(frameTimes(sequence_, chosen));
  readTruth();
}

void
CalibrationSequence::readTruth()
{
  truths_.resize(frames_.size());
  bool has_truth = false;
  for (const FrameFile& file : listFrameFiles(folders_.truth, {".png"})) {
    const auto frame =
        std::find_if(frames_.begin(), frames_.end(), [&](const StereoFrame& each) {
          return each.number == file.frame;
        });
    if (frame == frames_.end())
      continue;
    cv::Mat& truth = truths_[std::size_t(frame - frames_.begin())];
    truth = readPng(file.path, ImageKind::labels, frame->left.size(), " as its image");
    double largest = 0.0;
    cv::minMaxLoc(truth, nullptr, &largest);
    if (largest > classes_)
      badInput(file.path, ": has labels up to ", largest, ", expected up to ",
               classes_);
    has_truth = true;
  }
  if (!has_truth)
    badInput(folders_.truth, ": has no ground truth image of a frame of ",
             folders_.sequence);
}

std::unique_ptr<LabelPredictor>
CalibrationSequence::makePredictor(double png_confidence) const
{
  return std::make_unique<StoredPredictor>(folders_.labels, classes_,
                                           float(png_confidence));
}

std::unique_ptr<PoseSource>
CalibrationSequence::makePoses() const
{
  return posesOf(trajectory_, sequence_.T_camera0_camera());
}

namespace {

// Appends the pixels with ground truth.
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
      pool.sequences.insert(pool.sequences.end(), each.truth.size(), int(s));
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
                   const std::vector<Label>& ground,
                   const std::vector<FeatureKnots>& curves)
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
    const LabelDistributions network = predictor->predict(frame.left, frame.number);
    const auto cloud = disparityToCloud(image.disparity, frame.left, sequence.camera());
    const auto features = frameFeatures(*cloud, network, ground);
    appendSamples(sequence.truth(i), network, features, samples);
    samples.frames.emplace_back();
    for (const auto& [feature, knots] : curves)
      samples.frames.back().push_back(
          featureHistogram(feature, knots, network, features));
  }
  return samples;
}

namespace {

using Histograms = std::vector<Eigen::MatrixXf>;

// Mean histograms of all sequences but the excluded ones: frames have equal weights in
// their sequence, and sequences in the mean.
Histograms
meanHistograms(const std::vector<CalibrationSamples>& sequences,
               const std::set<std::size_t>& left_out)
{
  Histograms mean;
  for (std::size_t s = 0; s < sequences.size(); ++s) {
    const std::vector<Histograms>& frames = sequences[s].frames;
    if (left_out.count(s) || frames.empty())
      continue;
    for (const Histograms& frame : frames)
      for (std::size_t i = 0; i < frame.size(); ++i) {
        if (mean.size() <= i)
          mean.push_back(Eigen::MatrixXf::Zero(frame[i].rows(), frame[i].cols()));
        mean[i] += frame[i] / float(frames.size());
      }
  }
  for (Eigen::MatrixXf& each : mean)
    each /= std::max(each.sum(), std::numeric_limits<float>::min());
  return mean;
}

// Median distance of a sequence's frames from the other sequences.
double
distanceFromOthers(const std::vector<CalibrationSamples>& sequences, std::size_t of,
                   std::size_t left_out)
{
  const Histograms others = meanHistograms(sequences, {of, left_out});
  std::vector<double> distances;
  for (const Histograms& frame : sequences[of].frames)
    if (const double distance = histogramDistance(frame, others); distance >= 0.0)
      distances.push_back(distance); // not NaN
  if (distances.empty())
    return 0.0;
  const auto middle = distances.begin() + std::ptrdiff_t(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  return *middle;
}

void
setSeen(const std::vector<CalibrationSamples>& sequences, std::size_t left_out,
        LabelCalibration& calibration)
{
  calibration.seen = meanHistograms(sequences, {left_out});
  for (std::size_t s = 0; s < sequences.size(); ++s)
    if (s != left_out)
      calibration.usual_distance =
          std::max(calibration.usual_distance,
                   float(distanceFromOthers(sequences, s, left_out)));
}

} // namespace

CalibrationTrial
tryCalibration(const std::vector<CalibrationSamples>& sequences,
               const std::vector<Label>& ground, const CalibrationOptions& options)
{
  if (sequences.empty())
    badInput("calibration: no sequence");
  const int classes = sequences.front().network.classes();
  CalibrationTrial trial{{},
                         {},
                         ConfusionMatrix(classes),
                         ConfusionMatrix(classes),
                         ConfusionMatrix(classes)};
  const auto fitTo = [&](std::size_t left_out) {
    LabelCalibration calibration = fitCalibration(pooled(sequences, left_out), options);
    calibration.ground = ground;
    setSeen(sequences, left_out, calibration);
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

namespace {

constexpr int none = -1;

std::vector<int>
cliquesOfVoxels(const std::vector<pcl::PointIndices>& cliques, std::size_t voxels)
{
  std::vector<int> numbers(voxels, none);
  for (std::size_t c = 0; c < cliques.size(); ++c)
    for (const pcl::index_t i : cliques[c].indices)
      numbers[std::size_t(i)] = int(c);
  return numbers;
}

// Voxels of each ground truth pixel, by its measured depth and by the rendered map.
std::vector<std::pair<Label, std::int32_t>>
voxelsWithTruth(const MappedFrame& mapped, const StereoCamera& camera,
                const cv::Mat& truth, double max_depth)
{
  const VoxelLookup lookup(mapped.voxels);
  const RenderedLabels seen =
      renderLabels(mapped.voxels, camera, mapped.T_world_camera, max_depth);
  std::vector<std::pair<Label, std::int32_t>> voxels;
  const auto add = [&](Label label, std::int32_t index) {
    if (index != VoxelLookup::none)
      voxels.push_back({label, index});
  };
  for (std::size_t i = 0; i < mapped.cloud->size(); ++i) {
    const Label label = truth.data[i];
    if (label == kUnlabelled)
      continue;
    const pcl::PointXYZRGB& point = (*mapped.cloud)[i];
    if (point.z <= max_depth) // false for NaN
      add(label,
          lookup.at(mapped.T_world_camera * point.getVector3fMap().cast<double>()));
    add(label, seen.indices.at<std::int32_t>(int(i)));
  }
  return voxels;
}

// Appends one sample per class of a clique's pixels, weighted by their number.
void
append(const CliqueEvidence& evidence,
       const std::vector<std::pair<Label, std::int32_t>>& truth,
       const std::vector<int>& cliques, CalibrationSamples& samples)
{
  std::map<std::pair<int, Label>, int> pixels;
  for (const auto& [label, voxel] : truth)
    if (cliques[std::size_t(voxel)] != none)
      ++pixels[{cliques[std::size_t(voxel)], label}];
  LabelDistributions::Matrix& all = samples.network.matrix();
  Eigen::Index column = all.cols();
  all.conservativeResize(evidence.distributions.classes(),
                         column + Eigen::Index(pixels.size()));
  for (const auto& [key, number] : pixels) {
    const auto& [clique, label] = key;
    all.col(column++) = evidence.distributions.matrix().col(clique);
    samples.features.push_back(evidence.features[std::size_t(clique)]);
    samples.truth.push_back(label);
    samples.weights.push_back(float(number));
  }
}

} // namespace

CalibrationSamples
cliqueSamples(const CalibrationSequence& sequence, const MapperConfig& config,
              const LabelSet& label_set, const std::vector<Label>& ground)
{
  MapperConfig plain = config;
  plain.crf = CRFModelType::unary;
  SemanticMapper mapper(label_set, plain, sequence.makePoses(), sequence.camera(),
                        sequence.makePredictor(plain.label_confidence));
  if (!sequence.calibration().empty())
    mapper.setLabelCalibration(readCalibration(sequence.calibration(), label_set));
  MapCliques map_cliques(plain, label_set);
  map_cliques.setGround(ground);
  CalibrationSamples samples;
  samples.of = "cliques";
  for (std::size_t i = 0; i < sequence.frames().size(); ++i) {
    const MappedFrame mapped = mapper.process(sequence.frames()[i]);
    map_cliques.setFrame(mapped.cloud, mapped.network, mapped.T_world_camera);
    const auto cliques = map_cliques.group(mapped.voxels); // also updates superpixels
    if (!sequence.truth(i).empty())
      append(map_cliques.evidence(mapped.voxels, cliques),
             voxelsWithTruth(mapped, sequence.camera(), sequence.truth(i),
                             plain.map.max_range),
             cliquesOfVoxels(cliques, mapped.voxels.size()), samples);
  }
  return samples;
}

} // namespace pcl_semantic
