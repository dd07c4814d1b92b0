// SPDX-License-Identifier: BSD-3-Clause
#include "core/parallel_guard.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/threads.h>

#include <gtest/gtest.h>
#include <omp.h>

#include <new>

namespace pcl_semantic {

TEST(ThreadScope, SetsTheNumberUntilItsEnd)
{
  const int before = omp_get_max_threads();
  {
    const ThreadScope three(3);
    EXPECT_EQ(omp_get_max_threads(), 3);
    {
      const ThreadScope same(std::nullopt);
      EXPECT_EQ(omp_get_max_threads(), 3);
    }
    {
      const ThreadScope all(0);
      EXPECT_EQ(omp_get_max_threads(), omp_get_num_procs());
    }
    EXPECT_EQ(omp_get_max_threads(), 3);
  }
  EXPECT_EQ(omp_get_max_threads(), before);
}

TEST(ThreadScope, LeavesTheNumberWhenItRefusesOne)
{
  const int before = omp_get_max_threads();
  EXPECT_THROW(ThreadScope(-1), InvalidParameterException);
  EXPECT_THROW(ThreadScope(1025), InvalidParameterException);
  EXPECT_EQ(omp_get_max_threads(), before);
}

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

} // namespace pcl_semantic
