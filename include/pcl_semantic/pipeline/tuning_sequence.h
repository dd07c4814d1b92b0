// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/dataset/frame_range.h>
#include <pcl_semantic/dataset/kitti_sequence.h>
#include <pcl_semantic/files/trajectory_file.h>
#include <pcl_semantic/labelling/label_predictor.h>
#include <pcl_semantic/odometry/pose_source.h>
#include <pcl_semantic/pipeline/mapper_config.h>
#include <pcl_semantic/stereo/disparity_estimator.h>

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Where the files of a sequence with truth are. */
struct TuningFolders {
  std::string sequence;      ///< in KITTI's layout, with poses.txt
  std::string labels;        ///< stored label distributions, see StoredPredictor
  std::string truth;         ///< label images (000012.png), 0 = no truth
  std::string calibration{}; ///< of the labels (readCalibration); empty = none
  FrameRange frames{};       ///< that are read, by their numbers
};

/** \brief A sequence with truth, ready to be mapped many times: images and truth are
 * read once, disparities are computed once an engine. Threads may share it. */
class TuningSequence {
public:
  /** \param[in] classes L, of labels and truth
   * \throws BadInputException if something is missing or does not fit: every frame has
   * to have labels and a pose, at least one has to have truth */
  TuningSequence(const TuningFolders& folders, int classes);

  /** \brief Last part of the path of the sequence: "05". */
  const std::string&
  name() const
  {
    return name_;
  }

  /** \brief Where it comes from, for messages and reports: folders, number of frames,
   * and a digest of its images, poses, labels and truth. */
  std::string describe() const;

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

  /** \brief CV_8UC1; empty for a frame without truth. */
  const cv::Mat&
  truth(std::size_t i) const
  {
    return truths_.at(i);
  }

  std::unique_ptr<LabelPredictor> makePredictor(double png_confidence) const;

  std::unique_ptr<PoseSource> makePoses() const;

  /** \brief Path of the calibration of its labels; empty = none. */
  const std::string&
  calibration() const
  {
    return folders_.calibration;
  }

  /** \brief Disparities of all frames; computed at the first call for an engine. */
  std::shared_ptr<const std::vector<DisparityImage>>
  disparities(const MapperConfig& config) const;

private:
  void readTruth();

  std::uint64_t digestOfData() const;

  TuningFolders folders_;
  KittiSequence sequence_;
  int classes_;
  std::string name_;
  std::vector<StereoFrame> frames_;
  std::vector<cv::Mat> truths_;
  Trajectory trajectory_;
  std::uint64_t digest_ = 0;
  mutable std::mutex computing_;
  mutable std::map<std::pair<std::string, int>,
                   std::shared_ptr<const std::vector<DisparityImage>>>
      disparities_; // by engine and range
};

/** \brief What runs of this program on some sequences depend on, one "name: value" a
 * line, the digest of the program's own code among them. */
std::string describeTuning(const std::vector<std::shared_ptr<const TuningSequence>>&);

} // namespace pcl_semantic
