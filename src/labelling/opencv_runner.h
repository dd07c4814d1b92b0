// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "network_runner.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace pcl_semantic {

/** \brief Loads a network into OpenCV's dnn module.
 * \param[in] bytes content of the ONNX file
 * \param[in] input, output their names in it
 * \throws cv::Exception, std::logic_error at an invalid size */
std::unique_ptr<NetworkRunner> runWithOpenCv(std::vector<std::uint8_t> bytes,
                                             const std::string& input,
                                             const std::string& output);

} // namespace pcl_semantic
