// SPDX-License-Identifier: BSD-3-Clause
#include "files/file_pattern.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/dataset/camera_images.h>
#include <pcl_semantic/files/image_file.h>

#include <algorithm>
#include <numeric>

namespace pcl_semantic {

CameraImages::CameraImages(const std::string& pattern, const PinholeCamera& camera)
    : pattern_(pattern), paths_(findFiles(pattern, imageExtensions())),
      numbers_(frameNumbersOf(paths_))
{
  camera.validate();
  if (numbers_.empty()) {
    numbers_.resize(paths_.size());
    std::iota(numbers_.begin(), numbers_.end(), 0);
  }
  const cv::Mat first = readImage(paths_.front());
  camera_ = {camera.fx, camera.fy, camera.cx, camera.cy, 1.0, first.cols, first.rows};
}

cv::Mat
CameraImages::image(int frame) const
{
  const auto found = std::find(numbers_.begin(), numbers_.end(), frame);
  if (found == numbers_.end())
    PCL_THROW_EXCEPTION(BadInputException,
                        pattern_ << ": has no image of frame " << frame);
  const std::string& path = paths_[std::size_t(found - numbers_.begin())];
  cv::Mat image = readImage(path);
  if (image.cols != camera_.width || image.rows != camera_.height)
    PCL_THROW_EXCEPTION(BadInputException,
                        path << ": has " << image.cols << " x " << image.rows
                             << " pixels, expected those of " << paths_.front() << ", "
                             << camera_.width << " x " << camera_.height);
  return image;
}

} // namespace pcl_semantic
