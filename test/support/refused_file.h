// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "support/temporary_folder.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>

#include <string>

namespace pcl_semantic {

/** \brief EXPECTs that a file is refused in one line with its path and \a part.
 * \param[in] read reads the file at the given path */
template <typename Read>
::testing::AssertionResult
refusesFile(const std::string& name, const std::string& bytes, const std::string& part,
            Read&& read)
{
  const TemporaryFolder folder;
  const std::string path = folder.write(name, bytes);
  const std::string message = thrownMessage<BadInputException>([&] { read(path); });
  EXPECT_TRUE(holds(message, path));
  return holds(message, part);
}

} // namespace pcl_semantic
