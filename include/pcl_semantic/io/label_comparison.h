// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_set.h>

#include <opencv2/core/mat.hpp>

#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Labels of an image, and what they are called. */
struct NamedLabels {
  std::string name;
  cv::Mat labels; ///< CV_8UC1; 0 = none
};

/** \brief A figure that compares label images of one frame, a row each, in their order:
 * on the left the image under its classes, on the right where labels differ from those
 * of the row above. The first row's right side holds the ground truth or, without one,
 * the image.
 *
 * Where both rows have a label and they differ, a pixel is green if the new label is
 * the ground truth, red if the old one was, yellow if neither was, and of the colour of
 * its new class where there is no ground truth. \param[in] image CV_8UC3 (BGR) or
 * CV_8UC1 \param[in] truth CV_8UC1, 0 = not known; empty = none \param[in] width of the
 * figure [px], from 320 to 16384 \throws InvalidParameterException unless all images
 * are of one size, or at a label beyond the label set */
cv::Mat drawLabelComparison(const cv::Mat& image,
                            const std::vector<NamedLabels>& labels,
                            const cv::Mat& truth, const LabelSet& label_set,
                            int width = 1920);

} // namespace pcl_semantic
