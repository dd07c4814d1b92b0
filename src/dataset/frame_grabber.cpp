// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/dataset/frame_grabber.h>

#include <utility>

namespace pcl_semantic {

FrameGrabber::FrameGrabber(std::unique_ptr<LiveCamera> camera)
    : camera_(std::move(camera)), thread_([this] { grabAll(); })
{}

FrameGrabber::~FrameGrabber()
{
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

std::optional<FrameGrabber::Grabbed>
FrameGrabber::take(std::chrono::milliseconds patience)
{
  std::unique_lock<std::mutex> lock(mutex_);
  is_wanted_ = true;
  changed_.notify_all();
  changed_.wait_for(lock, patience, [&] {
    return grabbed_ || error_ || (has_ended_ && waiting_ == 0);
  });
  is_wanted_ = false; // pairs before the next call may be old by then
  if (error_)
    std::rethrow_exception(std::exchange(error_, nullptr));
  return std::exchange(grabbed_, std::nullopt);
}

bool
FrameGrabber::hasEnded() const
{
  const std::lock_guard<std::mutex> lock(mutex_);
  return has_ended_ && waiting_ == 0 && !grabbed_ && !error_;
}

int
FrameGrabber::dropped() const
{
  const std::lock_guard<std::mutex> lock(mutex_);
  return dropped_;
}

void
FrameGrabber::grabAll()
{
  std::unique_lock<std::mutex> lock(mutex_);
  while (!stop_ && !has_ended_) {
    lock.unlock();
    int came = 0;
    std::exception_ptr error;
    try {
      came = camera_->grab();
    }
    catch (...) {
      error = std::current_exception();
    }
    lock.lock();
    has_ended_ = error || camera_->hasEnded();
    if (came > 0) {
      waiting_ += came;
      when_ = Clock::now();
    }
    serve(lock);
    if (error)
      error_ = error;
  }
  // Keeps the last pair for the next caller, unless the camera failed.
  if (error_)
    waiting_ = 0;
  while (!stop_ && waiting_ > 0) {
    changed_.wait(lock, [&] { return stop_ || is_wanted_; });
    serve(lock);
  }
  changed_.notify_all();
}

// Decodes the newest pair if a caller waits.
void
FrameGrabber::serve(std::unique_lock<std::mutex>& lock)
{
  if (stop_ || !is_wanted_ || waiting_ == 0 || grabbed_)
    return;
  dropped_ += waiting_ - 1;
  waiting_ = 0;
  const Clock::time_point when = when_;
  lock.unlock();
  std::optional<Grabbed> grabbed;
  std::exception_ptr error;
  try {
    grabbed = Grabbed{camera_->retrieve(), when};
  }
  catch (...) {
    error = std::current_exception();
  }
  lock.lock();
  grabbed_ = std::move(grabbed);
  if (error)
    error_ = error;
  is_wanted_ = false;
  changed_.notify_all();
}

} // namespace pcl_semantic
