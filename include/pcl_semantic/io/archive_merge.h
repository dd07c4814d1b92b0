// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/io/map_archive.h>

#include <cstdint>
#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Joins maps of the same frame of reference, voxel size, label set and fusion
 * parameters into a new archive, which does not depend on their order. Where several
 * know a voxel, log-odds and label logs are added and clamped, what is unknown adds
 * nothing, colours and counts are summed; a refined distribution is kept where only one
 * has hit the voxel. The result is a map to read; no run goes on with it.
 * \param[in] inputs paths of two or more archives
 * \param[in] output path of one that is not there yet
 * \return number of blocks
 * \throws InvalidParameterException if there are fewer than two inputs
 * \throws BadInputException that says what differs, or if one is damaged
 * \throws OutputException */
std::uint64_t mergeArchives(const std::vector<std::string>& inputs,
                            const std::string& output,
                            const BlockProgress& progress = nullptr);

} // namespace pcl_semantic
