// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <pcl/PCLPointCloud2.h>
#include <pcl/point_traits.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

constexpr int kMaxPcdCount = 65536;               ///< elements of a field
constexpr std::size_t kMaxPcdPointSize = 1 << 20; ///< bytes of a point

/** \brief Whether a `.pcd` file can have a field: its name is a word, it has 1 to
 * kMaxPcdCount elements of one of PCL's types. */
bool isPcdField(const pcl::PCLPointField& field);

/** \brief Bytes of a field in one point. */
std::size_t sizeOfField(const pcl::PCLPointField& field);

/** \brief PCL's cloud of any fields, with what a `.pcd` file says beside it. Points
 * follow each other, row by row; between their fields there may be gaps. `is_dense` is
 * false unless it is known to be true. */
struct PcdTable : pcl::PCLPointCloud2 {
  std::array<double, 7> viewpoint{0, 0, 0, 1, 0, 0, 0}; ///< x y z [m], quaternion w x y
                                                        ///< z of the sensor
  /// Of a map's cloud: edge of a voxel, x y z of the lower corner of voxel 0 [m], in
  /// the header's comment `# voxel_grid`; edge 0 = not said.
  std::array<double, 4> voxel_grid{};
  /// The field that `label` was made of, where the file has it under another name.
  std::string label_source;
  /// The instances that were taken off `label`, one a point, 0 = none; empty if no
  /// label had one.
  std::vector<std::uint16_t> instances;
  /// What its reader found doubtful, a line each that names the file: a field that
  /// looks like one that is understood, and is not.
  std::vector<std::string> doubts;

  PcdTable() = default;

  /** \brief Copies a cloud of any driver or filter without its padding (fields called
   * `_`, gaps between fields and rows).
   * \throws InvalidParameterException if sizes, fields or names do not fit, or the
   * bytes are big-endian */
  explicit PcdTable(const pcl::PCLPointCloud2& cloud);

  /** \brief Number of points. */
  std::size_t
  points() const
  {
    return std::size_t(width) * height;
  }

  /** \brief Index of a field within `fields`; -1 if there is none of that name. */
  int find(const std::string& name) const;

  /** \brief Puts a field behind the others of points that have no data yet.
   * \throws InvalidParameterException if points are larger than kMaxPcdPointSize */
  void addField(const std::string& name, std::uint8_t datatype, std::size_t count = 1);

  /** \brief Puts a column in the place of the one of the same name or, if there is
   * none, behind the others.
   * \param[in] field its offset does not matter
   * \param[in] values of all points, packed \param[in] bytes of them
   * \throws InvalidParameterException if they are another number */
  void setColumn(pcl::PCLPointField field, const void* values, std::size_t bytes);

  /** \brief The same of numbers, \a count a point. */
  template <typename T>
  void
  setColumn(const std::string& name, const std::vector<T>& values,
            std::size_t count = 1)
  {
    setColumn({name, 0, pcl::traits::asEnum_v<T>, pcl::uindex_t(count)}, values.data(),
              values.size() * sizeof(T));
  }

  /** \brief Drops every field of that name; its bytes become a gap. */
  void removeColumns(const std::string& name);
};

/** \brief Reads the numbers of one field, whatever their type. The table has to stay.
 */
class PcdColumn {
public:
  /** \throws InvalidParameterException if \a table has no such field, or too few data
   */
  PcdColumn(const PcdTable& table, int field);

  const pcl::PCLPointField&
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
    return first_ + point * stride_ + std::size_t(element) * size_;
  }

  pcl::PCLPointField field_;
  std::size_t size_; // of an element
  const std::uint8_t* first_;
  std::size_t stride_;
  double (*read_)(const std::uint8_t* bytes);
};

} // namespace pcl_semantic
