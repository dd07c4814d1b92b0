// SPDX-License-Identifier: BSD-3-Clause
#include "opencv_settings.h"

#include "core/thread_limits.h"

#include <opencv2/core/utility.hpp>

#include <algorithm>

namespace pcl_semantic {

namespace {

// TBB prints an error if more threads are requested than exist. OpenCV's number of
// threads is global to the process, and must not change while another thread uses it.
void
limitOpenCv(int threads)
{
  const int limit = std::min(threads, cv::getNumberOfCPUs());
  if (cv::getNumThreads() != limit)
    cv::setNumThreads(limit);
}

[[maybe_unused]] const bool is_limited = addThreadLimit(limitOpenCv);

} // namespace

QuietOpenCv::QuietOpenCv()
    : level_(cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT))
{}

QuietOpenCv::~QuietOpenCv()
{
  cv::utils::logging::setLogLevel(level_);
}

} // namespace pcl_semantic
