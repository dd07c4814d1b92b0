// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_distributions.h>

#include <opencv2/core/mat.hpp>

#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief The classes of the output channels of a segmentation network. */
struct ChannelClasses {
  std::vector<Label> labels; ///< class of each channel; kUnlabelled: its probability is
                             ///< dropped
  int classes = 0;           ///< L, at least the largest of \a labels
  bool softmax = true;       ///< channels are logits; else non-negative probabilities
};

/** \brief Converts the output of a network to class distributions of an image's pixels.
 *
 * Every channel is resized bilinearly (pixel centres at half integers, as in
 * cv::resize); then follows a soft-max over the channels. Channels of one class are
 * added, channels without class are dropped and the rest is renormalised. A pixel with
 * less than half of its probability left is unlabelled. The result does not depend on
 * the number of threads.
 * \param[in] logits CV_32F, channels x height x width, finite
 * \param[in] size of the image [px]
 * \param[in] channels one entry per channel
 * \return L x (width * height), pixels row by row
 * \throws InvalidParameterException if the sizes do not match
 * \throws BadInputException if a value is not finite, or a probability negative */
LabelDistributions distributionsFromLogits(const cv::Mat& logits, const cv::Size& size,
                                           const ChannelClasses& channels);

} // namespace pcl_semantic
