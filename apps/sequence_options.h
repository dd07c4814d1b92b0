// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tool.h"

#include <pcl_semantic/core/stereo_camera.h>
#include <pcl_semantic/dataset/sequence_files.h>
#include <pcl_semantic/images/sensor_frame.h>
#include <pcl_semantic/stereo/pair_check.h>

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace pcl_semantic::tool {

/** \brief The options of a sequence, and after them \a more. */
std::vector<Option> withSequence(SequenceFiles& files, const std::vector<Option>& more);

/** \brief Opens it, with warnings. \throws BadInputException */
std::unique_ptr<FrameSequence> openSequenceOf(const SequenceFiles& files);

/** \brief Indices of the frames that are in the range A:B.
 * \throws BadInputException if there are none */
std::vector<std::size_t> chooseFrames(const SequenceFiles& files,
                                      const FrameSequence& sequence,
                                      const std::string& range);

/** \brief Looks at the pairs of a run: warns of each fault once, and at the end how
 * many pairs had it; or refuses the first pair that looks wrong. */
class PairWatch {
public:
  /** \param[in] strict refuse instead of warning */
  explicit PairWatch(bool strict) : strict_(strict) {}

  /** \param[in] camera of the images: its principal point has to be near their middle
   * \throws BadInputException if it is strict and that is elsewhere */
  PairWatch(bool strict, const StereoCamera& camera);

  ~PairWatch();
  PairWatch(const PairWatch&) = delete;
  PairWatch& operator=(const PairWatch&) = delete;

  /** \param[in] name of the pair: "frame 12"
   * \throws BadInputException if it is strict and the pair looks wrong */
  void look(const StereoFrame& frame, const std::string& name);

  /** \brief Calls it by its number. */
  void
  look(const StereoFrame& frame)
  {
    look(frame, "frame " + std::to_string(frame.number));
  }

private:
  bool strict_;
  std::map<PairFault, int> warned_; ///< pairs with a fault
};

} // namespace pcl_semantic::tool
