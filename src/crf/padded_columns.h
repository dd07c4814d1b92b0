// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "aligned_array.h"

#include <pcl_semantic/core/abi_check.h>

#include <Eigen/Core>

#include <algorithm>

namespace pcl_semantic {

/** \brief A matrix of floats for SIMD loops: columns start at multiples of 64 bytes (of
 * 32 for up to 8 rows) and are padded. */
class PaddedColumns {
public:
  PaddedColumns() = default;

  /** \brief Leaves values uninitialised, so that memory is placed on the NUMA node of
   * the first thread to write it. */
  PaddedColumns(Eigen::Index rows, Eigen::Index columns)
      : rows_(rows), stride_(rows <= 8 ? 8 : (rows + 15) / 16 * 16), columns_(columns),
        values_(std::size_t(stride_ * columns))
  {}

  Eigen::Index
  rows() const
  {
    return rows_;
  }

  /** \brief Rows with padding: floats between columns. */
  Eigen::Index
  stride() const
  {
    return stride_;
  }

  Eigen::Index
  columns() const
  {
    return columns_;
  }

  float*
  column(Eigen::Index i)
  {
    return values_.data() + i * stride_;
  }

  const float*
  column(Eigen::Index i) const
  {
    return values_.data() + i * stride_;
  }

  /** \brief With padding. */
  Eigen::Map<Eigen::MatrixXf>
  view()
  {
    return {values_.data(), stride_, columns_};
  }

  Eigen::Map<const Eigen::MatrixXf>
  view() const
  {
    return {values_.data(), stride_, columns_};
  }

  /** \brief Copies a column and sets its padding. */
  void
  setColumn(Eigen::Index i, const float* values, float padding)
  {
    std::copy_n(values, rows_, column(i));
    std::fill(column(i) + rows_, column(i) + stride_, padding);
  }

  void
  setZero()
  {
#pragma omp parallel for schedule(static) if (columns_ > 1000)
    for (Eigen::Index i = 0; i < columns_; ++i)
      std::fill_n(column(i), stride_, 0.0f);
  }

  Eigen::MatrixXf
  matrix() const
  {
    Eigen::MatrixXf result(rows_, columns_);
#pragma omp parallel for schedule(static) if (columns_ > 1000)
    for (Eigen::Index i = 0; i < columns_; ++i)
      std::copy_n(column(i), rows_, result.data() + i * rows_);
    return result;
  }

private:
  Eigen::Index rows_ = 0;
  Eigen::Index stride_ = 0;
  Eigen::Index columns_ = 0;
  AlignedArray<float> values_;
};

} // namespace pcl_semantic
