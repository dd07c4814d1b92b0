// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace pcl_semantic {

/** \brief The inputs of a network, and all tensors that can be its outputs. */
struct OnnxInterface {
  struct Input {
    std::string name;
    std::vector<std::int64_t> size; ///< batch, channels, rows, columns; -1 = any
  };

  std::vector<Input> inputs;        ///< without those that are weights
  std::vector<std::string> outputs; ///< of the network
  std::vector<std::string> inner;   ///< of all nodes, these outputs too
};

/** \brief Reads the interface of an ONNX file, and refuses what would not be noticed
 * later: a file that is cut off or none of ONNX, and tensors whose data are elsewhere,
 * or not as many as their dimensions state, of which OpenCV 4.6 reads what lies behind.
 *
 * It is no check of the operators: OpenCV 4.6 trusts their attributes and operands, and
 * some damaged networks end the program that loads them.
 *
 * \param[in] bytes content of the file
 * \param[in] path its name, for messages
 * \throws BadModelException */
OnnxInterface readOnnxInterface(const std::vector<std::uint8_t>& bytes,
                                const std::string& path);

} // namespace pcl_semantic
