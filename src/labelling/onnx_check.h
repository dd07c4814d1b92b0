// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace pcl_semantic {

/** \brief Checks an ONNX file before OpenCV reads it: OpenCV 4.6 trusts the dimensions
 * of tensors and ends the program where they exceed the data.
 *
 * Walks the protocol buffer as far as tensors go and requires that it is well formed,
 * has at least one node, that every node has inputs and outputs and that every tensor
 * has exactly the data its dimensions state. \param[in] bytes content of the file
 * \param[in] path its name, for messages
 * \throws BadModelException */
void checkOnnx(const std::vector<std::uint8_t>& bytes, const std::string& path);

} // namespace pcl_semantic
