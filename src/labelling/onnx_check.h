// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace pcl_semantic {

/** \brief What a network takes, and everything in it that can be asked for. */
struct OnnxInterface {
  struct Input {
    std::string name;
    std::vector<std::int64_t> size; ///< batch, channels, rows, columns; -1 = any
  };

  std::vector<Input> inputs;        ///< without those that are weights
  std::vector<std::string> outputs; ///< of the network
  std::vector<std::string> inner;   ///< of all nodes, these outputs too
};

/** \brief Checks an ONNX file before an engine reads it: OpenCV 4.6 trusts the
 * dimensions of tensors and ends the program where they exceed the data.
 *
 * Walks the protocol buffer as far as tensors go and requires that it is well formed,
 * has at least one node, that every node has inputs and outputs and that every tensor
 * has exactly the data its dimensions state. \param[in] bytes content of the file
 * \param[in] path its name, for messages
 * \throws BadModelException */
OnnxInterface checkOnnx(const std::vector<std::uint8_t>& bytes,
                        const std::string& path);

} // namespace pcl_semantic
