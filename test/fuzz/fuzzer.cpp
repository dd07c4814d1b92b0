// SPDX-License-Identifier: BSD-3-Clause
//
// libFuzzer's entry; see ./dev fuzz. The environment's DOOR says which reader is meant,
// as libFuzzer passes its arguments on to processes of its own.
#include "doors.h"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <iostream>

using namespace pcl_semantic;

namespace {

const Door&
chosenDoor()
{
  const char* const name = std::getenv("DOOR");
  const auto found =
      std::find_if(doors().begin(), doors().end(),
                   [&](const Door& door) { return name && door.name == name; });
  if (found != doors().end())
    return *found;
  for (const Door& door : doors())
    std::cout << door.name << std::endl;
  std::_Exit(name ? 2 : 0);
}

} // namespace

extern "C" int
LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
  static const Door& door = chosenDoor();
  tryDoor(door, std::string(data, data + size));
  return 0;
}
