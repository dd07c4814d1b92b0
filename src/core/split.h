// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <string_view>
#include <vector>

// Without streams, which treat a lack of memory as the end of a text.

namespace pcl_semantic {

/** \brief Splits a text at separators; a trailing separator adds no empty part. */
inline std::vector<std::string_view>
splitAt(char separator, std::string_view text)
{
  std::vector<std::string_view> parts;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(separator), text.size());
    parts.push_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return parts;
}

/** \brief Splits a text at white space. */
inline std::vector<std::string_view>
wordsOf(std::string_view text)
{
  constexpr const char* white = " \t\r\n\f\v";
  std::vector<std::string_view> words;
  for (std::size_t begin = 0;
       (begin = text.find_first_not_of(white, begin)) != std::string_view::npos;) {
    const std::size_t end = std::min(text.find_first_of(white, begin), text.size());
    words.push_back(text.substr(begin, end - begin));
    begin = end;
  }
  return words;
}

} // namespace pcl_semantic
