// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/abi_check.h>
#include <pcl_semantic/core/export.h>

#include <opencv2/core.hpp>
#include <pcl/PointIndices.h>

#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

struct SlicParameters {
  int superpixels = 150;     ///< approximate number per image
  double compactness = 10.0; ///< m: larger makes squarer superpixels, smaller ones
                             ///< follow colours [grey levels per superpixel width]
  int iterations = 7;        ///< iterations of the clustering
  int downscale = 2;         ///< factor by which width and height are reduced

  /** \throws InvalidParameterException that names the parameter and its range */
  void validate() const;
};

/** \brief Superpixels: connected groups of adjacent pixels with similar colour.
 *
 * Simple linear iterative clustering (Achanta et al. 2012): k-means from a regular grid
 * over D^2 = |Lab_i - Lab_c|^2 + (m / S)^2 |p_i - p_c|^2, where S is the grid spacing.
 * A pixel considers only centres less than S away in x and in y. Superpixels smaller
 * than a quarter of the mean are then merged with the neighbour of most similar colour.
 * The result does not depend on the number of threads.
 * \param[in] image CV_8UC3 (BGR) or CV_8UC1
 * \return CV_32SC1 of the same size: superpixels 0, 1, ... without gap, in the order of
 * their first pixels
 * \throws InvalidParameterException as SlicParameters::validate()
 * \throws BadInputException if the image is empty or of another type */
cv::Mat slicSuperpixels(const cv::Mat& image, const SlicParameters& parameters);

/** \brief The pixels of every segment of an image; index = row * width + column.
 * \param[in] segments CV_32SC1 with numbers 0, 1, ... that each occur
 * \throws InvalidParameterException for another type, a negative number, or one that
 * exceeds the number of pixels */
std::vector<pcl::PointIndices> cliquesOfSegments(const cv::Mat& segments);

} // namespace pcl_semantic
