// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <unistd.h>

namespace pcl_semantic {

/** \brief As long as it lives, this process may do no more than any user: root could
 * write into read-only folders. Tests that need it skip where it cannot be. */
class Unprivileged {
public:
  Unprivileged()
  {
    if (before_ == 0)
      is_effective_ = ::seteuid(nobody) == 0;
  }

  ~Unprivileged()
  {
    if (before_ == 0 && is_effective_) {
      EXPECT_EQ(::seteuid(before_), 0);
    }
  }

  Unprivileged(const Unprivileged&) = delete;
  Unprivileged& operator=(const Unprivileged&) = delete;

  bool
  isEffective() const
  {
    return is_effective_;
  }

private:
  static constexpr uid_t nobody = 65534;

  uid_t before_ = ::geteuid();
  bool is_effective_ = true;
};

} // namespace pcl_semantic
