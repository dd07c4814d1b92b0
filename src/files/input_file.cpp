// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/files/input_file.h>

#include "core/fail.h"
#include "core/parse_whole.h"
#include "core/split.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <string_view>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace pcl_semantic {

namespace fs = std::filesystem;

namespace {

// Not a stream: streams hide std::bad_alloc, and opening a pipe would block.
struct OpenedFile {
  explicit OpenedFile(const std::string& path)
      : descriptor(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK))
  {}

  ~OpenedFile()
  {
    if (descriptor >= 0)
      ::close(descriptor);
  }

  OpenedFile(const OpenedFile&) = delete;
  OpenedFile& operator=(const OpenedFile&) = delete;

  const int descriptor;
};

void
requireRegular(const struct stat& status, const std::string& path)
{
  if (S_ISDIR(status.st_mode))
    badInput(path, ": is a folder, expected a file");
  if (!S_ISREG(status.st_mode))
    badInput(path, ": cannot be read: it is no regular file");
}

} // namespace

std::vector<std::uint8_t>
readBytes(const std::string& path)
{
  const OpenedFile file(path);
  struct stat status {};
  if (file.descriptor < 0 || ::fstat(file.descriptor, &status) != 0)
    badInput(path, ": cannot be read: ", std::strerror(errno));
  requireRegular(status, path);
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(status.st_size));
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t count =
        ::read(file.descriptor, bytes.data() + done, bytes.size() - done);
    if (count == 0 || (count < 0 && errno != EINTR))
      badInput(path, ": could not be read completely");
    done += std::size_t(std::max<ssize_t>(count, 0));
  }
  constexpr std::string_view pointer = "version https://git-lfs.github.com/spec/";
  if (bytes.size() > pointer.size() &&
      std::equal(pointer.begin(), pointer.end(), bytes.begin()))
    badInput(path,
             ": is a Git LFS pointer, expected the file; git lfs pull fetches it");
  return bytes;
}

void
requireRegularFile(const std::string& path)
{
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0)
    badInput(path, ": cannot be read: ", std::strerror(errno));
  requireRegular(status, path);
}

std::vector<TextLine>
readLines(const std::string& path)
{
  const std::vector<std::uint8_t> bytes = readBytes(path);
  std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  constexpr std::string_view mark = "\xEF\xBB\xBF"; // UTF-8 byte-order mark
  if (text.substr(0, mark.size()) == mark)
    text.remove_prefix(mark.size());
  std::vector<TextLine> lines;
  for (const std::string_view part : splitAt('\n', text)) {
    std::string line(part);
    line.erase(line.find_last_not_of(" \t\r") + 1);
    lines.push_back({std::move(line), static_cast<int>(lines.size()) + 1});
  }
  return lines;
}

std::string
atLine(const std::string& path, int line)
{
  return path + " line " + std::to_string(line);
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
    const std::string name = path.filename().string();
    const std::size_t digits = name.find_first_not_of("0123456789");
    if (digits == 0 || digits == std::string::npos ||
        !std::count(extensions.begin(), extensions.end(), name.substr(digits)))
      continue;
    const std::string stem = name.substr(0, digits);
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
