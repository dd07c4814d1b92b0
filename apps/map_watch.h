// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "messages.h"
#include "sequence_options.h"

#include <pcl_semantic/pipeline/map_run.h>

#include <cstddef>
#include <string>

namespace pcl_semantic::tool {

/** \brief Prints a map run on the terminal: its doubts, and doubts about its frames. */
class MapWatch : public MapRunObserver {
public:
  /** \param[in] poses source of the poses, as MapInputs::poses
   * \param[in] strict refuse suspicious pairs */
  MapWatch(std::string poses, bool strict) : poses_(std::move(poses)), pairs_(strict) {}

  bool isInterrupted() override;

  void onFrame(const SensorFrame& frame) override;

  /** \brief Prints the times of the stages with --verbose. */
  void onMapped(const SensorFrame& frame, const MappedFrame& mapped) override;

  void onDoubt(const std::string& doubt) override;

  void onNote(const std::string& note) override;

  /** \brief Number of pixels without a measurement, for RGB-D frames. */
  std::size_t
  unmeasured() const
  {
    return unmeasured_;
  }

private:
  void look(const CloudFrame& frame);

  void lookAtViewpoint(const CloudFrame& frame, const Eigen::Isometry3d& used);

  std::string poses_;
  PairWatch pairs_;
  DarkWatch dark_; // of RGB-D images
  std::size_t unmeasured_ = 0;
  bool told_of_doubts_ = false; // of the first doubtful cloud
  bool told_of_labels_ = false; // a cloud had none
  bool told_of_viewpoint_ = false;
  int default_viewpoints_ = 0;
};

} // namespace pcl_semantic::tool
