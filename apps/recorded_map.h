// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "map_options.h"
#include "messages.h"

#include <pcl_semantic/pipeline/submap_cut.h>

namespace pcl_semantic::tool {

/** \brief Sets the number of threads and opens the inputs of a map, after a trial of
 * the network. \throws as openInputs() */
OpenedInputs openInputsOf(const MapInputs& inputs, const MapperConfig& config,
                          VideoOpener open_videos = nullptr);

/** \brief Maps a recording until its end or an interrupt (interrupted()).
 * \return its outputs
 * \throws exceptions of a tool's body */
Results mapRecording(const MapOptions& options, OpenedInputs inputs);

/** \brief Maps a recording into an archive only, unless it contains that map already.
 * \param[in] run its outputs are an archive that is resumed
 * \return whether anything was mapped */
bool mapIntoArchive(const MapOptions& run);

/** \brief The outputs of a submap: an archive and a folder, named by its first
 * frame. */
MapOutputs submapOutputs(const MapOutputs& outputs, const std::string& frames);

} // namespace pcl_semantic::tool
