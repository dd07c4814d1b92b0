// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tool.h"

namespace pcl_semantic::tool {

/** \brief What `--help` says as a manual page, in the macros of man(7). */
std::string manualPage(const Usage& usage, const po::options_description& options);

} // namespace pcl_semantic::tool
