// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "support/tiny_street.h"

#include <pcl_semantic/files/input_file.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace pcl_semantic {

/** \brief A sequence of \a frames frames, made once a process: the images are those of
 * tinyStreet() over and over; the camera goes 2 m a frame to the right, and in the
 * second half back, so that what has left a small window comes into it again. */
inline const std::string&
thereAndBack()
{
  constexpr int frames = 11;
  static const TemporaryFolder folder;
  static const std::string street = [&] {
    const std::string path = folder.path("street");
    copyStreet(path);
    const auto name = [&](int frame, const std::string& kind, const char* extension) {
      return path + "/" + kind + "/" + frameFileName(frame, extension);
    };
    for (int frame = 3; frame < frames; ++frame) {
      namespace fs = std::filesystem;
      fs::copy(name(frame % 3, "image_2", ".png"), name(frame, "image_2", ".png"));
      fs::copy(name(frame % 3, "image_3", ".png"), name(frame, "image_3", ".png"));
      fs::copy(name(frame % 3, "labels", ".bin"), name(frame, "labels", ".bin"));
    }
    std::filesystem::remove(path + "/times.txt");
    std::ofstream poses(path + "/poses.txt");
    for (int frame = 0; frame < frames; ++frame)
      poses << "1 0 0 " << 2 * std::min(frame, frames - 1 - frame)
            << " 0 1 0 0 0 0 1 0\n";
    return path;
  }();
  return street;
}

} // namespace pcl_semantic
