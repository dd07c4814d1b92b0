// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "byte_writer.h"

#include <pcl_semantic/core/exceptions.h>

namespace pcl_semantic {

/** \brief Reads what ByteWriter wrote; never beyond the end.
 * Every method throws BadInputException if there are too few bytes. */
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

  /** \brief Everything that is left. */
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
      PCL_THROW_EXCEPTION(BadInputException, "ends too early");
  }

  const std::uint8_t* next_;
  const std::uint8_t* end_;
};

} // namespace pcl_semantic
