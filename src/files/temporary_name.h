// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace pcl_semantic {

/** \brief Where this process writes a file until it gets its name: hidden, in the same
 * folder, `.NAME.HOST.PROCESS.tmp`. */
std::string temporaryNameOf(const std::string& path);

/** \brief Removes the temporary files of a folder whose process was on this machine and
 * has ended; those of SQLite beside them too. */
void removeAbandoned(const std::string& folder);

} // namespace pcl_semantic
