// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/files/cloud_file.h>

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

} // namespace pcl_semantic
