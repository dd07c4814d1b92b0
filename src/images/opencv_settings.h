// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <opencv2/core/utils/logger.hpp>

// Settings that OpenCV has once per process. Loading this library makes
// setNumberOfThreads() limit OpenCV's threads too.

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Silences OpenCV during its lifetime: OpenCV prints its exceptions in several
 * lines. */
class QuietOpenCv {
public:
  QuietOpenCv();
  ~QuietOpenCv();
  QuietOpenCv(const QuietOpenCv&) = delete;
  QuietOpenCv& operator=(const QuietOpenCv&) = delete;

private:
  cv::utils::logging::LogLevel level_;
};

} // namespace pcl_semantic
