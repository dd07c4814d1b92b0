// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <csignal>
#include <sys/resource.h>
#include <unistd.h>

namespace pcl_semantic {

/** \brief Limits the size of files that this process writes, during its lifetime;
 * simulates a full disk. */
class FullDisk {
public:
  /** \param[in] bytes at least 1024, the size of a file that LLVM's OpenMP writes at
   * its start */
  explicit FullDisk(rlim_t bytes)
  {
    handler_ = std::signal(SIGXFSZ, SIG_IGN);
    EXPECT_EQ(::getrlimit(RLIMIT_FSIZE, &before_), 0);
    rlimit limit = before_;
    limit.rlim_cur = bytes;
    EXPECT_EQ(::setrlimit(RLIMIT_FSIZE, &limit), 0);
  }

  ~FullDisk()
  {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }

  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

private:
  rlimit before_{};
  void (*handler_)(int) = SIG_DFL;
};

/** \brief Drops root's privileges during its lifetime: root could write into read-only
 * folders. Tests that need it skip if this is impossible. */
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
