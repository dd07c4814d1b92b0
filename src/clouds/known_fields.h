// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/clouds/pcd_table.h>
#include <pcl_semantic/core/export.h>

#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief The field of a cloud that holds labels: `label`, or else another spelling of
 * it (doc/formats.md).
 * \return its index; -1 if there is none */
int findLabelField(const pcl::PCLPointCloud2& cloud);

/** \brief The fields of a cloud that hold probabilities: `probability`, or else another
 * spelling of it, of several elements or one a class (doc/formats.md).
 * \return their indices; none if there is none */
std::vector<int> findProbabilityFields(const PcdTable& table);

/** \brief Brings what is known of points into the fields that are read: puts `label`,
 * `probability` and `rgba` behind the others where a table has them under other names
 * or as other numbers, and takes instances off `label` (classOf()). The fields that
 * they are made of stay. Adds to the doubts of the table what looks like one of these
 * and is not understood.
 * \param[in] path of the file, for the doubts
 * \throws BadInputException if `label` is of single precision, which lost the class of
 * a point beside its instance */
void addKnownFields(const std::string& path, PcdTable& table);

/** \brief Adds a doubt, unless it is there. */
void addDoubt(PcdTable& table, const std::string& doubt);

} // namespace pcl_semantic
