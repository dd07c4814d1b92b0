// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace pcl_semantic {

/** \brief The inputs of a network, and all tensors that can be outputs. */
struct OnnxInterface {
  struct Input {
    std::string name;
    std::vector<std::int64_t> size; ///< batch, channels, rows, columns; -1 = any
  };

  std::vector<Input> inputs;        ///< without weights
  std::vector<std::string> outputs; ///< of the network
  std::vector<std::string> inner;   ///< of all nodes, including the outputs
};

/** \brief Reads the interface of an ONNX file. Refuses faults without an error later: a
 * truncated file, a file of another format, and tensors with external data or too
 * little data, where OpenCV 4.6 reads out of bounds.
 *
 * It does not check the operators. OpenCV 4.6 trusts their attributes and operands, and
 * some damaged networks end the program that loads them.
 *
 * \param[in] bytes content of the file
 * \param[in] path its name, for messages
 * \throws BadModelException */
OnnxInterface readOnnxInterface(const std::vector<std::uint8_t>& bytes,
                                const std::string& path);

} // namespace pcl_semantic
