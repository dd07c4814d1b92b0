// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/core/threads.h>

#include "fail.h"

#include <opencv2/core/utility.hpp>

#include <algorithm>
#include <omp.h>

namespace pcl_semantic {

void
setNumberOfThreads(int threads)
{
  if (threads < 0 || threads > 1024)
    badParameter("threads is ", threads, ", expected 0 (all) to 1024");
  const int count = threads == 0 ? omp_get_num_procs() : threads;
  omp_set_num_threads(count);
  // TBB complains on standard error when asked for more than there are; and OpenCV's
  // number is of the process, and must not be changed while another thread uses it.
  const int of_opencv = std::min(count, cv::getNumberOfCPUs());
  if (cv::getNumThreads() != of_opencv)
    cv::setNumThreads(of_opencv);
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
