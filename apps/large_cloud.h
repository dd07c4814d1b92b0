// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "io/cloud_survey.h"
#include "io/cloud_tiles.h"

#include <pcl_semantic/core/label_set.h>

#include <cstddef>
#include <functional>
#include <memory>
#include <string>

/** \file Clouds that do not fit into memory, for the programs that read them in tiles.
 */

namespace pcl_semantic::tool {

/** \brief Help of the option --memory. */
constexpr const char* kMemoryHelp =
    "memory [GB], 0 = half of it; a larger binary .pcd is read in tiles";

/** \brief Memory that a program needs for a cloud. */
struct CloudNeeds {
  double fixed = 0.0;     ///< up to a million points, in proportion [bytes]
  double per_point = 0.0; ///< beside the fields of the file [bytes]
};

/** \brief The memory of an option in bytes; 0 = half of the machine's, or of the
 * control group's.
 * \param[in] gigabytes of the option
 * \throws InvalidParameterException unless it is at least 0.3, or 0 */
std::size_t memoryOf(double gigabytes);

/** \brief Whether a cloud has to be read in tiles. Warns in one line if it does not fit
 * but cannot be read in parts. */
bool needsTiles(const std::string& path, const CloudNeeds& needs, std::size_t memory);

/** \brief Points in a tile and its surroundings that fit into memory, at most a
 * million. */
std::size_t pointsOfTile(const CloudNeeds& needs, std::size_t point_step,
                         std::size_t memory);

/** \brief surveyCloud() with a progress bar and warnings of its doubts.
 * \param[in] measures_spacing calls measureSpacing(), too */
CloudSurvey surveyWithProgress(PcdReader& reader, const LabelMapping* mapping,
                               bool measures_spacing);

/** \brief Divides a cloud into tiles beside its output, with a progress bar.
 * \param[in] output path of the output */
std::unique_ptr<CloudTiles> divideWithProgress(PcdReader& reader,
                                               const CloudSurvey& survey,
                                               const TileOptions& options,
                                               const std::string& output);

/** \brief Calls a function with each tile, with a progress bar.
 * \param[in] what "refining" */
void forEachTileOf(const CloudTiles& tiles, const std::string& what,
                   const std::function<void(CloudTile)>& use);

} // namespace pcl_semantic::tool
