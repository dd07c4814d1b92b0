// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace pcl_semantic {

/** \brief An entry for external bytes: a reader of a file, or of a part of one. */
struct Door {
  std::string name; ///< also of the folder of its corpus
  void (*read)(const std::string& bytes);
};

/** \brief All doors, by name. */
const std::vector<Door>& doors();

/** \brief Sends bytes through a door. BadInputException or BadModelException with a
 * message may refuse them; other exceptions and reports of sanitizers are faults. */
void tryDoor(const Door& door, const std::string& bytes);

} // namespace pcl_semantic
