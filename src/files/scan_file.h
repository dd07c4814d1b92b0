// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/files/cloud_file.h>

#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Reads the points of a scan without header, as readCloudTable() does.
 * \throws BadInputException that names the file */
PcdTable readScanPoints(const std::string& path, const ScanColumns& columns);

/** \brief Likewise with the labels of the `.label` file that belongs to it, if there is
 * one: beside it, or in the folder `labels` beside the folder that \a path names, be it
 * a symbolic link or not. */
PcdTable readScan(const std::string& path, const ScanColumns& columns);

} // namespace pcl_semantic
