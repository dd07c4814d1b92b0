// SPDX-License-Identifier: BSD-3-Clause
#include "cloud_doubts.h"
#include "command_line.h"
#include "messages.h"

#include <boost/algorithm/string/predicate.hpp>

#include <exception>
#include <utility>

namespace pcl_semantic::tool {

const LabelMapping&
anyLabels()
{
  static const LabelMapping mapping;
  return mapping;
}

std::string
textOfDoubts(const std::vector<std::string>& doubts, const std::string& path)
{
  std::string text;
  for (const std::string& doubt : doubts)
    text += "; " +
            (doubt.rfind(path + ": ", 0) == 0 ? doubt.substr(path.size() + 2) : doubt);
  return text;
}

void
warnOfNoReturns(const std::string& path, std::size_t count)
{
  if (count > 0)
    warn(path + ": " + std::to_string(count) +
         " points at exactly 0 0 0 count as no return and are ignored");
}

void
refuseForProbabilities(const std::string& path, const std::vector<std::string>& options)
{
  for (const std::string& option : options)
    refuseIf(true, option + " has no effect on the field 'probability' of " + path);
}

MappingWatch::MappingWatch(std::string name, const PixelMapping& mapping,
                           std::string unit)
    : name_(std::move(name)), unit_(std::move(unit))
{
  if (const auto* const numbers = std::get_if<LabelMapping>(&mapping))
    mapping_ = *numbers;
}

MappingWatch::MappingWatch(MappingWatch&& other) noexcept
    : name_(std::move(other.name_)), unit_(std::move(other.unit_)),
      mapping_(std::exchange(other.mapping_, std::nullopt))
{}

MappingWatch&
MappingWatch::operator=(MappingWatch&& other) noexcept
{
  std::swap(name_, other.name_);
  std::swap(unit_, other.unit_);
  std::swap(mapping_, other.mapping_);
  return *this;
}

MappingWatch::~MappingWatch()
{
  if (!mapping_ || std::uncaught_exceptions() > 0)
    return;
  const std::string lacking = textOfLacking(*mapping_, name_, unit_);
  if (!lacking.empty())
    warn(lacking);
}

} // namespace pcl_semantic::tool
