// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "viewed_map.h"

#include <cstdio>
#include <optional>
#include <string>

/** \brief Maps on their way from a program that makes them to one that shows them. */
namespace pcl_semantic::tool {

/** \brief A map as bytes: a line of JSON, which says what the arrays behind it are.
 * Numbers are those of the machine: they go no further than to a program beside. */
std::string bytesOf(const ViewedMap& map);

/** \brief Reads the next one; none at the end of the stream.
 * \throws BadInputException if it is cut short or something else */
std::optional<ViewedMap> readViewedMap(std::FILE* stream);

} // namespace pcl_semantic::tool
