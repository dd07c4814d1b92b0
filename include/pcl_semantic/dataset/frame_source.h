// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/stereo_camera.h>
#include <pcl_semantic/dataset/frame_sequence.h>
#include <pcl_semantic/images/sensor_frame.h>

#include <Eigen/Geometry>

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief The sensor of a source. */
struct FrameSensor {
  std::optional<StereoCamera> camera; ///< none: a scanner
  /// Pose in camera 0, the reference of trajectory files [m].
  Eigen::Isometry3d T_camera0_sensor = Eigen::Isometry3d::Identity();
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

  /** \brief Reads the next frame; none at the end.
   * \throws BadInputException that names the file */
  virtual std::optional<SensorFrame> next() = 0;

  /** \brief Continues with the i-th of frames(); no effect on live frames. */
  virtual void
  seek(std::size_t /*i*/)
  {}

protected:
  FrameSensor sensor_;
  std::vector<FrameTime> frames_;
};

/** \brief Recorded frames, read by a function. */
class RecordedFrames : public FrameSource {
public:
  using Reader = std::function<SensorFrame(std::size_t)>;

  /** \param[in] read reads the i-th of \a frames */
  RecordedFrames(FrameSensor sensor, std::vector<FrameTime> frames, Reader read)
      : read_(std::move(read))
  {
    sensor_ = std::move(sensor);
    frames_ = std::move(frames);
  }

  /** \brief The frames of a stereo sequence in a range. */
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
  Reader read_;
  std::size_t next_ = 0;
};

} // namespace pcl_semantic
