/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "calibration_term.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/labelling/calibration_fit.h>

namespace pcl_semantic {

void
CalibrationOptions::validate() const
{
  for (const auto& [name, value, most] :
       {std::tuple("balance", balance, 1.0),
        std::tuple("bias_penalty", bias_penalty, 1e6),
        std::tuple("curve_penalty", curve_penalty, 1e6)})
    if (!(value >= 0.0 && value <= most))
      PCL_THROW_EXCEPTION(InvalidParameterException,
                          name << " is " << value << ", expected 0 to " << most);
  for (const auto& [name, knots] :
       {std::pair("height", &height), std::pair("distance", &distance),
        std::pair("level", &level)})
    if (!areKnots(*knots))
      PCL_THROW_EXCEPTION(InvalidParameterException,
                          "knots of " << name
                                      << ": expected none, or two or more that rise");
  if (iterations < 1)
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "iterations is " << iterations << ", expected 1 or more");
}

} // namespace pcl_semantic
