// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/core/stereo_camera.h>

#include "fail.h"

#include <cmath>

namespace pcl_semantic {

void
StereoCamera::validate() const
{
  for (const double value : {fx, fy, cx, cy, baseline})
    if (!std::isfinite(value))
      badParameter("the camera has a parameter that is not a finite number");
  if (fx <= 0.0 || fy <= 0.0)
    badParameter("focal lengths are ", fx, " and ", fy, " px, expected more than 0");
  if (baseline <= 0.0)
    badParameter("baseline is ", baseline, " m, expected more than 0");
  // Hand-held cameras have at least 50 mm, vehicle rigs at most a few metres.
  if (baseline < 1e-3 || baseline > 10.0)
    badParameter("baseline is ", baseline,
                 " m, expected 0.001 to 10 m; is it in millimetres?");
}

} // namespace pcl_semantic
