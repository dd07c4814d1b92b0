// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/files/cloud_file.h>

#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Reads the points of a scan without header, see readCloudTable().
 * \throws BadInputException that names the file */
PcdTable readScanPoints(const std::string& path, const ScanColumns& columns);

/** \brief Reads a scan with the labels of its `.label` file, if there is one: in the
 * same folder, or in the folder `labels` beside the folder in \a path, even if that is
 * a symbolic link. */
PcdTable readScan(const std::string& path, const ScanColumns& columns);

} // namespace pcl_semantic
