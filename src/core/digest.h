// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

namespace pcl_semantic {

/** \brief FNV-1a over 64-bit words: detects accidental changes, not forgery. */
class Digest {
public:
  void
  add(const void* data, std::size_t size)
  {
    const auto* const bytes = static_cast<const std::uint8_t*>(data);
    std::size_t i = 0;
    for (; i + sizeof(std::uint64_t) <= size; i += sizeof(std::uint64_t)) {
      std::uint64_t word = 0;
      std::memcpy(&word, bytes + i, sizeof(word));
      addWord(word);
    }
    for (; i < size; ++i)
      addWord(bytes[i]);
    addWord(size);
  }

  void
  addWord(std::uint64_t word)
  {
    value_ = (value_ ^ word) * 0x100000001B3ull;
    value_ ^= value_ >> 32; // otherwise high bits would never reach the low ones
  }

  /** \brief Never 0, which is reserved for "unknown". */
  std::uint64_t
  value() const
  {
    return value_ == 0 ? 1 : value_;
  }

private:
  std::uint64_t value_ = 0xCBF29CE484222325ull;
};

} // namespace pcl_semantic
