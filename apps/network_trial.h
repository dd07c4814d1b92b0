// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/labelling/opened_network.h>

#include <optional>
#include <string>

namespace pcl_semantic::tool {

/** \brief openNetwork() after a trial: loads the network and has it label one grey
 * image, in a process of its own with bounded memory and time: engines trust the files
 * they read, and some of these end the program. The exit code of the process is
 * ignored: loading the network afterwards reports its errors. Once for each network.
 *
 * \param[in] description, model, engine as openNetwork() takes them
 * \throws BadModelException also if a signal ends the process, or it does not end
 * \throws std::bad_alloc if it runs out of memory */
OpenedNetwork openTriedNetwork(const std::string& description, const std::string& model,
                               const std::string& engine);

/** \brief The first thing that main() does in programs that open networks.
 * \return exit code, if this is the process that openTriedNetwork() has started */
std::optional<int> runAsNetworkTrial(int argc, char** argv);

} // namespace pcl_semantic::tool
