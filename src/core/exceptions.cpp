// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/core/exceptions.h>

#include <pcl_semantic/core/printable.h>

namespace pcl_semantic {

Exception::Exception(const std::string& message, const char* source_file,
                     const char* function, unsigned source_line)
    : pcl::PCLException(printable(message), source_file, function, source_line),
      message_(printable(message))
{}

} // namespace pcl_semantic
