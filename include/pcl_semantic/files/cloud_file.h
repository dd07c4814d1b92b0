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

/** \brief The float32 columns of a scan without a header: x, y, z and others in any
 * order; `_` for an ignored column. Empty: those of KITTI (x y z intensity) or, for a
 * file named `.pcd.bin`, of nuScenes (x y z intensity ring). */
using ScanColumns = std::vector<std::string>;

/** \brief Parses comma-separated column names (`x,y,z,intensity,ring`) or a number of
 * columns, 3 to 16: the first ones of x y z intensity ring, then `_`. An empty text
 * gives no columns. \throws InvalidParameterException for any other text */
ScanColumns parseScanColumns(const std::string& text);

/** \brief Parses the columns for one of several clouds: only a `.bin` has columns. */
ScanColumns parseScanColumns(const std::string& text, const std::string& path);

/** \brief Help of an option that parseScanColumns() reads. */
constexpr const char* kScanColumnsHelp =
    "columns of a .bin, float32 each: their names (x,y,z,intensity,ring; _ = ignored) "
    "or their number (default: x,y,z,intensity; of a .pcd.bin x,y,z,intensity,ring)";

/** \brief Reads a cloud; the extension selects the format.
 *
 * `.pcd`: ascii, binary or compressed. `.ply`: ascii or little-endian, the scalar
 * properties of its vertices; faces are ignored. `.bin`: scans of float32 columns, with
 * the `label` of the `.label` file (uint32) of the same name in the same folder or in
 * `../labels`, if there is one. Fields with alternative names (see doc/formats.md) are
 * also available as `label`, `probability` and `rgba`. `label` keeps its lower 16 bits,
 * the class (classOf()).
 * \param[in] columns of a `.bin`
 * \throws BadInputException that names the file and, if possible, the line; also for a
 * `.bin` whose size does not fit the columns or whose numbers are implausible */
PcdTable readCloudTable(const std::string& path, const ScanColumns& columns = {});

/** \brief Writes a binary `.pcd` (version 0.7), complete or not at all. PCL's own
 * writer leaves an empty file if the disk is full.
 * \throws InvalidParameterException if the data lacks fields of a point, a field is
 * invalid or occurs twice, or the viewpoint is not finite
 * \throws OutputException if it cannot be written */
void writeCloudTable(const std::string& path, const PcdTable& table);

/** \brief Reads labelled points (readCloudTable()). Fields may be in any order and of
 * any numeric type; all but x y z are optional: x y z [m]; rgb or rgba (four bytes,
 * packed as in PCL); label (0 = unlabelled); probability (COUNT L; must sum to 1 within
 * 0.1 and is normalised, all zero = unlabelled); clique (0 = none).
 *
 * Without a label field, labels are the most probable classes. Cliques are in the order
 * of their numbers. `label` keeps its lower 16 bits, the class (classOf()). An empty
 * cloud may have no fields.
 * \param[in] mapping from the numbers in `label` to labels; unmapped numbers become
 * unlabelled, and the mapping counts them. null = the numbers are labels
 * \param[in] columns as in readCloudTable()
 * \throws BadInputException as readCloudTable(), or naming field and point: a value is
 * missing, negative or not finite, or a label exceeds L or 255 */
LabelledCloud readLabelledCloud(const std::string& path,
                                const LabelMapping* mapping = nullptr,
                                const ScanColumns& columns = {});

/** \brief Writes a cloud, complete or not at all.
 *
 * The table is written unchanged, so unknown fields and double-precision coordinates
 * survive. Only `label`, `probability` (if there are distributions) and `clique` (if
 * the cliques differ from the table's) replace their columns or are appended. A cloud
 * without a table gets x y z (double precision with the origin added, if it has one)
 * and, if it has colour, rgba.
 * \throws InvalidParameterException if the sizes of cloud, table and distributions
 * differ, cliques overlap (see readCliques()), or the origin is not finite
 * \throws OutputException if the file cannot be written */
void writeLabelledCloud(const std::string& path, const LabelledCloud& labelled);

/** \brief Writes a cloud as read from its file, except for the field `clique`: clique c
 * has the number c + 1, points without a clique have 0.
 * \throws InvalidParameterException as writeLabelledCloud(), or if the cloud was not
 * read from a file
 * \throws OutputException if the file cannot be written */
void writeCliques(const std::string& path, const LabelledCloud& labelled);

} // namespace pcl_semantic
