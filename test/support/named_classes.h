// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/label_set.h>

#include <initializer_list>
#include <vector>

namespace pcl_semantic {

/** \brief Classes with these names, without marks. */
inline std::vector<LabelClass>
namedClasses(std::initializer_list<const char*> names)
{
  std::vector<LabelClass> classes;
  for (const char* const name : names) {
    classes.emplace_back();
    classes.back().name = name;
  }
  return classes;
}

} // namespace pcl_semantic
