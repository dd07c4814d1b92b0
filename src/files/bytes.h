// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/fail.h"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

namespace pcl_semantic {

using Bytes = std::vector<std::uint8_t>;

/** \brief The unsigned integer with the same bits. */
template <typename T>
auto
bitsOf(T value)
{
  using Bits = std::conditional_t<
      sizeof(T) == 1, std::uint8_t,
      std::conditional_t<
          sizeof(T) == 2, std::uint16_t,
          std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>>>;
  static_assert(sizeof(Bits) == sizeof(T) && std::is_arithmetic_v<T>);
  Bits bits;
  std::memcpy(&bits, &value, sizeof(bits));
  return bits;
}

/** \brief An unsigned integer of up to eight bytes in a given byte order. */
inline std::uint64_t
wholeNumber(const std::uint8_t* bytes, std::size_t size, bool is_big_endian = true)
{
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < size; ++i)
    value = value << 8 | bytes[is_big_endian ? i : size - 1 - i];
  return value;
}

/** \brief Writes numbers and texts consecutively, little-endian on any machine. */
class ByteWriter {
public:
  /** \param[in] expected bytes, to allocate once */
  explicit ByteWriter(std::size_t expected = 0) { bytes_.reserve(expected); }

  template <typename T>
  void
  put(T value)
  {
    const auto bits = bitsOf(value);
    for (std::size_t b = 0; b < sizeof(T); ++b)
      bytes_.push_back(static_cast<std::uint8_t>(bits >> (8 * b)));
  }

  /** \brief Writes the number of bytes as 32 bits, then the bytes. */
  void
  putText(const std::string& text)
  {
    put(static_cast<std::uint32_t>(text.size()));
    bytes_.insert(bytes_.end(), text.begin(), text.end());
  }

  void
  putBytes(const Bytes& bytes)
  {
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  }

  /** \brief Writes numbers of one type consecutively. */
  template <typename T>
  void
  putColumn(const std::vector<T>& values)
  {
    const std::size_t begin = bytes_.size();
    bytes_.resize(begin + values.size() * sizeof(T));
    std::uint8_t* to = bytes_.data() + begin;
    for (const T value : values) {
      const auto bits = bitsOf(value);
      for (std::size_t b = 0; b < sizeof(T); ++b)
        *to++ = static_cast<std::uint8_t>(bits >> (8 * b));
    }
  }

  const Bytes&
  bytes() const
  {
    return bytes_;
  }

private:
  Bytes bytes_;
};

/** \brief Reads the output of ByteWriter. Every method throws BadInputException if
 * there are too few bytes. */
class ByteReader {
public:
  explicit ByteReader(const Bytes& bytes)
      : next_(bytes.data()), end_(bytes.data() + bytes.size())
  {}

  template <typename T>
  T
  get()
  {
    require(sizeof(T));
    decltype(bitsOf(T())) bits = 0;
    for (std::size_t b = 0; b < sizeof(T); ++b)
      bits = static_cast<decltype(bits)>(bits | decltype(bits)(*next_++) << (8 * b));
    T value;
    std::memcpy(&value, &bits, sizeof(value));
    return value;
  }

  std::string
  getText()
  {
    const auto size = get<std::uint32_t>();
    require(size);
    std::string text(next_, next_ + size);
    next_ += size;
    return text;
  }

  template <typename T>
  std::vector<T>
  getColumn(std::size_t count)
  {
    require(count * sizeof(T));
    std::vector<T> values(count);
    for (T& value : values)
      value = get<T>();
    return values;
  }

  /** \brief All remaining bytes. */
  Bytes
  getRest()
  {
    Bytes rest(next_, end_);
    next_ = end_;
    return rest;
  }

  std::size_t
  left() const
  {
    return static_cast<std::size_t>(end_ - next_);
  }

private:
  void
  require(std::size_t count) const
  {
    if (count > left())
      badInput("ends too early");
  }

  const std::uint8_t* next_;
  const std::uint8_t* end_;
};

} // namespace pcl_semantic
