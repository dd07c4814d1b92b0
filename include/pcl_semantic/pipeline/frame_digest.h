// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_distributions.h>
#include <pcl_semantic/images/sensor_frame.h>

#include <cstdint>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Tells whether a frame is the one that a map was made from; it tells what was
 * changed by mistake, not what was forged. */
struct FrameDigest {
  std::uint64_t data = 0;   ///< of images or points; 0 = not known
  std::uint64_t labels = 0; ///< 0 = not known, or it has none
};

/** \brief That of a pair, whose labels are beside it, or of a cloud.
 * \param[in] labels as they were predicted, or those of the cloud; may be empty */
FrameDigest digestOf(const StereoFrame& pair, const LabelDistributions& labels);
FrameDigest digestOf(const pcl::PointCloud<pcl::PointXYZRGB>& cloud,
                     const LabelDistributions& labels);

} // namespace pcl_semantic
