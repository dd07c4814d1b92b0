// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_distributions.h>
#include <pcl_semantic/core/label_set.h>

#include <Eigen/Geometry>
#include <pcl/PCLPointCloud2.h>
#include <pcl/PointIndices.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

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

/** \brief Extensions of the files that readCloudTable() reads: `.pcd .ply .bin`. */
const std::vector<std::string>& cloudExtensions();

/** \brief The columns of a scan without a header, float32 each: x, y, z, others in any
 * place, `_` for one that is passed over. Empty: those of KITTI (x y z intensity) or,
 * of a file named `.pcd.bin`, of nuScenes (x y z intensity ring). */
using ScanColumns = std::vector<std::string>;

/** \brief The columns that a text names, with commas between them
 * (`x,y,z,intensity,ring`); or of their number, 3 to 16: as many of x y z intensity
 * ring, and `_`. \throws InvalidParameterException at another text */
ScanColumns parseScanColumns(const std::string& text);

/** \brief Reads a cloud by the extension of its file.
 *
 * `.pcd`: ascii, binary or compressed. `.ply`: ascii or little-endian, the scalar
 * properties of its vertices; faces are passed over. `.bin`: scans of float32 columns,
 * with the `label` of the `.label` file (uint32) of the same name beside it or in
 * `../labels`, if there is one. Fields that are known under other names, as
 * doc/formats.md lists them, are there as `label`, `probability` and `rgba`, too. Of
 * `label` classOf() is kept. \param[in] columns of a `.bin` \throws BadInputException
 * that names the file, and the line where there is one; also of a `.bin` whose numbers
 * are not in such columns */
PcdTable readCloudTable(const std::string& path, const ScanColumns& columns = {});

/** \brief Writes a binary `.pcd` (version 0.7), whole or not at all. PCL's own writer
 * leaves an empty file behind when the disk is full.
 * \throws InvalidParameterException if fields and data do not fit
 * \throws OutputException if it cannot be written */
void writeCloudTable(const std::string& path, const PcdTable& table);

/** \brief A cloud of any sensor with what is known of its labels. */
struct LabelledCloud {
  /** \brief Organized as the file was; viewpoint in its sensor_origin_ and
   * sensor_orientation_; points that are not finite keep their place. Positions are
   * relative to \a origin. */
  pcl::PointCloud<pcl::PointXYZRGBL>::Ptr cloud{new pcl::PointCloud<pcl::PointXYZRGBL>};
  LabelDistributions distributions;       ///< L x points; no classes: hard labels only
  std::vector<pcl::PointIndices> cliques; ///< of finite points, disjoint, none empty
  bool has_colour = false;                ///< whether the cloud's colours mean anything
  bool has_labels = false;                ///< likewise its labels
  PcdTable table; ///< the file it comes from, for the fields this struct does not know
  /// What was taken off the positions, see localOrigin(); zero unless the file has them
  /// in double precision and far away [m].
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  bool is_single = true; ///< the file's positions hold no more than single precision
};

/** \brief The positions of a cloud's points as its file has them, in double precision.
 * The cloud has to stay. */
class CloudPositions {
public:
  explicit CloudPositions(const LabelledCloud& labelled);

  /** \return of the i-th point [m] */
  Eigen::Vector3d
  operator()(std::size_t i) const
  {
    if (columns_.empty())
      return cloud_[i].getVector3fMap().cast<double>();
    return {columns_[0](i), columns_[1](i), columns_[2](i)};
  }

private:
  const pcl::PointCloud<pcl::PointXYZRGBL>& cloud_;
  std::vector<PcdColumn> columns_; // x y z, where the cloud is relative to an origin
};

/** \brief Adds the origin to the points of a cloud again, as far as single precision
 * holds it: for scans, which are relative to their sensor. */
void addOrigin(LabelledCloud& labelled);

/** \brief T_world_sensor that a cloud's VIEWPOINT states.
 * \param[in] name of the cloud, for the message
 * \throws BadInputException if its quaternion is none */
Eigen::Isometry3d viewpointOf(const PcdTable& table, const std::string& name);

/** \brief Reads points with labels (readCloudTable()), all but x y z optional, in any
 * order and of any type that holds the value: x y z [m]; rgb or rgba (four bytes,
 * packed as PCL does); label (0 = unlabelled); probability (COUNT L; sums to 1 within
 * 0.1 and is normalised, all zero = unlabelled); clique (0 = none). Without label the
 * labels are the most probable ones. Cliques come in the order of their numbers.
 * Of a number in `label` classOf() is taken. A cloud of no points may have no fields.
 * \param[in] mapping of the numbers in `label` to labels, others are unlabelled and
 * counted there; null = they are labels
 * \param[in] columns as readCloudTable() takes them
 * \throws BadInputException as readCloudTable(), or naming field and point: a value is
 * missing, negative, not finite where it has to be, a label is beyond L or 255 */
LabelledCloud readLabelledCloud(const std::string& path,
                                const LabelMapping* mapping = nullptr,
                                const ScanColumns& columns = {});

/** \brief The same of a table. \param[in] name of the cloud for messages */
LabelledCloud labelledCloudOf(PcdTable table, const std::string& name,
                              const LabelMapping* mapping = nullptr);

/** \brief Moves the points of a map's cloud, which says its PcdTable::voxel_grid, to
 * the centres of their voxels, where the CRF of the map saw them; other clouds stay.
 * The table keeps the positions of the file. */
void moveToVoxelCentres(LabelledCloud& labelled);

/** \brief The table that writeLabelledCloud() writes. \param[in] name for messages */
PcdTable tableOf(const LabelledCloud& labelled, const std::string& name);

/** \brief Writes a cloud, whole or not at all.
 *
 * The table is written as it is, so fields this module does not know, and coordinates
 * in double precision, survive; only `label`, `probability` (if there are
 * distributions) and `clique` (if the cliques are no longer the table's) are put in the
 * place of the old ones or behind the others. A cloud without table gets x y z (doubles
 * with the origin added, if it has one) and, if it has colour, rgba.
 * \throws InvalidParameterException if the sizes of cloud, table and distributions
 * differ, cliques overlap, see readCliques(), or its origin is not finite
 * \throws OutputException */
void writeLabelledCloud(const std::string& path, const LabelledCloud& labelled);

/** \brief Writes a cloud as the file it was read from, but for the field `clique`:
 * clique c has the number c + 1, points in none have 0.
 * \throws InvalidParameterException as writeLabelledCloud(), or if the cloud was not
 * read from a file \throws OutputException */
void writeCliques(const std::string& path, const LabelledCloud& labelled);

} // namespace pcl_semantic
