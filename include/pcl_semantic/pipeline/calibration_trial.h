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

/** \brief Folders of a sequence with ground truth. */
struct CalibrationFolders {
  std::string sequence;      ///< in KITTI's layout, with poses.txt
  std::string labels;        ///< stored label distributions, see StoredPredictor
  std::string truth;         ///< label images (000012.png), 0 = no ground truth
  std::string calibration{}; ///< calibration of the labels (readCalibration()); empty =
                             ///< none
  FrameRange frames{};       ///< frames to read, by number
};

/** \brief A sequence with ground truth, to fit calibrations. */
class CalibrationSequence {
public:
  /** \param[in] classes L, of labels and ground truth
   * \throws BadInputException unless all inputs exist, every frame has labels and a
   * pose, and at least one has ground truth */
  CalibrationSequence(const CalibrationFolders& folders, int classes);

  /** \brief Last component of the sequence's path: "05". */
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

  /** \brief Doubts about its trajectory, one per line. */
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

/** \brief Returns the pixels of a sequence with ground truth: their predictions and
 * features (frameFeatures).
 * \param[in] config only its disparity engine and max_deviation are used
 * \param[in] ground the classes of the ground
 * \param[in] curves features of the histograms in \a frames of the samples */
CalibrationSamples calibrationSamples(const CalibrationSequence& sequence,
                                      const MapperConfig& config,
                                      const std::vector<Label>& ground,
                                      const std::vector<FeatureKnots>& curves);

/** \brief A calibration from several sequences, and its evaluation by
 * cross-validation. */
struct CalibrationTrial {
  LabelCalibration all;                  ///< fitted to all sequences
  std::vector<LabelCalibration> without; ///< all but one; empty for one sequence
  ConfusionMatrix network;               ///< pixels of all sequences, uncalibrated
  ConfusionMatrix fitted;                ///< calibrated by \a all
  ConfusionMatrix held_out;              ///< each calibrated without itself
};

/** \brief Fits calibrations, with histograms of the training frames if the samples have
 * them.
 * \throws BadInputException as fitCalibration() */
CalibrationTrial tryCalibration(const std::vector<CalibrationSamples>& sequences,
                                const std::vector<Label>& ground,
                                const CalibrationOptions& options);

/** \brief Returns the cliques of a sequence's map as samples for tryCalibration(). The
 * ground truth pixels of a frame are projected to voxels twice: at their measured
 * depth, and by rendering the map (to max_depth). Pixels on a voxel of a clique are its
 * ground truth. A sample describes a clique; its weight is the number of its pixels of
 * one class.
 * \param[in] config the map and its cliques; no CRF is run
 * \param[in] ground the classes of the ground */
CalibrationSamples cliqueSamples(const CalibrationSequence& sequence,
                                 const MapperConfig& config, const LabelSet& label_set,
                                 const std::vector<Label>& ground);

} // namespace pcl_semantic
