// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/clouds/pcd_table.h>
#include <pcl_semantic/core/export.h>

#include <cstddef>
#include <fstream>
#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Reads parts of a binary `.pcd` file, for clouds larger than memory. */
class PcdReader {
public:
  /** \brief Whether a path names a `.pcd` file with binary points, whose parts can be
   * read. \throws BadInputException as readCloudTable(), if it is a `.pcd` */
  static bool canRead(const std::string& path);

  /** \throws BadInputException as readCloudTable(), or if the points are not binary */
  explicit PcdReader(const std::string& path);

  const std::string&
  path() const
  {
    return path_;
  }

  /** \brief The cloud without its data. */
  const PcdTable&
  header() const
  {
    return header_;
  }

  /** \brief Number of points. */
  std::size_t
  size() const
  {
    return header_.points();
  }

  /** \brief Some consecutive points, as a cloud of height 1 whose rows are those of the
   * file. The fields are not converted yet (readCloudTable() does).
   * \throws BadInputException if the file became shorter */
  PcdTable read(std::size_t first, std::size_t count);

private:
  std::string path_;
  PcdTable header_;
  std::size_t data_offset_ = 0;
  std::ifstream stream_;
};

} // namespace pcl_semantic
