// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

#include <algorithm>
#include <stdexcept>
#include <string>

namespace pcl_semantic {

/** \brief Error of an engine that cannot load or run a network, as one line. */
class EngineError : public std::runtime_error {
public:
  /** \param[in] text only its first line is used, or a part of it */
  explicit EngineError(const std::string& text)
      : std::runtime_error(
            text.substr(0, std::min<std::size_t>(text.find_first_of("\r\n"), 300)))
  {}
};

/** \brief A network loaded by an engine. */
class NetworkRunner {
public:
  virtual ~NetworkRunner() = default;

  /** \param[in] input N x 3 x H x W, float
   * \return the output, an image with its own memory
   * \throws EngineError, std::bad_alloc, or exceptions of OpenCV */
  virtual cv::Mat run(const cv::Mat& input) = 0;
};

} // namespace pcl_semantic
