// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/files/cloud_file.h>

#include <string>

namespace pcl_semantic {

/** \brief Reads a `.pcd` file: ascii, binary or binary_compressed, fields of any name,
 * order and type, as written by PCL 1.13 and others. PCL's own reader crashes on an
 * empty file and returns success on garbage; this one validates everything.
 *
 * The header's lines may come in any order before DATA, each once; WIDTH x HEIGHT must
 * be POINTS. Fields called `_` are PCL's padding: any number is allowed, and they are
 * dropped; other names are unique. In ascii, a line is a point; nan and inf are floats,
 * a number that does not fit its type is refused. Binary data may be followed by zeros,
 * with which PCL pads the last page.
 * \throws BadInputException that names the file, if possible the line, and the expected
 * input */
PcdTable readPcd(const std::string& path);

} // namespace pcl_semantic
