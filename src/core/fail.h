// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/text_stream.h"

#include <pcl_semantic/core/exceptions.h>

#include <string>

namespace pcl_semantic {

/** \brief Throws an \a Error with the concatenated \a parts as its message. */
template <typename Error, typename... Parts>
[[noreturn]] void
fail(const Parts&... parts)
{
  TextStream message;
  (message << ... << parts);
  throw Error(message.str());
}

/** \brief Throws if a file or a value in it cannot be used. */
template <typename... Parts>
[[noreturn]] void
badInput(const Parts&... parts)
{
  fail<BadInputException>(parts...);
}

/** \brief Throws if a parameter or argument is outside its range. */
template <typename... Parts>
[[noreturn]] void
badParameter(const Parts&... parts)
{
  fail<InvalidParameterException>(parts...);
}

/** \brief Calls \a read and turns InvalidParameterException into BadInputException of
 * its file. */
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
