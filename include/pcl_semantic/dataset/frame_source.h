// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/stereo_camera.h>
#include <pcl_semantic/dataset/frame_sequence.h>
#include <pcl_semantic/dataset/rgbd_sequence.h>
#include <pcl_semantic/images/sensor_frame.h>

#include <Eigen/Geometry>

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief The sensor of a source: a camera or a scanner. */
struct FrameSensor {
  std::optional<StereoCamera> camera; ///< none for a scanner
  /// Pose of the sensor in the frame of camera 0 [m]. Trajectory files contain the
  /// poses of camera 0.
  Eigen::Isometry3d T_camera0_sensor = Eigen::Isometry3d::Identity();
  bool has_depth = false; ///< frames have a depth image (RGB-D)
};

/** \brief Frames of one sensor, in the order of their times. */
class FrameSource {
public:
  virtual ~FrameSource() = default;

  const FrameSensor&
  sensor() const
  {
    return sensor_;
  }

  /** \brief Numbers and times of all frames; empty for a live source. */
  const std::vector<FrameTime>&
  frames() const
  {
    return frames_;
  }

  /** \brief Reads the next frame.
   * \return nothing after the last frame
   * \throws BadInputException that names the file, if it cannot be read or is invalid
   */
  virtual std::optional<SensorFrame> next() = 0;

  /** \brief Sets the frame that next() reads: the i-th of frames(). A live source
   * ignores it. */
  virtual void
  seek(std::size_t /*i*/)
  {}

protected:
  FrameSensor sensor_;
  std::vector<FrameTime> frames_;
};

/** \brief A source of recorded frames. */
class RecordedFrames : public FrameSource {
public:
  using Reader = std::function<SensorFrame(std::size_t)>;

  /** \param[in] frames numbers and times of all frames
   * \param[in] read reads the i-th of \a frames */
  RecordedFrames(FrameSensor sensor, std::vector<FrameTime> frames, Reader read)
      : read_(std::move(read))
  {
    sensor_ = std::move(sensor);
    frames_ = std::move(frames);
  }

  /** \brief Selects a range of frames from an RGB-D sequence. */
  RecordedFrames(std::shared_ptr<const RgbdSequence> sequence, const FrameRange& range);

  /** \brief Selects a range of frames from a stereo sequence. */
  RecordedFrames(std::shared_ptr<const FrameSequence> sequence,
                 const FrameRange& range);

  std::optional<SensorFrame>
  next() override
  {
    if (next_ >= frames_.size())
      return std::nullopt;
    return read_(next_++);
  }

  void
  seek(std::size_t i) override
  {
    next_ = i;
  }

private:
  template <typename Sequence>
  void select(std::shared_ptr<const Sequence> sequence, const FrameRange& range);

  Reader read_;
  std::size_t next_ = 0;
};

} // namespace pcl_semantic
