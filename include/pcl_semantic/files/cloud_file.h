// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/files/pcd_table.h>

#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Extensions of the files that readCloudTable() reads: `.pcd .ply .bin`. */
const std::vector<std::string>& cloudExtensions();

/** \brief Reads a cloud by the extension of its file.
 *
 * `.pcd`: ascii, binary or compressed. `.ply`: ascii or little-endian, the scalar
 * properties of its vertices; red, green and blue become `rgba`, CloudCompare's
 * `scalar_label` becomes `label`; faces are passed over. `.bin`: KITTI's scans (float32
 * x y z intensity) with the `label` of the `.label` file (uint32, the lower 16 bits) of
 * the same name beside it or in `../labels`, if there is one.
 * \throws BadInputException that names the file, and the line where there is one */
PcdTable readCloudTable(const std::string& path);

/** \brief Writes a binary `.pcd`, whole or not at all.
 * \throws InvalidParameterException if fields, data, width and height do not fit
 * \throws OutputException if it cannot be written */
void writeCloudTable(const std::string& path, const PcdTable& table);

} // namespace pcl_semantic
