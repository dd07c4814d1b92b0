// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/stereo_camera.h>
#include <pcl_semantic/images/sensor_frame.h>

#include <Eigen/Geometry>

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief A recorded sequence of stereo frames. */
class FrameSequence {
public:
  virtual ~FrameSequence() = default;

  /** \brief Number of existing frames. */
  virtual std::size_t size() const = 0;

  /** \brief Number of the i-th frame in the whole sequence, i by default; may have
   * gaps. */
  virtual int
  frameNumber(std::size_t i) const
  {
    return static_cast<int>(i);
  }

  /** \brief Time of the i-th frame [s], without reading its images. */
  virtual double timestamp(std::size_t i) const = 0;

  /** \brief Reads the images of the i-th frame.
   * \throws BadInputException if an image is missing, damaged or of another size */
  virtual StereoFrame frame(std::size_t i) const = 0;

  /** \brief The stereo pair, with the size of the images. */
  virtual const StereoCamera& camera() const = 0;

  /** \brief Pose of the pair's left camera in camera 0, the reference of trajectory
   * files [m]. */
  virtual const Eigen::Isometry3d&
  T_camera0_camera() const
  {
    static const Eigen::Isometry3d identity = Eigen::Isometry3d::Identity();
    return identity;
  }

  /** \brief Path of the sequence's trajectory; empty if none exists. */
  virtual std::string
  posesPath() const
  {
    return {};
  }
};

/** \brief Frames numbered first <= n < end. */
struct FrameRange {
  int first = 0;
  int end = std::numeric_limits<int>::max();

  bool
  contains(int frame) const
  {
    return frame >= first && frame < end;
  }
};

/** \brief Parses "A:B", the frames A <= n < B; A and B are optional.
 * \throws InvalidParameterException if the text is invalid or the range empty */
FrameRange parseFrameRange(const std::string& text);

/** \brief Positions in a sequence of the frames in a range.
 * \param[in] sequence FrameSequence, CloudSequence or RgbdSequence */
template <typename Sequence>
std::vector<std::size_t>
selectFrames(const Sequence& sequence, const FrameRange& range)
{
  std::vector<std::size_t> frames;
  for (std::size_t i = 0; i < sequence.size(); ++i)
    if (range.contains(sequence.frameNumber(i)))
      frames.push_back(i);
  return frames;
}

/** \brief Numbers and times of the frames at some positions in a sequence. */
template <typename Sequence>
std::vector<FrameTime>
frameTimes(const Sequence& sequence, const std::vector<std::size_t>& positions)
{
  std::vector<FrameTime> frames;
  for (const std::size_t i : positions)
    frames.push_back({sequence.frameNumber(i), sequence.timestamp(i)});
  return frames;
}

} // namespace pcl_semantic
