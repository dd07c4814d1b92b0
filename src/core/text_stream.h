// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <locale>
#include <sstream>

namespace pcl_semantic {

/** \brief Formats values as text with a decimal point in any locale. It throws
 * std::bad_alloc, where std::ostringstream would silently drop text. */
class TextStream : public std::ostringstream {
public:
  TextStream()
  {
    imbue(std::locale::classic());
    exceptions(std::ios::badbit);
  }
};

} // namespace pcl_semantic
