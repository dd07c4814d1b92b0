// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>

namespace pcl_semantic::python {

/** \brief refine(), cliques(). */
void bindClouds(pybind11::module_& module);

/** \brief SemanticVoxelMap, SemanticMapper, load_map(). */
void bindMaps(pybind11::module_& module);

/** \brief confusion_matrix(), scores(). */
void bindEvaluation(pybind11::module_& module);

/** \brief read_cloud(), write_cloud(). */
void bindFiles(pybind11::module_& module);

} // namespace pcl_semantic::python
