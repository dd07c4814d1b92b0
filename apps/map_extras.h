// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "map_arguments.h"

#include <pcl_semantic/dataset/frame_sequence.h>
#include <pcl_semantic/pipeline/mapping_output.h>

namespace pcl_semantic::tool {

/** \brief What --also asks for.
 * \param[in] sequence null for clouds, which have no scans beside them
 * \throws InvalidParameterException at a word that it does not know, or a value of
 * --scan-within that makes no sense
 * \throws BadInputException if a frame has no scan, or nobody knows the scanner's pose
 */
ExtraOptions makeExtras(const MapArguments& arguments, const FrameSequence* sequence,
                        const std::vector<std::size_t>& frames);

} // namespace pcl_semantic::tool
