// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_distributions.h>
#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/files/npy_file.h>

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>

#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Reads the pixel labels of an image (`.png`), CV_8U.
 * \param[in] mapping from numbers (8 or 16 bits) or colours; none: the pixels are
 * labels
 * \param[in] size expected size [px]; empty: any
 * \throws BadInputException as readPng(), or for a colour without a class */
cv::Mat readLabelImage(const std::string& path, const PixelMapping& mapping,
                       cv::Size size = {});

/** \brief The size in the header of an image file (PNG, JPEG, TIFF) [px]; empty if it
 * is no image. \throws BadInputException if it cannot be read */
cv::Size statedImageSize(const std::string& path);

/** \brief Reads the label distributions of an image.
 *
 * By extension: `.bin` float32, pixel-major, L values per pixel (the format of the
 * paper's released code); `.npy` H x W x L, float32 or float16; `.png` class ids,
 * mapped by \a mapping, each with probability \a confidence.
 * \param[in] path file
 * \param[in] width columns of the image [px]
 * \param[in] height rows of the image [px]
 * \param[in] classes L
 * \param[in] confidence probability of the stated class, for `.png` only
 * \param[in] mapping for `.png` only: from numbers (8 or 16 bits) or colours. Colours
 * without a class are refused, because scaled images contain mixed colours.
 * \return L x (width * height), pixels row by row, normalised; all-zero columns are
 * unlabelled
 * \throws BadInputException if the file has another size, shape or type, a class beyond
 * L, a colour without a class, or values that are no distributions */
LabelDistributions readDistributions(const std::string& path, int width, int height,
                                     int classes, float confidence,
                                     const PixelMapping& mapping = {});

/** \brief The endings of the names that readDistributions() reads. */
const std::vector<std::string>& distributionExtensions();

/** \brief Writes the `.bin` format of readDistributions().
 * \throws OutputException if the file cannot be written */
void writeDistributions(const std::string& path,
                        const LabelDistributions& distributions);

/** \brief Writes the `.npy` format of readDistributions().
 * \param[in] distributions L x (width * height), pixels row by row
 * \param[in] width columns of the image [px]
 * \throws InvalidParameterException if the columns are not whole rows
 * \throws OutputException if the file cannot be written */
void writeDistributions(const std::string& path,
                        const LabelDistributions& distributions, int width,
                        NpyType type);

/** \brief Writes the most probable classes in the `.png` format of readDistributions().
 * \throws as writeDistributions() */
void writeLabelIds(const std::string& path, const LabelDistributions& distributions,
                   int width);

} // namespace pcl_semantic
