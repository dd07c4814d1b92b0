// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/stereo_frame.h>

#include <algorithm>
#include <vector>

namespace pcl_semantic {

/** \brief The check of PoseSource::requirePoses().
 * \param[in] lacks tells whether a frame has no pose
 * \param[in] lackOf says so of a frame
 * \throws BadInputException */
template <typename Lacks, typename LackOf>
void
requireNoneLacks(const std::vector<FrameTime>& frames, const Lacks& lacks,
                 const LackOf& lackOf)
{
  const auto first = std::find_if(frames.begin(), frames.end(), lacks);
  if (first != frames.end())
    PCL_THROW_EXCEPTION(BadInputException,
                        lackOf(*first)
                            << "; " << std::count_if(first, frames.end(), lacks)
                            << " of " << frames.size() << " frames lack one");
}

} // namespace pcl_semantic
