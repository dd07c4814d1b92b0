// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Rows of equal size on disk, sorted into buckets. The file has no name, so it
 * disappears with the process. */
class RowStore {
public:
  /** \param[in] folder that has room for the rows
   * \param[in] row_size bytes of a row
   * \param[in] buckets number of them
   * \throws OutputException if the folder cannot be written */
  RowStore(std::string folder, std::size_t row_size, std::size_t buckets);
  ~RowStore();
  RowStore(const RowStore&) = delete;
  RowStore& operator=(const RowStore&) = delete;

  std::size_t
  rowSize() const
  {
    return row_size_;
  }

  /** \brief Number of buckets. */
  std::size_t
  size() const
  {
    return buckets_.size();
  }

  /** \brief Appends a row to a bucket.
   * \throws OutputException if it cannot be written */
  void append(std::size_t bucket, const std::uint8_t* row);

  /** \brief The rows of a bucket in the order in which they were appended.
   * \throws OutputException if they cannot be read */
  std::vector<std::uint8_t> read(std::size_t bucket) const;

private:
  struct Bucket {
    std::vector<std::uint8_t> last;    // rows that are not on disk yet
    std::vector<std::uint64_t> chunks; // offsets of full chunks
  };

  void flush(Bucket& bucket);

  [[noreturn]] void refuse() const;

  std::string folder_;
  std::size_t row_size_, chunk_size_;
  std::vector<Bucket> buckets_;
  int file_ = -1;
  std::uint64_t end_ = 0; // of the file
};

} // namespace pcl_semantic
