// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "messages.h"
#include "sequence_options.h"

#include <pcl_semantic/pipeline/map_run.h>

#include <cstddef>
#include <string>

namespace pcl_semantic::tool {

/** \brief Shows a map run on the terminal: its doubts, and those about its frames. */
class MapWatch : public MapRunObserver {
public:
  /** \param[in] poses where the run has them from, as MapInputs::poses
   * \param[in] strict pairs that look wrong are refused */
  MapWatch(std::string poses, bool strict) : poses_(std::move(poses)), pairs_(strict) {}

  bool isInterrupted() override;

  void onFrame(const SensorFrame& frame) override;

  /** \brief With --verbose the times of its stages. */
  void onMapped(const SensorFrame& frame, const MappedFrame& mapped) override;

  void onDoubt(const std::string& doubt) override;

  void onNote(const std::string& note) override;

  /** \brief Of RGB-D frames, pixels without a measurement. */
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
  std::size_t unmeasured_ = 0;
  bool told_of_doubts_ = false; // of the first cloud that had some
  bool told_of_labels_ = false; // a cloud had none
  bool told_of_viewpoint_ = false;
  int default_viewpoints_ = 0;
};

} // namespace pcl_semantic::tool
