// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_set.h>

#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief The labels of class names with commas between them; of "none" there are none.
 * \param[in] what has the list, for messages: "--ground"
 * \throws InvalidParameterException at a name that is not in the label set */
std::vector<Label> listedLabels(const std::string& names, const LabelSet& label_set,
                                const std::string& what);

} // namespace pcl_semantic
