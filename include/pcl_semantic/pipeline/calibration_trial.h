// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/dataset/frame_sequence.h>
#include <pcl_semantic/dataset/kitti_sequence.h>
#include <pcl_semantic/evaluation/confusion_matrix.h>
#include <pcl_semantic/files/pose_doubts.h>
#include <pcl_semantic/labelling/calibration_fit.h>
#include <pcl_semantic/labelling/label_predictor.h>
#include <pcl_semantic/odometry/pose_source.h>
#include <pcl_semantic/pipeline/mapper_config.h>

#include <memory>
#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Where the files of a sequence with ground truth are. */
struct CalibrationFolders {
  std::string sequence;      ///< in KITTI's layout, with poses.txt
  std::string labels;        ///< stored label distributions, see StoredPredictor
  std::string truth;         ///< label images (000012.png), 0 = no ground truth
  std::string calibration{}; ///< of the labels (readCalibration); empty = none
  FrameRange frames{};       ///< that are read, by their numbers
};

/** \brief A sequence with ground truth: what a calibration is fitted to. */
class CalibrationSequence {
public:
  /** \param[in] classes L, of labels and ground truth
   * \throws BadInputException if something is missing or does not fit: every frame has
   * to have labels and a pose, at least one has to have ground truth */
  CalibrationSequence(const CalibrationFolders& folders, int classes);

  /** \brief Last part of the path of the sequence: "05". */
  const std::string&
  name() const
  {
    return name_;
  }

  const std::vector<StereoFrame>&
  frames() const
  {
    return frames_;
  }

  const StereoCamera&
  camera() const
  {
    return sequence_.camera();
  }

  /** \brief CV_8UC1; empty for a frame without ground truth. */
  const cv::Mat&
  truth(std::size_t i) const
  {
    return truths_.at(i);
  }

  std::unique_ptr<LabelPredictor> makePredictor(double png_confidence) const;

  std::unique_ptr<PoseSource> makePoses() const;

  /** \brief Doubts about its trajectory, a line each. */
  const std::vector<std::string>&
  doubts() const
  {
    return trajectory_.doubts;
  }

  /** \brief Path of the calibration of its labels; empty = none. */
  const std::string&
  calibration() const
  {
    return folders_.calibration;
  }

private:
  void readTruth();

  CalibrationFolders folders_;
  KittiSequence sequence_;
  int classes_;
  std::string name_;
  std::vector<StereoFrame> frames_;
  std::vector<cv::Mat> truths_;
  StoredTrajectory trajectory_;
};

/** \brief The ground truth pixels of a sequence: what the network says there, and where
 * they are (frameFeatures). \param[in] config its disparity engine and max_deviation
 * are used \param[in] ground the classes of the ground \param[in] curves of which the
 * samples' \a frames have histograms */
CalibrationSamples calibrationSamples(const CalibrationSequence& sequence,
                                      const MapperConfig& config,
                                      const std::vector<Label>& ground,
                                      const std::vector<FeatureKnots>& curves);

/** \brief A calibration of several sequences, and what it is worth on one that it was
 * not fitted to. */
struct CalibrationTrial {
  LabelCalibration all;                  ///< fitted to all sequences
  std::vector<LabelCalibration> without; ///< to all but one; empty if there is but one
  ConfusionMatrix network;               ///< pixels of all sequences, as they come
  ConfusionMatrix fitted;                ///< calibrated by \a all
  ConfusionMatrix held_out;              ///< each sequence by that without it
};

/** \brief Fits calibrations that know what they have seen, if the sequences' samples
 * say it. \throws BadInputException as fitCalibration() */
CalibrationTrial tryCalibration(const std::vector<CalibrationSamples>& sequences,
                                const std::vector<Label>& ground,
                                const CalibrationOptions& options);

/** \brief The cliques of a sequence's map as tryCalibration() takes them: the ground
 * truth pixels of a frame are looked up at their own depth and as the map is seen from
 * there (to max_depth); those that meet a voxel in a clique are its ground truth. A
 * sample describes a clique, and weighs the number of its pixels that are of one class.
 * \param[in] config the map and its cliques; no CRF is run
 * \param[in] ground the classes of the ground */
CalibrationSamples cliqueSamples(const CalibrationSequence& sequence,
                                 const MapperConfig& config, const LabelSet& label_set,
                                 const std::vector<Label>& ground);

} // namespace pcl_semantic
