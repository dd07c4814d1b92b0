// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/abi_check.h>
#include <pcl_semantic/core/export.h>

#include <Eigen/Core>

#include <cstddef>
#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief A row-major NumPy array with three axes. */
struct NpyArray {
  int height = 0;
  int width = 0;
  int depth = 0;
  Eigen::MatrixXf values;  ///< depth x (height * width), columns row by row
  bool is_rounded = false; ///< to multiples of 1 / 255
};

/** \brief Reads an `.npy` file: little-endian float32 or float16, or uint8 in units of
 * 1 / 255, C order, three axes. A name that ends in `.zst` is compressed by zstd.
 * \param[in] most values that are expected; a compressed file with more is refused
 * before it is unpacked
 * \throws BadInputException that names the difference, if the file has another format
 */
NpyArray readNpy(const std::string& path, std::size_t most = std::size_t(1) << 30);

/** \brief Stored type of the values in an `.npy` file. */
enum class NpyType {
  float32,
  float16, ///< half the size; values rounded to 11 bits
  uint8    ///< a quarter of the size; values from 0 to 1 in units of 1 / 255
};

/** \brief Writes a little-endian `.npy` file in C order, three axes. A name that ends
 * in
 * `.zst` is compressed by zstd.
 * \param[in] values height x width x depth, the last axis fastest
 * \throws OutputException if the file cannot be written */
void writeNpy(const std::string& path, int height, int width, int depth,
              const float* values, NpyType type);

} // namespace pcl_semantic
