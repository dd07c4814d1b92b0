// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace pcl_semantic {

/** \brief As long as it lives, this process sleeps a microsecond at most at a time: for
 * tests in which an archive waits in vain for other programs, as it does before each
 * refusal (support/no_waits.cpp has to be linked). */
class NoWaits {
public:
  NoWaits();
  ~NoWaits();
  NoWaits(const NoWaits&) = delete;
  NoWaits& operator=(const NoWaits&) = delete;
};

} // namespace pcl_semantic
