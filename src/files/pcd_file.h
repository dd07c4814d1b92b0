// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/files/pcd_table.h>

#include <iosfwd>
#include <string>

namespace pcl_semantic {

/** \brief Reads a `.pcd` file: ascii, binary or binary_compressed, fields of any name,
 * order and type, as PCL 1.13 and others write them. PCL's own reader crashes on an
 * empty file and returns success on garbage; this one believes nothing.
 *
 * The header's lines may come in any order before DATA, each once; WIDTH x HEIGHT has
 * to be POINTS. Fields called `_` are PCL's padding: any number of them, and dropped;
 * other names are unique. In ascii a point is a line; nan and inf are floats, a number
 * its type cannot hold is refused. Behind binary data there may be zeros, with which
 * PCL fills the last page.
 * \throws BadInputException that names the file, the line where there is one, and what
 * was expected */
PcdTable readPcd(const std::string& path);

/** \brief Writes a binary `.pcd` (version 0.7) whole or not at all. PCL's own writer
 * leaves an empty file behind when the disk is full.
 * \throws InvalidParameterException if fields, data, width and height do not fit
 * \throws OutputException if it cannot be written */
void writePcd(const std::string& path, const PcdTable& table);

/** \brief The header of such a file, for those who write the points themselves.
 * \param[in] table its data do not matter */
void writePcdHeader(std::ostream& stream, const PcdTable& table);

} // namespace pcl_semantic
