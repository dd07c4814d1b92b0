// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/threads.h>

#include <gtest/gtest.h>
#include <omp.h>

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

} // namespace pcl_semantic
