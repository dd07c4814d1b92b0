// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcl_semantic {

/** \brief Tests how well the float32 numbers of a scan without header fit a number of
 * columns.
 *
 * Values of the same column are more similar than values of different columns. For
 * independent points this is a theorem (the energy distance is not negative), and
 * neighbours in a scan are even more similar. Therefore the mean difference between a
 * number and the one `columns` further on is smallest for the right number of columns.
 */
class ScanLayout {
public:
  /** \param[in] bytes of the whole file, which must outlive this object */
  explicit ScanLayout(const std::vector<std::uint8_t>& bytes);

  /** \brief Another number of columns, 3 to 7 or twice \a assumed, that fits the size
   * and the numbers of the file clearly better; 0 if there is none.
   * \param[in] assumed expected number of columns */
  std::size_t columnsInsteadOf(std::size_t assumed) const;

  /** \brief Whether many positions in the first three columns are implausible as
   * metres: the numbers are no float32. */
  bool isAbsurd(std::size_t columns) const;

  bool isText() const;

  /** \brief Whether many numbers of a column are negative, so that it is no intensity.
   */
  bool isSigned(std::size_t columns, std::size_t column) const;

private:
  double difference(std::size_t lag) const;

  bool isTwice(std::size_t assumed) const;

  const std::vector<std::uint8_t>& bytes_;
  std::size_t count_;                     // of numbers
  std::vector<std::vector<float>> parts_; // samples from the whole file, compressed by
                                          // asinh
};

} // namespace pcl_semantic
