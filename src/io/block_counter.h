// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/io/map_archive.h>

namespace pcl_semantic {

/** \brief Counts blocks for somebody who may want to see it. */
class BlockCounter {
public:
  /** \param[in] progress may be empty
   * \param[in] blocks that there are */
  BlockCounter(const BlockProgress& progress, std::size_t blocks)
      : progress_(progress), blocks_(blocks)
  {}

  void
  step()
  {
    ++done_;
    if (progress_)
      progress_(done_, blocks_);
  }

private:
  const BlockProgress& progress_;
  std::size_t blocks_;
  std::size_t done_ = 0;
};

} // namespace pcl_semantic
