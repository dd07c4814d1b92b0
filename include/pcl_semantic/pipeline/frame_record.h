// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/pipeline/semantic_mapper.h>

#include <Eigen/Geometry>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief What is kept of a frame that went into a map. */
struct FrameRecord {
  int number = 0;
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  ScanCounts counts;
  std::vector<std::pair<std::string, double>> seconds; ///< by stage
};

FrameRecord recordOf(const MappedFrame& mapped);

/** \brief A record as bytes, without loss. */
std::vector<std::uint8_t> encodeFrameRecord(const FrameRecord& record);

/** \param[in] number of the frame
 * \throws BadInputException if the bytes are not those of a record */
FrameRecord decodeFrameRecord(int number, const std::vector<std::uint8_t>& bytes);

} // namespace pcl_semantic
