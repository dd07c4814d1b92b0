/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "progress_bar.h"

#include <cstdio>

#include <unistd.h>

namespace pcl_semantic::tool {

namespace {

bool bar_is_drawn = false; // there is one at a time

} // namespace

ProgressBar::ProgressBar(std::string what, std::size_t total, std::string unit)
    : what_(std::move(what)), total_(total), unit_(std::move(unit)),
      terminal_(isatty(STDERR_FILENO) == 1)
{}

ProgressBar::~ProgressBar()
{
  if (bar_is_drawn)
    std::fprintf(stderr, "\n");
  bar_is_drawn = false;
}

void
ProgressBar::step()
{
  ++done_;
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
  bar_is_drawn = true;
}

void
warn(const std::string& name, const std::string& message)
{
  if (bar_is_drawn)
    std::fputs("\r\033[K", stderr); // the bar comes back with its next step
  std::fprintf(stderr, "%s: warning: %s\n", name.c_str(), message.c_str());
}

} // namespace pcl_semantic::tool
