// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/label_set.h>

#include <optional>
#include <string>
#include <vector>

namespace pcl_semantic::tool {

/** \brief The classes whose ground truth counts.
 * \param[in] ignored numbers or names of the others with commas between them, or
 * "none"; not given: sky, pedestrian and cyclist, as far as there are such classes
 * \throws InvalidParameterException at a word that is no class, or if none is left */
std::vector<Label> evaluatedClasses(const std::optional<std::string>& ignored,
                                    const LabelSet& label_set);

} // namespace pcl_semantic::tool
