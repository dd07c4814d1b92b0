// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/clouds/pcd_table.h>
#include <pcl_semantic/core/export.h>

#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Finds the label field of a cloud: `label` or an alternative spelling
 * (doc/formats.md).
 * \return its index; -1 if there is none */
int findLabelField(const pcl::PCLPointCloud2& cloud);

/** \brief Finds the probability fields of a cloud: `probability` or an alternative
 * spelling, one field with several elements or one per class (doc/formats.md).
 * \return their indices; empty if there are none */
std::vector<int> findProbabilityFields(const PcdTable& table);

/** \brief Converts alternative fields to the standard ones: appends `label`,
 * `probability` and `rgba` if a table has them under other names or in other units, and
 * removes instances from `label` (classOf()). The original fields stay. Fields that
 * resemble these but are unsupported are added to the table's doubts.
 * \param[in] path of the file, for the doubts
 * \throws BadInputException if `label` is of single precision and too large, so that
 * instances have overwritten classes */
void addKnownFields(const std::string& path, PcdTable& table);

/** \brief Adds a doubt once. */
void addDoubt(PcdTable& table, const std::string& doubt);

} // namespace pcl_semantic
