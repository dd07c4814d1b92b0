// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <charconv>
#include <string_view>
#include <system_error>

namespace pcl_semantic {

/** \brief Parses a number in the C locale.
 * \return whether the whole \a text is a number that fits the type; otherwise \a value
 * stays unchanged */
template <typename Number>
bool
parseWhole(std::string_view text, Number& value)
{
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && rest == end;
}

} // namespace pcl_semantic
