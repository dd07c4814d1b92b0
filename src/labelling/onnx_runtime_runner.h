// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "network_runner.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace pcl_semantic {

/** \brief Loads a network into ONNX Runtime, which uses the number of threads set at
 * this moment. Only available if the library is built with PCL_SEMANTIC_ONNX_RUNTIME.
 * \param[in] bytes content of the ONNX file
 * \param[in] input, output their names in it
 * \throws EngineError, std::bad_alloc */
std::unique_ptr<NetworkRunner>
runWithOnnxRuntime(const std::vector<std::uint8_t>& bytes, const std::string& input,
                   const std::string& output);

} // namespace pcl_semantic
