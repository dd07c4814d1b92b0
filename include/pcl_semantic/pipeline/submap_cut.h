// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/frame_time.h>
#include <pcl_semantic/io/submaps.h>
#include <pcl_semantic/pipeline/opened_inputs.h>

#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief The frames of a submap. */
struct SubmapFrames {
  std::string range; ///< "A:B", see parseFrameRange()
  FrameTime anchor;  ///< the middle frame, see submapMotion()
};

/** \brief Parses the length of a submap: "50m", or "100" frames.
 * \param[in] inputs that will be cut
 * \throws InvalidParameterException also if their poses are known only from the clouds
 */
SubmapLength parseSubmapLength(const std::string& text, const MapInputs& inputs);

/** \brief Cuts a recording into submaps. Each is mapped by a separate run.
 * \throws BadInputException if a frame has no pose */
std::vector<SubmapFrames> cutIntoSubmaps(const OpenedInputs& inputs,
                                         const SubmapLength& length);

} // namespace pcl_semantic
