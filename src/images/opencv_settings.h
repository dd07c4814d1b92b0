// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <opencv2/core/utils/logger.hpp>

// Settings that OpenCV has once a process. setNumberOfThreads() limits its threads,
// too, where this library is loaded.

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief As long as it lives OpenCV prints nothing: it reports in several lines of its
 * own what it also throws. */
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
