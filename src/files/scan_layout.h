// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcl_semantic {

/** \brief How well the float32 numbers of a scan without header fit a number of
 * columns.
 *
 * Values of one column are more alike than those of different columns. Of independent
 * points this is a theorem (the energy distance is not negative), and neighbours in a
 * scan are nearer still: the mean difference between a number and the one `columns`
 * further on is least for the right number of columns. */
class ScanLayout {
public:
  /** \param[in] bytes of the whole file, which have to stay */
  explicit ScanLayout(const std::vector<std::uint8_t>& bytes);

  /** \brief Another number of columns, of 3 to 7 or twice as many, that the size of the
   * file allows and its numbers show; 0 if they show none clearly. \param[in] assumed
   * columns, of which the numbers have to speak clearly against others */
  std::size_t columnsInsteadOf(std::size_t assumed) const;

  /** \brief Whether many positions in the first three columns cannot be metres: they
   * are no float32 numbers. */
  bool isAbsurd(std::size_t columns) const;

  /** \brief Whether the file is text. */
  bool isText() const;

  /** \brief Whether many numbers of a column are negative, which an intensity is not.
   */
  bool isSigned(std::size_t columns, std::size_t column) const;

private:
  double difference(std::size_t lag) const;

  bool isTwice(std::size_t assumed) const;

  const std::vector<std::uint8_t>& bytes_;
  std::size_t count_;                     // of numbers
  std::vector<std::vector<float>> parts_; // all over the file, compressed
};

} // namespace pcl_semantic
