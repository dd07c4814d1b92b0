// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_distributions.h>
#include <pcl_semantic/images/sensor_frame.h>

#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Gives the class distributions of every pixel of a frame's left image. */
class LabelPredictor {
public:
  virtual ~LabelPredictor() = default;

  /** \brief Before the first frame: makes sure that all frames have labels, as far as
   * that can be known without their images. \param[in] frames their numbers
   * \throws BadInputException that names the first frame without any */
  virtual void
  requireFrames(const std::vector<int>& /*frames*/) const
  {}

  /** \return L x (width * height), pixels row by row, normalised; all-zero columns are
   * unlabelled; or nothing, for a frame that has no labels (yet)
   * \throws BadInputException or BadModelException that names the frame */
  virtual LabelDistributions predict(const StereoFrame& frame) = 0;
};

} // namespace pcl_semantic
