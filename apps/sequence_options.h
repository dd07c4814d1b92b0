// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tool.h"

#include <pcl_semantic/dataset/image_pair_sequence.h>
#include <pcl_semantic/io/cloud_sequence.h>

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

  /** \brief Whether any option about files was given. */
  bool hasFiles() const;

  /** \brief For messages: the folder, or the pattern of the left images. */
  const std::string& name() const;
};

/** \brief Adds --sequence, --left, --right, --calibration, --extrinsics, --times and
 * --strict. */
void addSequenceOptions(SequenceOptions& options, po::options_description& description);

/** \brief What a sequence cannot do without, or together.
 * \throws InvalidParameterException that points to the help of \a program */
void requireSequence(const SequenceOptions& options, const std::string& program);

/** \brief Opens it. \throws BadInputException */
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

/** \brief The files of numbers that a tool must not write over. */
std::vector<std::string> textFilesOf(const SequenceOptions& options,
                                     const FrameSequence& sequence);

/** \brief Names and values of what was given: ("sequence", "kitti/05"). */
std::vector<std::pair<std::string, std::string>>
inputsOf(const SequenceOptions& options);

} // namespace pcl_semantic::tool
