// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/pipeline/semantic_mapper.h>

#include <Eigen/Geometry>

#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief What is kept of a frame that went into a map. */
struct FrameRecord {
  int number = 0;
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  ScanCounts counts;
  std::vector<std::pair<std::string, double>> seconds;            ///< by stage
  double domain_shift = std::numeric_limits<double>::quiet_NaN(); ///< see MappedFrame
};

FrameRecord recordOf(const MappedFrame& mapped);

/** \brief A record as bytes, without loss; older ones end before \a domain_shift. */
std::vector<std::uint8_t> encodeFrameRecord(const FrameRecord& record);

/** \param[in] number of the frame
 * \throws BadInputException if the bytes are not those of a record */
FrameRecord decodeFrameRecord(int number, const std::vector<std::uint8_t>& bytes);

} // namespace pcl_semantic
