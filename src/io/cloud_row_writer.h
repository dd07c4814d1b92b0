// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "files/row_store.h"

#include <pcl_semantic/clouds/pcd_table.h>
#include <pcl_semantic/core/export.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Writes a binary `.pcd` from points in any order, without having all of them
 * in memory. */
class CloudRowWriter {
public:
  /** \param[in] path of the file, whose folder has room for all points twice
   * \param[in] most points of the file */
  CloudRowWriter(std::string path, std::size_t most);

  /** \brief Appends points.
   * \param[in] table its first points are written. Each call has the same fields
   * \param[in] numbers of these points in the file
   * \throws BadInputException if the fields differ from those of other calls
   * \throws OutputException if there is no room */
  void append(const PcdTable& table, const std::vector<std::uint64_t>& numbers);

  /** \brief Writes the file, complete or not at all.
   * \param[in] header width, height, viewpoint and voxel grid of the cloud. The points
   * have the numbers from 0 to width times height
   * \throws OutputException if it cannot be written */
  void write(const PcdTable& header);

private:
  std::string path_;
  std::size_t most_;
  std::vector<pcl::PCLPointField> fields_; // without gaps
  std::size_t row_size_ = 0;
  std::unique_ptr<RowStore> store_;
};

} // namespace pcl_semantic
