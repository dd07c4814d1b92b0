// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/utils/logger.hpp>

namespace pcl_semantic {

/** \brief As long as it lives OpenCV prints nothing: it reports in several lines of its
 * own what it also throws. */
class QuietOpenCv {
public:
  QuietOpenCv()
      : level_(cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT))
  {}
  ~QuietOpenCv() { cv::utils::logging::setLogLevel(level_); }
  QuietOpenCv(const QuietOpenCv&) = delete;
  QuietOpenCv& operator=(const QuietOpenCv&) = delete;

private:
  cv::utils::logging::LogLevel level_;
};

} // namespace pcl_semantic
