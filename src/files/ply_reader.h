// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/files/cloud_file.h>

#include <string>

namespace pcl_semantic {

/** \brief Reads the vertices of a `.ply` file, see readCloudTable().
 * \throws BadInputException that names the file and, if possible, the line */
PcdTable readPly(const std::string& path);

} // namespace pcl_semantic
