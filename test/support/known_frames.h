// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/labelling/label_predictor.h>
#include <pcl_semantic/odometry/pose_source.h>

#include <functional>
#include <utility>

namespace pcl_semantic {

/** \brief Poses from a function of the frame number. */
class KnownPoses : public PoseSource {
public:
  explicit KnownPoses(std::function<Eigen::Isometry3d(int)> poses)
      : poses_(std::move(poses))
  {}

  Eigen::Isometry3d
  pose(const SensorFrame& frame) override
  {
    return poses_(timeOf(frame).number);
  }

private:
  std::function<Eigen::Isometry3d(int)> poses_;
};

/** \brief Labels from a function of the frame number. */
class KnownLabels : public LabelPredictor {
public:
  explicit KnownLabels(std::function<LabelDistributions(int)> labels)
      : labels_(std::move(labels))
  {}

  LabelDistributions
  predict(const cv::Mat&, int frame) override
  {
    return labels_(frame);
  }

private:
  std::function<LabelDistributions(int)> labels_;
};

} // namespace pcl_semantic
