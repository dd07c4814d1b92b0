// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <charconv>
#include <string_view>
#include <system_error>

namespace pcl_semantic {

/** \brief Reads a number in the C locale. \return whether \a text is one, the whole of
 * it, and fits the type; else \a value stays */
template <typename Number>
bool
parseWhole(std::string_view text, Number& value)
{
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && rest == end;
}

} // namespace pcl_semantic
