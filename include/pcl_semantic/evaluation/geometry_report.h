// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/evaluation/map_geometry.h>

#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief The geometry of maps as text, a figure a line. */
std::string geometryTable(const GeometrySamples& samples,
                          const GeometryParameters& parameters);

/** \brief The two header lines that belong to geometryMarkdownRow. */
std::string geometryMarkdownHeader(const GeometryParameters& parameters);

/** \brief One row of a Markdown table: name, distances [cm], shares of the judged
 * voxels and, by band, of the surface [%]. */
std::string geometryMarkdownRow(const GeometrySamples& samples,
                                const GeometryParameters& parameters,
                                const std::string& name);

/** \brief The same as JSON, metres and ratios 0..1; null where there is none. */
std::string geometryJson(const GeometrySamples& samples,
                         const GeometryParameters& parameters);

} // namespace pcl_semantic
