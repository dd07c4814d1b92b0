// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_distributions.h>
#include <pcl_semantic/core/stereo_frame.h>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Gives the class distributions of every pixel of a frame's left image. */
class LabelPredictor {
public:
  virtual ~LabelPredictor() = default;

  /** \return L x (width * height), pixels row by row, normalised; all-zero columns are
   * unlabelled
   * \throws BadInputException or BadModelException that names the frame */
  virtual LabelDistributions predict(const StereoFrame& frame) = 0;
};

} // namespace pcl_semantic
