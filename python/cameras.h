// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "arrays.h"

#include <string>
#include <vector>

namespace pcl_semantic::python {

/** \brief Reports the library's doubts by warnings.warn(). */
void warnOf(const std::vector<std::string>& doubts);

/** \brief Binds read_camera(). */
void bindCameras(py::module_& module);

} // namespace pcl_semantic::python
