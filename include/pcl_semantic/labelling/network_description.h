// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <array>
#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief What has to be known of a segmentation network (`data/networks`). */
struct NetworkDescription {
  std::string model_path;      ///< ONNX file; empty if the description names none
  std::string label_set_path;  ///< the classes that \a channels name
  std::string input_name;      ///< N x 3 x H x W: (RGB / 255 - mean) / deviation
  int input_width = 0;         ///< [px]
  int input_height = 0;        ///< [px]
  std::string output_name;     ///< N x channels x any H x any W
  bool softmax = true;         ///< the output is logits; else probabilities
  std::array<float, 3> mean{}; ///< red, green, blue
  std::array<float, 3> deviation{{1.0f, 1.0f, 1.0f}}; ///< red, green, blue
  std::vector<std::string> channels; ///< class of each output channel; "-" is none
};

/** \brief Reads a description; its paths are relative to its own folder.
 * \throws BadInputException with file and line, also at a class that its label set does
 * not have */
NetworkDescription readNetworkDescription(const std::string& yaml_path);

} // namespace pcl_semantic
