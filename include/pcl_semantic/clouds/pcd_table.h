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

/** \brief Whether a `.pcd` file can contain a field: its name is one word, and it has 1
 * to kMaxPcdCount elements of one of PCL's types. */
bool isPcdField(const pcl::PCLPointField& field);

/** \brief Bytes of a field in one point. */
std::size_t sizeOfField(const pcl::PCLPointField& field);

/** \brief PCL's cloud of any fields, and the other contents of a `.pcd` file. Points
 * are stored row by row without padding between them; gaps between fields are allowed.
 * `is_dense` is true only if that is certain. */
struct PcdTable : pcl::PCLPointCloud2 {
  std::array<double, 7> viewpoint{0, 0, 0, 1, 0, 0, 0}; ///< x y z [m], quaternion w x y
                                                        ///< z of the sensor
  /// For a map's cloud: edge of a voxel and x y z of the lower corner of voxel 0 [m],
  /// from the header's comment `# voxel_grid`; edge 0 = unknown.
  std::array<double, 4> voxel_grid{};
  /// Name of the field in the file that became `label`, if it is another.
  std::string label_source;
  /// Instances that were removed from the label numbers, one per point, 0 = none; empty
  /// if no label had one.
  std::vector<std::uint16_t> instances;
  /// Warnings of the reader, one line each with the file name: a field whose name
  /// resembles a supported one but is not.
  std::vector<std::string> doubts;

  PcdTable() = default;

  /** \brief Copies a cloud of any driver or filter without its padding (fields called
   * `_`, gaps between fields and rows).
   * \throws InvalidParameterException if sizes, fields or names are inconsistent, or
   * the bytes are big-endian */
  explicit PcdTable(const pcl::PCLPointCloud2& cloud);

  std::size_t
  points() const
  {
    return std::size_t(width) * height;
  }

  /** \brief Index of a field within `fields`; -1 if there is none with that name. */
  int find(const std::string& name) const;

  /** \brief Appends a field to points that have no data yet.
   * \throws InvalidParameterException if points would exceed kMaxPcdPointSize */
  void addField(const std::string& name, std::uint8_t datatype, std::size_t count = 1);

  /** \brief Replaces the column of the same name or appends a new one.
   * \param[in] field its offset is ignored
   * \param[in] values of all points, packed
   * \param[in] bytes size of \a values
   * \throws InvalidParameterException unless \a bytes is the size of the field times
   * the number of points */
  void setColumn(pcl::PCLPointField field, const void* values, std::size_t bytes);

  /** \brief Sets a column from a vector, \a count values per point. */
  template <typename T>
  void
  setColumn(const std::string& name, const std::vector<T>& values,
            std::size_t count = 1)
  {
    setColumn({name, 0, pcl::traits::asEnum_v<T>, pcl::uindex_t(count)}, values.data(),
              values.size() * sizeof(T));
  }

  /** \brief Removes every field of that name; its bytes become a gap. */
  void removeColumns(const std::string& name);
};

/** \brief Reads the numbers of one field of any type. The table must outlive this
 * object. */
class PcdColumn {
public:
  /** \throws InvalidParameterException if \a table has no such field, or too little
   * data */
  PcdColumn(const PcdTable& table, int field);

  const pcl::PCLPointField&
  field() const
  {
    return field_;
  }

  /** \brief The value as double; integers beyond 2^53 are rounded. */
  double
  operator()(std::size_t point, int element = 0) const
  {
    return read_(at(point, element));
  }

  /** \brief The raw bits of a four-byte field, such as a colour packed into a float. */
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
