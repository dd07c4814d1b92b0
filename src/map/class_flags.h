// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/label_set.h>

#include <array>
#include <cstddef>

namespace pcl_semantic {

/** \brief One flag for every possible label. */
using ClassFlags = std::array<bool, 256>;

/** \brief The labels of the classes that have a mark, such as &LabelClass::dynamic. */
inline ClassFlags
classesWith(bool LabelClass::*mark, const LabelSet& label_set)
{
  ClassFlags flags{};
  for (int label = 1; label <= label_set.size(); ++label)
    flags[std::size_t(label)] = label_set[Label(label)].*mark;
  return flags;
}

} // namespace pcl_semantic
