/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#pragma once

#include <pcl_semantic/core/abi_check.h>

#include <Eigen/Core>

#include <memory>
#include <new>

namespace pcl_semantic {

/** \brief A matrix of floats whose columns start at multiples of 64 bytes (of 32, if
 * there are up to 8 rows) and are filled up with padding: what SIMD loops like. */
class PaddedColumns {
public:
  using View = Eigen::Map<Eigen::MatrixXf>;
  using ConstView = Eigen::Map<const Eigen::MatrixXf>;

  PaddedColumns() = default;

  /** \brief Zeros, and \a padding in the rows that only fill up. */
  PaddedColumns(Eigen::Index rows, Eigen::Index columns, float padding = 0.0f)
      : rows_(rows), stride_(rows <= 8 ? 8 : (rows + 15) / 16 * 16), columns_(columns),
        values_(static_cast<float*>(::operator new(
            std::size_t(stride_* columns) * sizeof(float), std::align_val_t(64))))
  {
#pragma omp parallel for schedule(static)
    for (Eigen::Index i = 0; i < columns; ++i)
      for (Eigen::Index l = 0; l < stride_; ++l)
        column(i)[l] = l < rows ? 0.0f : padding;
  }

  Eigen::Index
  rows() const
  {
    return rows_;
  }

  /** \brief Rows with padding: floats from one column to the next. */
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
    return values_.get() + i * stride_;
  }

  const float*
  column(Eigen::Index i) const
  {
    return values_.get() + i * stride_;
  }

  /** \brief With padding. */
  View
  view()
  {
    return {values_.get(), stride_, columns_};
  }

  ConstView
  view() const
  {
    return {values_.get(), stride_, columns_};
  }

  void
  setZero()
  {
    std::fill_n(values_.get(), stride_ * columns_, 0.0f);
  }

  /** \brief A copy without padding. */
  Eigen::MatrixXf
  matrix() const
  {
    Eigen::MatrixXf result(rows_, columns_);
#pragma omp parallel for schedule(static)
    for (Eigen::Index i = 0; i < columns_; ++i)
      std::copy_n(column(i), rows_, result.col(i).data());
    return result;
  }

private:
  struct Delete {
    void
    operator()(float* values) const
    {
      ::operator delete(values, std::align_val_t(64));
    }
  };

  Eigen::Index rows_ = 0;
  Eigen::Index stride_ = 0;
  Eigen::Index columns_ = 0;
  std::unique_ptr<float[], Delete> values_;
};

} // namespace pcl_semantic
