// SPDX-License-Identifier: BSD-3-Clause
#include "sequence_options.h"
#include "messages.h"

#include "core/fail.h"
#include "images/brightness.h"

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

void
DarkWatch::look(const cv::Mat& image, const std::string& name)
{
  // Medians of KITTI's images are 33 to 81, of a kitchen's 85 to 146.
  constexpr int dark = 15;
  if (has_warned_ || image.empty())
    return;
  const int median = medianGrey(image);
  if (median >= dark)
    return;
  warn(name + ": is dark (median grey level " + std::to_string(median) +
       ", usual are 30 to 150): networks label such images badly, and stereo finds "
       "little");
  has_warned_ = true;
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
  dark_.look(frame.left, name);
  if (row_checks_ > 0)
    judgeRows(frame, name);
  const PairReport report = checkPair(frame.left, frame.right);
  if (report.fault == PairFault::none)
    return;
  if (strict_)
    throw BadInputException(name + ": " + report.reason);
  if (++warned_[report.fault] == 1)
    warn(name + ": " + report.reason);
}

void
PairWatch::judgeRows(const StereoFrame& frame, const std::string& name)
{
  const RowCheck rows = checkRows(frame.left, frame.right);
  row_checks_ = rows.isSure() ? 0 : row_checks_ - 1;
  if (!rows.isDoubtful())
    return;
  const std::string text =
      name + ": a tenth of " + std::to_string(rows.matches) +
      " corners differ by more than " + shown(rows.most) +
      " rows between left and right: are the calibration and its lens model those of "
      "these cameras?";
  if (strict_)
    throw BadInputException(text);
  warn(text);
}

} // namespace pcl_semantic::tool
