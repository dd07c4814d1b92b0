// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "arrays.h"

#include <string>
#include <vector>

namespace pcl_semantic::python {

/** \brief Passes on what the library doubts, as warnings.warn() does. */
void warnOf(const std::vector<std::string>& doubts);

/** \brief read_camera(). */
void bindCameras(py::module_& module);

} // namespace pcl_semantic::python
