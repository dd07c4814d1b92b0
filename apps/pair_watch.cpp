// SPDX-License-Identifier: BSD-3-Clause
#include "pair_watch.h"
#include "messages.h"

#include <pcl_semantic/core/exceptions.h>

namespace pcl_semantic::tool {

PairWatch::PairWatch(std::string program, bool strict)
    : program_(std::move(program)), strict_(strict)
{}

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
  const PairFault fault = check_.add(frame.left, frame.right);
  if (fault == PairFault::none)
    return;
  if (strict_)
    PCL_THROW_EXCEPTION(BadInputException, name << ": " << check_.reason());
  if (++warned_[fault] == 1)
    warn(name + ": " + check_.reason());
}

} // namespace pcl_semantic::tool
