// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tool.h"

#include <pcl_semantic/core/stereo_camera.h>
#include <pcl_semantic/dataset/cloud_sequence.h>
#include <pcl_semantic/dataset/image_pair_sequence.h>
#include <pcl_semantic/images/sensor_frame.h>
#include <pcl_semantic/stereo/pair_check.h>

#include <Eigen/Geometry>

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace pcl_semantic::tool {

/** \brief Where the images of a run come from: a folder in KITTI's layout, or the files
 * of any stereo camera. */
struct SequenceOptions {
  std::string folder; ///< the positional SEQUENCE
  ImagePairFiles files;
  bool strict = false; ///< refuse pairs that look wrong, see PairWatch
  /// Opens two videos; null in the programs that refuse them.
  std::function<std::unique_ptr<FrameSequence>(const ImagePairFiles&)> open_videos;

  /** \brief Whether any option about files was given. */
  bool hasFiles() const;

  /** \brief For messages: the folder, or the pattern of the left images. */
  const std::string& name() const;
};

/** \brief The options --sequence, --left, --right, --calibration, --extrinsics, --times
 * and --strict, and after them \a more. */
std::vector<Option> withSequence(SequenceOptions& options,
                                 const std::vector<Option>& more);

/** \brief Checks for missing and contradicting options of a sequence.
 * \throws InvalidParameterException */
void requireSequence(const SequenceOptions& options);

/** \brief Opens it, with warnings. \throws BadInputException */
std::unique_ptr<FrameSequence> openSequence(const SequenceOptions& options);

/** \brief Indices of the frames that are in the range A:B.
 * \throws BadInputException if there are none */
std::vector<std::size_t> chooseFrames(const SequenceOptions& options,
                                      const FrameSequence& sequence,
                                      const std::string& range);

/** \brief The same of clouds. \param[in] name of them, for messages */
std::vector<std::size_t> chooseClouds(const std::string& name,
                                      const CloudSequence& clouds,
                                      const std::string& range);

/** \brief The points of a scan alone, as many as it has [m]; NaN where there was no
 * return. \throws BadInputException as readLabelledCloud() */
std::vector<Eigen::Vector3d> readPositions(const std::string& path,
                                           const ScanColumns& columns = {});

/** \brief Where a scanner is in KITTI's camera 0, whose poses maps have: `own`, with
 * poses of its own in a world with z up, looks along x; `laser` is where the row `Tr`
 * of a calibration has it. \throws BadInputException if there is no such row */
Eigen::Isometry3d scannerPose(const std::string& sensor,
                              const std::string& calibration);

/** \brief The files of numbers that a tool must not write over. */
std::vector<std::string> textFilesOf(const SequenceOptions& options,
                                     const FrameSequence& sequence);

/** \brief Names and values of what was given: ("sequence", "kitti/05"). */
std::vector<std::pair<std::string, std::string>>
inputsOf(const SequenceOptions& options);

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
  std::map<PairFault, int> warned_; ///< pairs with a fault
};

} // namespace pcl_semantic::tool
