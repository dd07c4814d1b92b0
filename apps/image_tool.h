// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>

namespace pcl_semantic::tool {

/** \brief run() for programs that use OpenCV; converts OpenCV's errors. */
int runWithImages(const std::string& name, const std::function<int()>& body);

} // namespace pcl_semantic::tool
