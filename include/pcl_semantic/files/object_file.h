// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/things/object_summary.h>

#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Writes objects as JSON, see doc/things.md.
 * \param[in] label_set for the names of their classes; without classes, names are left
 * out
 * \throws OutputException if the file cannot be written */
void writeObjects(const std::string& path, const std::vector<ObjectSummary>& objects,
                  const LabelSet& label_set);

/** \brief Reads a file of writeObjects(). Unknown keys are ignored. An object without
 * `frames` has no track.
 * \param[in] label_set has to contain the labels, with the same names of classes;
 * without classes, any label fits
 * \throws BadInputException if the file cannot be read, or a value is missing or
 * invalid */
std::vector<ObjectSummary> readObjects(const std::string& path,
                                       const LabelSet& label_set);

/** \brief Writes the edges of the yaw boxes as lines (.ply), in the colours of their
 * classes.
 * \param[in] label_set for the colours; without classes, boxes are white
 * \throws OutputException if the file cannot be written */
void writeBoxes(const std::string& path, const std::vector<ObjectSummary>& objects,
                const LabelSet& label_set);

} // namespace pcl_semantic
