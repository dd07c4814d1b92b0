// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/abi_check.h>
#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/files/cloud_file.h>

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Reads a scan of KITTI's Velodyne (`velodyne/\*.bin`: per point, float32 x, y,
 * z, reflectance).
 * \return points in the scanner's frame (x forward, y left, z up) [m], intensity =
 * reflectance, including no-returns (isReturn())
 * \param[in] columns of another scanner, see readCloudTable(); without intensity it is
 * 0
 * \throws BadInputException if the file contains no points, an incomplete point, a
 * non-finite number, or other columns */
pcl::PointCloud<pcl::PointXYZI>::Ptr readVelodyneScan(const std::string& path,
                                                      const ScanColumns& columns = {});

/** \brief Reads the numbers of a file in SemanticKITTI's format: the lower 16 bits are
 * the class, the upper ones the object (0 = none). Objects of different classes may
 * have the same upper bits.
 * \throws BadInputException if it contains an incomplete number */
std::vector<std::uint32_t> readScanNumbers(const std::string& path);

/** \brief Reads the labels of a scan in SemanticKITTI's format (`labels/\*.label`:
 * uint32 per point; the lower 16 bits are the class, the upper ones the instance).
 * \param[in] path file
 * \param[in] mapping raw class ids to labels
 * \param[in] count number of points of the scan
 * \return one label per point
 * \throws BadInputException unless there are \a count labels */
std::vector<Label> readSemanticKittiLabels(const std::string& path,
                                           const LabelMapping& mapping,
                                           std::size_t count);

/** \brief Reads a file in the same format, without mapping, for any number of points.
 * \param[in] classes L
 * \throws BadInputException if it contains an incomplete label or a class beyond L */
std::vector<Label> readScanLabels(const std::string& path, int classes);

/** \brief Largest object number that fits into the format. */
constexpr std::uint32_t kMaxScanObject = 0xFFFF;

/** \brief Writes labels in the same format.
 * \param[in] objects number of the object of each point, or empty. Numbers above
 * kMaxScanObject are written as 0
 * \throws OutputException if the file cannot be written */
void writeScanLabels(const std::string& path, const std::vector<Label>& labels,
                     const std::vector<std::uint32_t>& objects = {});

} // namespace pcl_semantic
