// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "files/quiet_opencv.h"
#include "network_runner.h"

#include <cstdint>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <vector>

namespace pcl_semantic {

/** \brief What \a body returns; OpenCV's exceptions as EngineError or std::bad_alloc.
 */
template <typename Body>
auto
withOpenCv(Body&& body)
{
  try {
    const QuietOpenCv quiet;
    return body();
  }
  catch (const cv::Exception& error) {
    if (error.code == cv::Error::StsNoMem)
      throw std::bad_alloc();
    throw EngineError(error.err);
  }
  catch (const std::logic_error& error) { // std::length_error of a nonsensical size
    throw EngineError(error.what());
  }
}

/** \brief A network in OpenCV's module dnn.
 * \param[in] bytes content of the ONNX file, which checkOnnx() has passed
 * \param[in] input, output their names in it
 * \throws EngineError, std::bad_alloc */
std::unique_ptr<NetworkRunner> runWithOpenCv(std::vector<std::uint8_t> bytes,
                                             const std::string& input,
                                             const std::string& output);

} // namespace pcl_semantic
