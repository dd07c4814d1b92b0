// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_distributions.h>
#include <pcl_semantic/images/sensor_frame.h>
#include <pcl_semantic/io/run_record.h>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief The digest of a pair, whose labels are beside it, or of a cloud.
 * \param[in] labels as they were predicted, or those of the cloud; may be empty */
FrameDigest digestOf(const StereoFrame& pair, const LabelDistributions& labels);
FrameDigest digestOf(const pcl::PointCloud<pcl::PointXYZRGB>& cloud,
                     const LabelDistributions& labels);

} // namespace pcl_semantic
