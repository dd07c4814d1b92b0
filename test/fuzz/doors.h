// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace pcl_semantic {

/** \brief One way that bytes of somebody else come in: a reader of a file, or of a part
 * of one. */
struct Door {
  std::string name; ///< and of the folder of its corpus
  void (*read)(const std::string& bytes);
};

/** \brief All of them, by name. */
const std::vector<Door>& doors();

/** \brief Sends bytes through a door. They may be refused by BadInputException or
 * BadModelException with a message; whatever else is thrown is a fault, and so is what
 * the sanitizers see. */
void tryDoor(const Door& door, const std::string& bytes);

} // namespace pcl_semantic
