// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_distributions.h>
#include <pcl_semantic/images/sensor_frame.h>
#include <pcl_semantic/io/run_record.h>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Computes the digest of a frame: of its images, or of its cloud.
 * \param[in] labels predicted labels, or those of the cloud; may be empty */
FrameDigest digestOf(const SensorFrame& frame, const LabelDistributions& labels);

} // namespace pcl_semantic
