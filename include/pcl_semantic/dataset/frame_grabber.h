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

/** \brief Provides the newest frame of a camera. A thread grabs all and keeps only the
 * newest one; older frames are dropped without decoding. */
class FrameGrabber {
public:
  using Clock = std::chrono::steady_clock;

  struct Grabbed {
    SensorFrame frame;
    Clock::time_point when; ///< time of arrival
  };

  explicit FrameGrabber(std::unique_ptr<LiveCamera> camera);

  /** \brief Ends the thread. */
  ~FrameGrabber();

  FrameGrabber(const FrameGrabber&) = delete;
  FrameGrabber& operator=(const FrameGrabber&) = delete;

  /** \brief Returns the newest pair that was not taken yet; waits for one.
   * \param[in] patience maximum time to wait
   * \return none after this time
   * \throws BadInputException if the pair is damaged (the next call continues), or an
   * exception of the camera */
  std::optional<Grabbed> take(std::chrono::milliseconds patience);

  /** \brief Whether the camera has ended and the last pair was taken. */
  bool hasEnded() const;

  /** \brief Number of pairs dropped so far. */
  int dropped() const;

  /** \brief The camera. Its calibration is constant. */
  const LiveCamera&
  camera() const
  {
    return *camera_;
  }

private:
  void grabAll();

  void serve(std::unique_lock<std::mutex>& lock);

  std::unique_ptr<LiveCamera> camera_; // only the thread uses its pairs
  mutable std::mutex mutex_;           // protects the members below
  std::condition_variable changed_;
  bool is_wanted_ = false; // a caller waits for a pair
  int waiting_ = 0;        // new pairs since the last taken one
  int dropped_ = 0;
  Clock::time_point when_;         // arrival of the newest pair
  std::optional<Grabbed> grabbed_; // the newest pair
  std::exception_ptr error_;       // the camera's last error
  bool has_ended_ = false, stop_ = false;
  std::thread thread_; // last, because it uses the other members
};

} // namespace pcl_semantic
