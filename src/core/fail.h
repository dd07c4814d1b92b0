// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/text_stream.h"

#include <pcl_semantic/core/exceptions.h>

#include <string>

namespace pcl_semantic {

/** \brief Throws an \a Error whose message is the \a parts, one after the other. */
template <typename Error, typename... Parts>
[[noreturn]] void
fail(const Parts&... parts)
{
  TextStream message;
  (message << ... << parts);
  throw Error(message.str());
}

/** \brief The same: a file or a value in it cannot be used. */
template <typename... Parts>
[[noreturn]] void
badInput(const Parts&... parts)
{
  fail<BadInputException>(parts...);
}

/** \brief The same: a parameter or argument is outside its range. */
template <typename... Parts>
[[noreturn]] void
badParameter(const Parts&... parts)
{
  fail<InvalidParameterException>(parts...);
}

/** \brief Returns the result of \a read; a value out of range is an error of its file.
 */
template <typename Read>
auto
readFrom(const std::string& path, Read&& read)
{
  try {
    return read();
  }
  catch (const InvalidParameterException& error) {
    badInput(path, ": ", error.what());
  }
}

} // namespace pcl_semantic
