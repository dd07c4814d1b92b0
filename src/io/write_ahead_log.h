// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace pcl_semantic {

/** \brief What lies in FILE-wal beside an SQLite file, read without SQLite, which
 * believes any log of that name and takes a damaged one for a shorter one. The format:
 * https://www.sqlite.org/walformat.html */
class WriteAheadLog {
public:
  /** \param[in] path of the log; nothing is in one that is missing or empty */
  explicit WriteAheadLog(const std::string& path);

  /** \brief The last committed content of pages, by their numbers, which begin at 1. */
  std::map<std::uint32_t, std::string_view> pages() const;

  /** \brief Commits that lie behind something damaged, so that SQLite does not see
   * them; 0 also if the log is being written meanwhile. */
  std::size_t
  lostCommits() const
  {
    return lost_commits_;
  }

  /** \brief Where the damage begins. [bytes] */
  std::size_t
  end() const
  {
    return end_;
  }

private:
  void follow();

  std::size_t frames() const;

  std::vector<std::uint8_t> bytes_;
  std::size_t page_size_ = 0;
  std::size_t end_ = 0; // of the last commit that SQLite sees
  std::size_t lost_commits_ = 0;
};

} // namespace pcl_semantic
