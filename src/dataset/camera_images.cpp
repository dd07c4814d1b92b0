// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/dataset/camera_images.h>

#include "core/fail.h"
#include "files/file_pattern.h"

#include <pcl_semantic/images/image_file.h>

namespace pcl_semantic {

CameraImages::CameraImages(const std::string& pattern, const PinholeCamera& camera)
    : name_(pattern)
{
  camera.validate();
  const std::vector<std::string> paths = findFiles(pattern, imageExtensions());
  const std::vector<int> numbers = frameNumbersOf(paths);
  for (std::size_t i = 0; i < paths.size(); ++i)
    paths_[numbers.empty() ? int(i) : numbers[i]] = paths[i];
  const cv::Mat first = readImage(paths.front());
  undistorter_.emplace(camera, first.cols, first.rows, paths.front());
  camera_ = undistorter_->camera();
}

CameraImages::CameraImages(std::map<int, std::string> paths, const StereoCamera& camera,
                           std::string name)
    : paths_(std::move(paths)), camera_(camera), name_(std::move(name))
{}

cv::Mat
CameraImages::image(int frame) const
{
  const auto found = paths_.find(frame);
  if (found == paths_.end())
    fail<BadInputException>(name_, ": has no image of frame ", frame);
  const cv::Mat image = readImage(found->second, {camera_.width, camera_.height},
                                  " as " + paths_.begin()->second);
  return undistorter_ ? undistorter_->undistort(image) : image;
}

} // namespace pcl_semantic
