// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/files/cloud_file.h>

#include <string>

namespace pcl_semantic {

/** \brief The field of a cloud that holds labels: `label`, or else another spelling of
 * it (doc/formats.md).
 * \return its index; -1 if there is none */
int findLabelField(const pcl::PCLPointCloud2& cloud);

/** \brief Brings what is known of points into the fields that are read: puts `label`,
 * `probability` and `rgba` behind the others where a table has them under other names
 * or as other numbers, and takes instances off `label` (classOf()). The fields that
 * they are made of stay. Adds to the doubts of the table what looks like one of these
 * and is not understood.
 * \param[in] path of the file, for the doubts */
void addKnownFields(const std::string& path, PcdTable& table);

/** \brief Adds a doubt, unless it is there. */
void addDoubt(PcdTable& table, const std::string& doubt);

} // namespace pcl_semantic
