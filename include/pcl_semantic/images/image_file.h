// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <opencv2/core/mat.hpp>

#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief The kind of image that a file has to hold. */
enum class ImageKind {
  grey_or_colour, ///< CV_8UC1 or CV_8UC3 (BGR)
  labels,         ///< CV_8UC1
  segments,       ///< CV_8UC1 or CV_16UC1
  disparity       ///< CV_16UC1, also for depths
};

/** \brief Reads a PNG file strictly: OpenCV alone would decode a JPEG named .png, and
 * convert 16 bits and transparency silently.
 * \param[in] size that it has to have [px], compared with the file's header before
 * anything is decoded; empty: any
 * \param[in] like what else has that size, for the message: " as the first image"
 * \throws BadInputException if it is missing, no PNG, damaged, smaller than 2 x 2, of
 * another size or of another kind */
cv::Mat readPng(const std::string& path, ImageKind kind, cv::Size size = {},
                const std::string& like = {});

/** \brief Extensions of what readImage() reads: `.png .jpg .jpeg .tif .tiff`. */
const std::vector<std::string>& imageExtensions();

/** \brief Reads what a camera took, grey or colour: a JPEG or TIFF if the file is named
 * so, else a PNG as readPng() does. \throws BadInputException as readPng() */
cv::Mat readImage(const std::string& path, cv::Size size = {},
                  const std::string& like = {});

/** \brief Writes a PNG file. \throws OutputException; nothing is left behind then */
void writePng(const std::string& path, const cv::Mat& image);

} // namespace pcl_semantic
