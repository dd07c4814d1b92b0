// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <locale>
#include <sstream>

namespace pcl_semantic {

/** \brief Makes a text of values, with a point in numbers whatever the locale. Where
 * std::ostringstream would leave out what it has no memory for, it throws
 * std::bad_alloc. */
class TextStream : public std::ostringstream {
public:
  TextStream()
  {
    imbue(std::locale::classic());
    exceptions(std::ios::badbit);
  }
};

} // namespace pcl_semantic
