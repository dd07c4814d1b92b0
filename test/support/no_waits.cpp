// SPDX-License-Identifier: BSD-3-Clause
//
// The function of the C library that this file defines takes the place of its own in
// the program that it is linked to, and in all libraries of that program.
#include "support/no_waits.h"

#include <atomic>
#include <ctime>

#include <sys/syscall.h>
#include <unistd.h>

namespace pcl_semantic {

namespace {

std::atomic<int> without_waits{0};

} // namespace

NoWaits::NoWaits()
{
  ++without_waits;
}

NoWaits::~NoWaits()
{
  --without_waits;
}

} // namespace pcl_semantic

// What std::this_thread::sleep_for() calls.
extern "C" int
nanosleep(const struct timespec* time, struct timespec* left)
{
  static const struct timespec little = {0, 1000};
  return int(
      ::syscall(SYS_nanosleep, pcl_semantic::without_waits > 0 ? &little : time, left));
}
