// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/files/cloud_file.h>

#include <string>

namespace pcl_semantic {

/** \brief Reads the vertices of a `.ply` file as readCloudTable() says.
 * \throws BadInputException that names the file, and the line where there is one */
PcdTable readPly(const std::string& path);

} // namespace pcl_semantic
