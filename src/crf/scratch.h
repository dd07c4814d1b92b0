// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <new>

namespace pcl_semantic {

/** \brief Memory of a thread that its next task may use again, at a multiple of 64
 * bytes. */
class Scratch {
public:
  /** \brief At least so many floats; what they hold is not defined. */
  float*
  floats(std::size_t count)
  {
    if (count > size_) {
      floats_.reset(static_cast<float*>(
          ::operator new(count * sizeof(float), std::align_val_t(64))));
      size_ = count;
    }
    return floats_.get();
  }

private:
  struct Delete {
    void
    operator()(float* floats) const
    {
      ::operator delete(floats, std::align_val_t(64));
    }
  };

  std::unique_ptr<float[], Delete> floats_;
  std::size_t size_ = 0;
};

} // namespace pcl_semantic
