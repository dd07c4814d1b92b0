// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/dataset/live_camera.h>

#include <chrono>
#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Gives the newest pair of a camera: grabs all that come in a thread of its own
 * and keeps none but the last. Those between two that are taken are dropped, and never
 * decoded. */
class StereoGrabber {
public:
  using Clock = std::chrono::steady_clock;

  struct Grabbed {
    StereoFrame frame;
    Clock::time_point when; ///< it came
  };

  explicit StereoGrabber(std::unique_ptr<LiveCamera> camera);

  /** \brief Ends the thread. */
  ~StereoGrabber();

  StereoGrabber(const StereoGrabber&) = delete;
  StereoGrabber& operator=(const StereoGrabber&) = delete;

  /** \brief The newest pair that was not taken yet; waits for one.
   * \param[in] patience how long
   * \return none if none came
   * \throws BadInputException if it is damaged (the next call goes on), or what the
   * camera threw */
  std::optional<Grabbed> take(std::chrono::milliseconds patience);

  /** \brief Whether the camera has ended and the last pair was taken. */
  bool hasEnded() const;

  /** \brief Pairs so far that came and were not taken, but for the newest. */
  int dropped() const;

  /** \brief The camera: its calibration never changes. */
  const LiveCamera&
  camera() const
  {
    return *camera_;
  }

private:
  void grabAll();

  void serve(std::unique_lock<std::mutex>& lock);

  std::unique_ptr<LiveCamera> camera_; // its pairs are for the thread alone
  mutable std::mutex mutex_;           // of what follows
  std::condition_variable changed_;
  bool is_wanted_ = false; // a caller waits for a pair
  int waiting_ = 0;        // pairs that came since one was taken
  int dropped_ = 0;
  Clock::time_point when_;         // the last came
  std::optional<Grabbed> grabbed_; // the newest pair
  std::exception_ptr error_;       // likewise
  bool has_ended_ = false, stop_ = false;
  std::thread thread_; // last: it uses the others
};

} // namespace pcl_semantic
