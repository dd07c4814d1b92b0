// SPDX-License-Identifier: BSD-3-Clause
#include "sequence_options.h"
#include "messages.h"

#include "core/fail.h"

#include <pcl_semantic/core/camera_doubts.h>
#include <pcl_semantic/core/exceptions.h>

namespace pcl_semantic::tool {

std::vector<Option>
withSequence(SequenceFiles& files, const std::vector<Option>& more)
{
  std::vector<Option> all = optionsOf(parametersOf(files));
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

std::unique_ptr<FrameSequence>
openSequenceOf(const SequenceFiles& files)
{
  std::vector<std::string> doubts;
  auto sequence = openSequence(files, doubts);
  warnOf(doubts);
  return sequence;
}

PairWatch::PairWatch(bool strict, const StereoCamera& camera) : PairWatch(strict)
{
  warnOf(doubtsOf(camera, strict));
}

PairWatch::~PairWatch()
{
  for (const auto& [fault, pairs] : warned_)
    if (pairs > 1)
      warn(std::to_string(pairs) + " pairs looked " +
           (fault == PairFault::blank       ? "blank"
            : fault == PairFault::identical ? "identical"
            : fault == PairFault::swapped   ? "swapped"
                                            : "unrelated"));
}

void
PairWatch::look(const StereoFrame& frame, const std::string& name)
{
  const PairReport report = checkPair(frame.left, frame.right);
  if (report.fault == PairFault::none)
    return;
  if (strict_)
    throw BadInputException(name + ": " + report.reason);
  if (++warned_[report.fault] == 1)
    warn(name + ": " + report.reason);
}

} // namespace pcl_semantic::tool
