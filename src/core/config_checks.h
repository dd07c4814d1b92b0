// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fail.h"

#include <pcl_semantic/core/config_parameter.h>

#include <string>
#include <utility>

namespace pcl_semantic {

inline void
append(ConfigParameters& to, ConfigParameters from)
{
  for (ConfigParameter& parameter : from)
    to.push_back(std::move(parameter));
}

template <typename T>
void
require(bool is_valid, const char* name, T value, const char* expected)
{
  if (!is_valid)
    badParameter(name, " is ", value, ", expected ", expected);
}

inline void
requireConfidence(double value)
{
  require(value > 0.0 && value <= 1.0, "label_confidence", value,
          "more than 0, at most 1");
}

} // namespace pcl_semantic
