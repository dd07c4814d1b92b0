// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/files/input_file.h>

#include "parse_whole.h"

#include "core/fail.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace pcl_semantic {

namespace fs = std::filesystem;

std::vector<std::uint8_t>
readBytes(const std::string& path)
{
  std::error_code ignored;
  if (fs::is_directory(path, ignored))
    badInput(path, ": is a folder, expected a file");
  std::ifstream stream(path, std::ios::binary | std::ios::ate);
  if (!stream)
    badInput(path, ": cannot be read: ", std::strerror(errno));
  const std::streamoff size = stream.tellg();
  if (size < 0)
    badInput(path, ": cannot be read: it is no regular file");
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(size));
  stream.seekg(0);
  stream.read(reinterpret_cast<char*>(bytes.data()), std::streamsize(bytes.size()));
  if (!stream)
    badInput(path, ": could not be read completely");
  return bytes;
}

std::vector<TextLine>
readLines(const std::string& path)
{
  const std::vector<std::uint8_t> bytes = readBytes(path);
  std::string text(bytes.begin(), bytes.end());
  if (text.rfind("\xEF\xBB\xBF", 0) == 0)
    text.erase(0, 3);
  std::vector<TextLine> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    line.erase(line.find_last_not_of(" \t\r") + 1);
    lines.push_back({line, static_cast<int>(lines.size()) + 1});
  }
  return lines;
}

double
parseNumber(const std::string& text, const std::string& where)
{
  double value = 0.0;
  const bool has_plus = !text.empty() && text[0] == '+';
  const std::string_view digits = std::string_view(text).substr(has_plus ? 1 : 0);
  const bool has_two_signs = has_plus && digits.substr(0, 1) == "-";
  if (has_two_signs || !parseWhole(digits, value))
    badInput(where, ": ", inQuotes(text), " is not a number");
  return value;
}

std::vector<double>
parseNumbers(const std::string& text, const std::string& where)
{
  std::vector<double> numbers;
  std::istringstream stream(text);
  for (std::string word; stream >> word;) {
    numbers.push_back(parseNumber(word, where));
    if (!std::isfinite(numbers.back()))
      badInput(where, ": '", word, "' is not a finite number");
  }
  return numbers;
}

std::string
atLine(const std::string& path, int line)
{
  return path + " line " + std::to_string(line);
}

std::string
inQuotes(std::string_view text)
{
  constexpr std::size_t longest = 40;
  std::string result = "'";
  for (const char c : text.substr(0, longest))
    result += c >= ' ' && c <= '~' ? c : '?';
  return result + (text.size() > longest ? "...'" : "'");
}

std::string
frameFileName(int frame, const std::string& extension)
{
  char name[16];
  std::snprintf(name, sizeof(name), "%06d", frame);
  return name + extension;
}

std::vector<FrameFile>
listFrameFiles(const std::string& folder, const std::vector<std::string>& extensions)
{
  std::error_code error;
  fs::directory_iterator entries(folder, error);
  if (error)
    badInput(folder, ": cannot be read as a folder: ", error.message());
  std::vector<FrameFile> files;
  for (const fs::directory_entry& entry : entries) {
    const fs::path& path = entry.path();
    const std::string stem = path.stem().string();
    if (stem.find_first_not_of("0123456789") != std::string::npos ||
        !std::count(extensions.begin(), extensions.end(), path.extension()))
      continue;
    int frame = 0;
    if (!parseWhole(stem, frame) || frame > kMaxFrameNumber)
      badInput(path.string(), ": is no frame number, expected 0 to ", kMaxFrameNumber);
    files.push_back({frame, path.string()});
  }
  std::sort(files.begin(), files.end(), [](const FrameFile& a, const FrameFile& b) {
    return a.frame != b.frame ? a.frame < b.frame : a.path < b.path;
  });
  for (std::size_t i = 1; i < files.size(); ++i)
    if (files[i].frame == files[i - 1].frame)
      badInput(folder, ": frame ", files[i].frame,
               " is there twice: ", files[i - 1].path, " and ", files[i].path);
  return files;
}

} // namespace pcl_semantic
