/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace pcl_semantic {

/** \brief A field of a point in a `.pcd` file, in PCL's terms. */
struct PcdField {
  std::string name;
  char type = 'F'; ///< F float, U unsigned
  int size = 4;    ///< bytes of an element
  int count = 1;   ///< elements
};

/** \brief Points as the rows of a binary `.pcd` file. */
struct PcdTable {
  std::vector<PcdField> fields;
  std::size_t points = 0;
  std::vector<std::uint8_t> data; ///< points x the sizes of the fields, packed

  /** \brief Bytes of one point. */
  std::size_t pointSize() const;
};

/** \brief Writes a binary, unorganized `.pcd` (version 0.7, identity viewpoint) whole
 * or not at all. PCL's own writer leaves an empty file behind when the disk is full.
 * \throws InvalidParameterException if the data do not fit the fields
 * \throws OutputException if it cannot be written */
void writePcd(const std::string& path, const PcdTable& table);

} // namespace pcl_semantic
