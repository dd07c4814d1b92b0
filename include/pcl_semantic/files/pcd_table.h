// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief A field of a point in a `.pcd` file, in PCL's terms. */
struct PcdField {
  std::string name; ///< a word
  char type = 'F';  ///< F float, I signed, U unsigned, B bool
  int size = 4;     ///< bytes of an element: 1, 2, 4 or 8; floats have 4 or 8, bools 1
  int count = 1;    ///< elements, up to kMaxPcdCount

  /** \brief Whether name, type, size and count are as said above. */
  bool isValid() const;
};

constexpr int kMaxPcdCount = 65536;               ///< elements of a field
constexpr std::size_t kMaxPcdPointSize = 1 << 20; ///< bytes of a point

/** \brief The points of a `.pcd` file as rows of bytes. */
struct PcdTable {
  std::vector<PcdField> fields;
  std::size_t points = 0;
  std::size_t width = 0;  ///< of an organized cloud; 0 x 0: a list of points
  std::size_t height = 0; ///< of an organized cloud; a list read from a file has 1
  std::array<double, 7> viewpoint{0, 0, 0, 1, 0, 0, 0}; ///< x y z [m], quaternion w x y
                                                        ///< z of the sensor
  /// Of a map's cloud: edge of a voxel, x y z of the lower corner of voxel 0 [m], in
  /// the header's comment `# voxel_grid`; edge 0 = not said.
  std::array<double, 4> voxel_grid{};
  std::vector<std::uint8_t> data; ///< points x the sizes of the fields, packed

  /** \brief Bytes of one point. */
  std::size_t pointSize() const;

  /** \brief Index of a field within `fields`; -1 if there is none of that name. */
  int find(const std::string& name) const;

  /** \brief Puts a column in the place of the one of the same name or, if there is
   * none, behind the others.
   * \param[in] values points x size x count bytes, packed
   * \throws InvalidParameterException if they are another number */
  void setColumn(const PcdField& field, const std::vector<std::uint8_t>& values);

  /** \brief Drops every field of that name.
   * \throws InvalidParameterException if the data do not fit the fields */
  void removeColumns(const std::string& name);
};

/** \brief Reads the numbers of one field, whatever their type. The table has to stay.
 */
class PcdColumn {
public:
  /** \throws InvalidParameterException if \a table has no such field, or too few data
   */
  PcdColumn(const PcdTable& table, int field);

  const PcdField&
  field() const
  {
    return field_;
  }

  /** \brief A value; integers beyond 2^53 are rounded. */
  double
  operator()(std::size_t point, int element = 0) const
  {
    return read_(at(point, element));
  }

  /** \brief Its bytes: colours are packed into floats. For fields of four bytes. */
  std::uint32_t bits(std::size_t point) const;

private:
  const std::uint8_t*
  at(std::size_t point, int element) const
  {
    return first_ + point * stride_ + std::size_t(element) * std::size_t(field_.size);
  }

  PcdField field_;
  const std::uint8_t* first_;
  std::size_t stride_;
  double (*read_)(const std::uint8_t* bytes);
};

} // namespace pcl_semantic
