// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/fail.h"
#include "tool.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/stereo_camera.h>
#include <pcl_semantic/dataset/sequence_files.h>
#include <pcl_semantic/images/sensor_frame.h>
#include <pcl_semantic/stereo/pair_check.h>
#include <pcl_semantic/stereo/row_check.h>

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace pcl_semantic::tool {

/** \brief The options of a sequence, followed by \a more. */
std::vector<Option> withSequence(SequenceFiles& files, const std::vector<Option>& more);

/** \brief Opens a sequence and prints its warnings. \throws BadInputException */
std::unique_ptr<FrameSequence> openSequenceOf(const SequenceFiles& files);

/** \brief Positions of the frames in the range A:B.
 * \param[in] name of the sequence, for the message
 * \throws BadInputException if there are none */
template <typename Sequence>
std::vector<std::size_t>
chooseFrames(const std::string& name, const Sequence& sequence,
             const std::string& range)
{
  std::vector<std::size_t> frames = selectFrames(sequence, parseFrameRange(range));
  if (frames.empty())
    fail<BadInputException>(name, ": has no frame in ", range);
  return frames;
}

/** \brief Warns of the first dark image of a run. */
class DarkWatch {
public:
  /** \param[in] image CV_8UC3 (BGR) or CV_8UC1
   * \param[in] name of the image: "frame 12" */
  void look(const cv::Mat& image, const std::string& name);

private:
  bool has_warned_ = false;
};

/** \brief Checks the pairs of a run. Warns of each kind of fault once and prints the
 * number of its pairs at the end, or refuses the first suspicious pair. */
class PairWatch {
public:
  /** \param[in] strict refuse instead of warning */
  explicit PairWatch(bool strict) : strict_(strict) {}

  /** \param[in] camera of the images; its principal point should be near their centre
   * \throws BadInputException if \a strict and it is elsewhere */
  PairWatch(bool strict, const StereoCamera& camera);

  ~PairWatch();
  PairWatch(const PairWatch&) = delete;
  PairWatch& operator=(const PairWatch&) = delete;

  /** \param[in] name of the pair: "frame 12"
   * \throws BadInputException if strict and the pair is suspicious */
  void look(const StereoFrame& frame, const std::string& name);

  /** \brief Names the pair by its frame number. */
  void
  look(const StereoFrame& frame)
  {
    look(frame, "frame " + std::to_string(frame.number));
  }

private:
  void judgeRows(const StereoFrame& frame, const std::string& name);

  bool strict_;
  std::map<PairFault, int> warned_; ///< number of pairs by fault
  DarkWatch dark_;
  int row_checks_ = 3; ///< left; none after a pair with enough corners
};

} // namespace pcl_semantic::tool
