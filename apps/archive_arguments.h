// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tool.h"

#include <string>
#include <vector>

namespace pcl_semantic::tool {

/** \brief What pcl_semantic_archive is asked to do. */
struct ArchiveArguments {
  std::string command;
  std::vector<std::string> files;
  std::string box;                  ///< six numbers; empty = everything
  std::vector<std::string> classes; ///< empty = any
};

extern const Usage archive_usage;

/** \return false if only the help or the version was wanted
 * \throws InvalidParameterException */
bool parseArchiveArguments(int argc, char** argv, ArchiveArguments& arguments);

} // namespace pcl_semantic::tool
