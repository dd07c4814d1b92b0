// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/clouds/labelled_cloud.h>
#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_set.h>

#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Extensions of the files that readCloudTable() reads: `.pcd .ply .bin`. */
const std::vector<std::string>& cloudExtensions();

/** \brief The columns of a scan without a header, float32 each: x, y, z, others in any
 * place, `_` for one that is passed over. Empty: those of KITTI (x y z intensity) or,
 * of a file named `.pcd.bin`, of nuScenes (x y z intensity ring). */
using ScanColumns = std::vector<std::string>;

/** \brief The columns that a text names, with commas between them
 * (`x,y,z,intensity,ring`); or of their number, 3 to 16: as many of x y z intensity
 * ring, and `_`; none of an empty text.
 * \throws InvalidParameterException at another text */
ScanColumns parseScanColumns(const std::string& text);

/** \brief The same for one of several clouds, of which only a `.bin` has columns. */
ScanColumns parseScanColumns(const std::string& text, const std::string& path);

/** \brief Help of an option that parseScanColumns() reads. */
constexpr const char* kScanColumnsHelp = "columns of a .bin, float32 each: their "
                                         "names (x,y,z,intensity,ring; _ for one that "
                                         "is passed over) or their number (default: "
                                         "x,y,z,intensity, of a .pcd.bin also ring)";

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
