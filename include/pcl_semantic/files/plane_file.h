// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/things/plane_summary.h>

#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Writes planes as JSON, see doc/things.md.
 * \param[in] label_set for the names of their classes; without classes, names are left
 * out
 * \throws OutputException if the file cannot be written */
void writePlanes(const std::string& path, const std::vector<PlaneSummary>& planes,
                 const LabelSet& label_set);

/** \brief Reads a file of writePlanes(). Unknown keys are ignored.
 * \param[in] label_set has to contain the labels, with the same names of classes;
 * without classes, any label fits
 * \throws BadInputException if the file cannot be read, or a value is missing or
 * invalid */
std::vector<PlaneSummary> readPlanes(const std::string& path,
                                     const LabelSet& label_set);

/** \brief Writes the outlines of planes and their holes as lines (.ply), in the colours
 * of their classes.
 * \param[in] label_set for the colours; without classes, and for planes without a
 * label, outlines are white
 * \throws OutputException if the file cannot be written */
void writePolygons(const std::string& path, const std::vector<PlaneSummary>& planes,
                   const LabelSet& label_set);

} // namespace pcl_semantic
