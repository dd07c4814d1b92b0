// SPDX-License-Identifier: BSD-3-Clause
#include "progress_bar.h"
#include "messages.h"

#include <cstdio>

#include <unistd.h>

namespace pcl_semantic::tool {

ProgressBar::ProgressBar(std::string what, std::size_t total, std::string unit)
    : what_(std::move(what)), total_(total), unit_(std::move(unit)),
      terminal_(isatty(STDERR_FILENO) == 1 && !manner().quiet && !manner().verbose)
{}

ProgressBar::~ProgressBar()
{
  if (barIsDrawn())
    std::fprintf(stderr, "\n");
  setBarIsDrawn(false);
}

void
ProgressBar::step()
{
  ++done_;
  note(what_ + " " + std::to_string(done_) + " of " + std::to_string(total_));
  const Clock::time_point now = Clock::now();
  const bool is_last = done_ == total_;
  if (!terminal_ || now < (is_last ? start_ + std::chrono::seconds(1) : next_))
    return;
  next_ = now + std::chrono::milliseconds(100);
  const double seconds = std::chrono::duration<double>(now - start_).count();
  constexpr int width = 30;
  const int filled = static_cast<int>(width * done_ / total_);
  const double rate = double(done_) / seconds;
  std::fprintf(stderr, "\r%s [%s%s] %zu/%zu  %.1f %s/s  %.0f s left ", what_.c_str(),
               std::string(filled, '#').c_str(),
               std::string(width - filled, '.').c_str(), done_, total_, rate,
               unit_.c_str(), double(total_ - done_) / rate);
  std::fflush(stderr);
  setBarIsDrawn(true);
}

} // namespace pcl_semantic::tool
