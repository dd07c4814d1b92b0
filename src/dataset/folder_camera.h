// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/fail.h"
#include "new_pairs.h"

#include <pcl_semantic/dataset/live_camera.h>

#include <chrono>
#include <string>
#include <thread>
#include <utility>

namespace pcl_semantic {

/** \brief A live camera whose images another program writes into two folders. */
class FolderCamera : public LiveCamera {
public:
  int
  grab() override
  {
    constexpr std::chrono::milliseconds pause(10);
    const int came = came_ > 0 ? std::exchange(came_, 0) : pairs_.next(grabbed_);
    if (came > 0)
      when_ = Clock::now();
    else
      std::this_thread::sleep_for(pause);
    return came;
  }

  bool
  hasEnded() const override
  {
    return false;
  }

protected:
  /** \throws BadInputException with the message \a lacking, if there is no pair yet */
  FolderCamera(NewPairs pairs, const std::string& lacking)
      : pairs_(std::move(pairs)), came_(pairs_.next(grabbed_))
  {
    if (came_ == 0)
      badInput(lacking);
  }

  /** \brief The newest pair. */
  const StereoPairFiles&
  grabbed() const
  {
    return grabbed_;
  }

  /** \brief Time of the newest pair since the opening of the camera [s]. */
  double
  time() const
  {
    return std::chrono::duration<double>(when_ - begin_).count();
  }

private:
  using Clock = std::chrono::steady_clock;

  NewPairs pairs_;
  StereoPairFiles grabbed_;
  int came_; // from the constructor
  Clock::time_point begin_ = Clock::now(), when_;
};

} // namespace pcl_semantic
