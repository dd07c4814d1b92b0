// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace pcl_semantic::tool {

/** \brief The moment of the labels in a folder of a map. */
struct LabelKind {
  std::string_view name; ///< causal, final or network; empty = unknown
  std::string_view description;
};

/** \brief The kind of labels in folders, by their names in a map folder. Labels at each
 * frame are causal, those of the finished map are final. Warns if the folders differ.
 * \return without a name if a folder is not of a map, or the folders differ */
LabelKind kindOf(const std::vector<std::string>& folders);

/** \brief Puts a line with the kind, if it has a name, before a table. */
std::string withKind(const LabelKind& kind, const std::string& table);

/** \brief Puts the kind, if it has a name, first into a JSON object. */
std::string jsonWithKind(const LabelKind& kind, const std::string& json);

} // namespace pcl_semantic::tool
