// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_distributions.h>

#include <opencv2/core/mat.hpp>

#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Predicts the class distributions of every pixel of a frame's image: the left
 * one of a stereo pair. */
class LabelPredictor {
public:
  virtual ~LabelPredictor() = default;

  /** \brief Checks before the first frame that all frames have labels, if the predictor
   * can check this without their images.
   * \param[in] frames their numbers
   * \throws BadInputException that names the first frame without labels, if any */
  virtual void
  requireFrames(const std::vector<int>& /*frames*/) const
  {}

  /** \brief Predicts the class distributions of an image.
   * \param[in] image CV_8UC3 (BGR) or CV_8UC1
   * \param[in] frame its number
   * \return L x (width * height), pixels row by row, normalised, all-zero columns =
   * unlabelled; or empty, for a frame without labels (yet)
   * \throws BadInputException that names the frame, if its labels cannot be read
   * \throws BadModelException that names the frame, if the network fails */
  virtual LabelDistributions predict(const cv::Mat& image, int frame) = 0;
};

} // namespace pcl_semantic
