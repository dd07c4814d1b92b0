// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/sensor_frame.h>
#include <pcl_semantic/core/stereo_camera.h>
#include <pcl_semantic/stereo/pair_check.h>

#include <map>
#include <string>

namespace pcl_semantic::tool {

/** \brief Looks at the pairs of a run: warns of what is wrong with them, once a fault,
 * and at the end how often; or refuses them. */
class PairWatch {
public:
  /** \param[in] strict refuse instead of warning
   * \param[in] camera of the images: its principal point has to be near their middle
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
  PairCheck check_;
  std::map<PairFault, int> warned_; ///< pairs with a fault
};

} // namespace pcl_semantic::tool
