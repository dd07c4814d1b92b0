// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

namespace pcl_semantic {

/** \brief FNV-1a over all bytes that were added: tells what was changed by mistake, not
 * what was forged. */
class Digest {
public:
  void
  add(const void* bytes, std::size_t size)
  {
    const auto* const begin = static_cast<const std::uint8_t*>(bytes);
    for (std::size_t i = 0; i < size; ++i)
      value_ = (value_ ^ begin[i]) * 0x100000001B3ull;
  }

  std::uint64_t
  value() const
  {
    return value_;
  }

private:
  std::uint64_t value_ = 0xCBF29CE484222325ull;
};

} // namespace pcl_semantic
