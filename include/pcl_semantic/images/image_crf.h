// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/filters/crf_settings.h>

#include <opencv2/core/mat.hpp>
#include <pcl/PointIndices.h>

#include <optional>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Refines the labels of an image: the models of SemanticCRF over its pixels,
 * the paper's 2D application. Pixel (column x, row y) is element y * width + x.
 *
 * Parameters start as SemanticCRFParameters::forImages(); positions are in pixels. */
class ImageCRF : public CRFSettings {
public:
  ImageCRF();

  /** \brief Sets cliques of pixels, as CloudCRF::setCliques(). */
  void setCliques(const std::vector<pcl::PointIndices>& cliques);

  /** \brief Sets cliques from an image: the pixels of each positive number, in the
   * order of the numbers; 0 belongs to no clique.
   * \param[in] segments CV_8UC1, CV_16UC1 or CV_32SC1
   * \throws InvalidParameterException for another type or a negative number; refine()
   * checks the size */
  void setSegments(const cv::Mat& segments);

  /** \brief Runs the model.
   * \param[in] image CV_8UC3 (BGR) or CV_8UC1
   * \param[in] measured L x pixels, row by row; all-zero columns are unlabelled
   * \return refined distributions, L x pixels
   * \throws InvalidParameterException if the image has another type, or a setting
   * another size
   * \throws BadInputException if a measurement is negative or not finite */
  LabelDistributions refine(const cv::Mat& image, const LabelDistributions& measured);

private:
  std::optional<std::vector<pcl::PointIndices>> cliques_;
  int segments_width_ = 0; // 0 = the cliques are of no image
  int segments_height_ = 0;
};

} // namespace pcl_semantic
