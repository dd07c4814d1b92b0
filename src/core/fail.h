// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/exceptions.h>

#include <sstream>
#include <string>

namespace pcl_semantic {

/** \brief Throws an \a Error whose message is the parts, one after the other. */
template <typename Error, typename... Parts>
[[noreturn]] void
fail(const Parts&... parts)
{
  std::ostringstream message;
  (message << ... << parts);
  PCL_THROW_EXCEPTION(Error, message.str());
}

/** \brief What \a read returns; a value out of range is an error of its file. */
template <typename Read>
auto
readFrom(const std::string& path, Read&& read)
{
  try {
    return read();
  }
  catch (const InvalidParameterException& error) {
    fail<BadInputException>(path, ": ", error.what());
  }
}

} // namespace pcl_semantic
