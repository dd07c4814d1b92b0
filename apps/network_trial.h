// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/labelling/opened_network.h>

#include <optional>
#include <string>

namespace pcl_semantic::tool {

/** \brief Opens a network after a trial in a separate process, with bounded memory and
 * time. The trial loads the network and labels one grey image, because engines trust
 * their files and some files end the program. The exit code of the trial is ignored:
 * loading the network afterwards reports its errors. Each network is tried once.
 *
 * \param[in] description, model, engine as for openNetwork()
 * \throws BadModelException also if a signal ends the trial, or it does not end
 * \throws std::bad_alloc if it runs out of memory */
OpenedNetwork openTriedNetwork(const std::string& description, const std::string& model,
                               const std::string& engine);

/** \brief Runs a trial. Programs that open networks call it first in main().
 * \return exit code, if openTriedNetwork() started this process */
std::optional<int> runAsNetworkTrial(int argc, char** argv);

} // namespace pcl_semantic::tool
