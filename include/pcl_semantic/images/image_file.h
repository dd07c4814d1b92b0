// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <opencv2/core/mat.hpp>

#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Expected kind of image in a file. */
enum class ImageKind {
  grey_or_colour, ///< CV_8UC1 or CV_8UC3 (BGR)
  labels,         ///< CV_8UC1
  segments,       ///< CV_8UC1 or CV_16UC1
  disparity,      ///< CV_16UC1
  depth           ///< CV_16UC1 or CV_32FC1
};

/** \brief Reads a PNG file strictly. OpenCV alone would decode a JPEG named .png, and
 * convert 16 bits and transparency silently.
 * \param[in] size expected size [px], compared with the file's header before decoding;
 * empty: any
 * \param[in] like source of that size, for the message: " as the first image"
 * \throws BadInputException if the file is missing, no PNG, damaged, smaller than 2 x
 * 2, or of another size or kind */
cv::Mat readPng(const std::string& path, ImageKind kind, cv::Size size = {},
                const std::string& like = {});

/** \brief Extensions of the files that readImage() reads: `.png .jpg .jpeg .tif .tiff`.
 */
const std::vector<std::string>& imageExtensions();

/** \brief Reads a camera image, grey or colour. The extension selects JPEG or TIFF;
 * other files are read by readPng().
 * \throws BadInputException as readPng() */
cv::Mat readImage(const std::string& path, cv::Size size = {},
                  const std::string& like = {});

/** \brief Reads a depth image: a TIFF (`.tif`, `.tiff`) of 16-bit or 32-bit float
 * numbers, or a 16-bit PNG.
 * \throws BadInputException as readPng() */
cv::Mat readDepthImage(const std::string& path, cv::Size size = {},
                       const std::string& like = {});

/** \brief Writes a PNG file, complete or not at all.
 * \throws OutputException if the file cannot be written */
void writePng(const std::string& path, const cv::Mat& image);

} // namespace pcl_semantic
