// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/core/threads.h>

#include "fail.h"
#include "thread_limits.h"

#include <omp.h>
#include <vector>

namespace pcl_semantic {

namespace {

std::vector<ThreadLimit>&
threadLimits()
{
  static std::vector<ThreadLimit> limits;
  return limits;
}

} // namespace

bool
addThreadLimit(ThreadLimit limit)
{
  threadLimits().push_back(limit);
  return true;
}

void
setNumberOfThreads(int threads)
{
  if (threads < 0 || threads > 1024)
    badParameter("threads is ", threads, ", expected 0 (all) to 1024");
  const int count = threads == 0 ? omp_get_num_procs() : threads;
  omp_set_num_threads(count);
  for (const ThreadLimit limit : threadLimits())
    limit(count);
}

ThreadScope::ThreadScope(std::optional<int> threads) : before_(omp_get_max_threads())
{
  if (threads)
    setNumberOfThreads(*threads);
}

ThreadScope::~ThreadScope()
{
  omp_set_num_threads(before_);
}

} // namespace pcl_semantic
