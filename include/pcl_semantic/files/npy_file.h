/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#pragma once

#include <string>
#include <vector>

namespace pcl_semantic {

/** \brief A NumPy array of three axes, row-major. */
struct NpyArray {
  int height = 0;
  int width = 0;
  int depth = 0;
  std::vector<float> values; ///< height x width x depth, the last axis fastest
};

/** \brief Reads an `.npy` file: little-endian float32 or float16, C order, three axes.
 * \throws BadInputException that says what differs */
NpyArray readNpy(const std::string& path);

} // namespace pcl_semantic
