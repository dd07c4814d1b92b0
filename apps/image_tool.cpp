// SPDX-License-Identifier: BSD-3-Clause
#include "image_tool.h"
#include "tool.h"

#include <pcl_semantic/core/exceptions.h>

#include <opencv2/core.hpp>

#include <new>

namespace pcl_semantic::tool {

int
runWithImages(const std::string& name, const std::function<int()>& body)
{
  // OpenCV would otherwise print its own error messages.
  cv::redirectError(
      [](int, const char*, const char*, const char*, int, void*) { return 0; });
  return run(name, [&] {
    try {
      return body();
    }
    catch (const cv::Exception& error) {
      if (error.code == cv::Error::StsNoMem)
        throw std::bad_alloc();
      fail<BadInputException>(error.err);
    }
  });
}

} // namespace pcl_semantic::tool
