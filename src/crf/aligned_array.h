// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>
#include <type_traits>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace pcl_semantic {

/** \brief A fixed number of trivial values, aligned to 64 bytes and uninitialised. The
 * threads that fill the array also allocate its pages; a std::vector would do this in
 * one thread. */
template <typename T> class AlignedArray {
  static_assert(std::is_trivial_v<T>);

public:
  AlignedArray() = default;

  explicit AlignedArray(std::size_t size) : size_(size)
  {
    // Huge pages, if available, because large arrays are read in random order.
    constexpr std::size_t line = 64, huge_page = std::size_t(1) << 21;
    const std::size_t bytes = size * sizeof(T);
    const std::size_t unit = bytes >= 2 * huge_page ? huge_page : line;
    if (bytes > std::size_t(-1) / 2)
      throw std::bad_alloc();
    if (bytes > 0) {
      values_.reset(
          static_cast<T*>(std::aligned_alloc(unit, (bytes + unit - 1) / unit * unit)));
      if (!values_)
        throw std::bad_alloc();
    }
#ifdef __linux__
    if (unit == huge_page)
      madvise(values_.get(), bytes, MADV_HUGEPAGE);
#endif
  }

  std::size_t
  size() const
  {
    return size_;
  }

  T*
  data()
  {
    return values_.get();
  }

  const T*
  data() const
  {
    return values_.get();
  }

  T&
  operator[](std::size_t i)
  {
    return values_.get()[i];
  }

  const T&
  operator[](std::size_t i) const
  {
    return values_.get()[i];
  }

private:
  struct Free {
    void
    operator()(T* values) const
    {
      std::free(values);
    }
  };

  std::size_t size_ = 0;
  std::unique_ptr<T, Free> values_;
};

} // namespace pcl_semantic
