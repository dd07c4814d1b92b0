// SPDX-License-Identifier: BSD-3-Clause

#include "core/parallel_guard.h"

#include <gtest/gtest.h>

#include <new>

using namespace pcl_semantic;

TEST(ParallelGuard, CarriesAnExceptionOutOfTheRegion)
{
  ParallelGuard guard;
  int done = 0;
#pragma omp parallel for num_threads(4) reduction(+ : done)
  for (int i = 0; i < 100; ++i)
    guard.run([&] {
      if (i % 50 == 7)
        throw std::bad_alloc();
      ++done;
    });
  EXPECT_EQ(done, 98);
  EXPECT_THROW(guard.rethrow(), std::bad_alloc);
}

TEST(ParallelGuard, IsQuietWhenNothingWasThrown)
{
  ParallelGuard guard;
  guard.run([] {});
  EXPECT_NO_THROW(guard.rethrow());
}
