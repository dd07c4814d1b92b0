// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "support/run_tool.h"
#include "support/temporary_folder.h"

#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/images/image_file.h>

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace pcl_semantic {

/** \brief Three frames of the synthetic sequence, made by the test fault.tiny_street;
 * read-only. */
inline const std::string&
tinyStreet()
{
  static const std::string street = [] {
    const std::string path = PCL_SEMANTIC_BINARY_DIR "/test/tiny_street";
    EXPECT_TRUE(std::filesystem::exists(path + "/poses.txt"))
        << "run fault.tiny_street first, or the tests by ctest";
    return path;
  }();
  return street;
}

/** \brief Makes a copy of tinyStreet() that can be changed. */
inline void
copyStreet(const std::string& path)
{
  std::filesystem::remove_all(path);
  std::filesystem::copy(tinyStreet(), path, std::filesystem::copy_options::recursive);
}

/** \brief Makes all images of a copy uniformly grey. */
inline void
blankImages(const std::string& street)
{
  for (const char* const frame : {"000000", "000001", "000002"})
    for (const char* const folder : {"/image_2/", "/image_3/"})
      writePng(street + folder + frame + ".png",
               cv::Mat(64, 208, CV_8UC3, cv::Scalar::all(90)));
}

/** \brief Adds a scan of two points with labels. */
inline void
addScan(const std::string& street)
{
  const float points[] = {10, 2, -1, 0, 12, -1, -1, 0};
  const std::uint32_t labels[] = {40, 50};
  std::filesystem::create_directories(street + "/velodyne");
  std::ofstream(street + "/velodyne/000000.bin", std::ios::binary)
      .write(reinterpret_cast<const char*>(points), sizeof(points));
  std::ofstream(street + "/labels/000000.label", std::ios::binary)
      .write(reinterpret_cast<const char*>(labels), sizeof(labels));
}

inline std::vector<std::string>
linesOf(const std::string& path)
{
  std::vector<std::string> lines;
  std::istringstream stream(bytesOf(path));
  for (std::string line; std::getline(stream, line);)
    lines.push_back(line);
  return lines;
}

/** \brief Replaces a word of a text file by \a text; line and word count from 1. */
inline void
setWord(const std::string& path, std::size_t line, int word, const std::string& text)
{
  std::vector<std::string> lines = linesOf(path);
  std::istringstream words(lines.at(line - 1));
  std::string changed;
  int number = 0;
  for (std::string old; words >> old;)
    changed += (++number == word ? text : old) + " ";
  lines[line - 1] = changed;
  std::ofstream stream(path);
  for (const std::string& each : lines)
    stream << each << "\n";
}

/** \brief Makes a calibration of the sequence that of images of half the size. */
inline void
halveCamera(const std::string& calibration)
{
  for (std::size_t row = 1; row <= 4; ++row)
    for (const int word : {2, 4, 5, 7, 8}) {
      std::istringstream words(linesOf(calibration)[row - 1]);
      std::string number;
      for (int i = 0; i < word; ++i)
        words >> number;
      setWord(calibration, row, word, std::to_string(0.5 * std::stod(number)));
    }
}

/** \brief A sequence of \a frames frames, made once per process. It repeats the images
 * of tinyStreet(); the camera moves 2 m per frame to the right, and in the second half
 * back, so that blocks that have left a small window enter it again. */
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
