// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/files/atomic_file.h>

#include "core/fail.h"
#include "temporary_name.h"

#include <pcl_semantic/files/input_file.h>

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <locale>
#include <system_error>
#include <unistd.h>

namespace pcl_semantic {

namespace fs = std::filesystem;

namespace {

fs::path
folderOf(const std::string& path)
{
  const fs::path folder = fs::path(path).parent_path();
  return folder.empty() ? fs::path(".") : folder;
}

// Brings a file or a folder's entries to the disk.
bool
synchronize(const fs::path& path, int flags)
{
  const int descriptor = ::open(path.c_str(), flags);
  if (descriptor < 0)
    return false;
  const bool done = ::fsync(descriptor) == 0;
  ::close(descriptor);
  return done;
}

} // namespace

AtomicFile::AtomicFile(const std::string& path)
    : path_(path), temporary_path_(temporaryNameOf(path))
{
  // Renaming onto /dev/stdout or a pipe would replace it.
  std::error_code ignored;
  const fs::file_status status = fs::status(path_, ignored);
  if (fs::is_directory(status))
    fail<OutputException>(path_, ": cannot be written: it is a folder");
  if (fs::exists(status) && !fs::is_regular_file(status))
    fail<OutputException>(path_, ": cannot be written: it is no regular file");
  stream_.imbue(std::locale::classic());
  stream_.open(temporary_path_, std::ios::binary | std::ios::trunc);
  if (!stream_)
    fail<OutputException>(path_, ": cannot be written: ", std::strerror(errno));
}

AtomicFile::~AtomicFile()
{
  stream_.close();
  ::unlink(temporary_path_.c_str()); // without memory, too
}

void
AtomicFile::commit()
{
  stream_.close();
  if (stream_.fail() || !synchronize(temporary_path_, O_RDONLY))
    fail<OutputException>(path_,
                          ": could not be written completely (is the disk full?)");
  std::error_code error;
  fs::rename(temporary_path_, path_, error);
  if (error)
    fail<OutputException>(path_, ": cannot be written: ", error.message());
  synchronizeFolderOf(path_);
}

void
synchronizeFolderOf(const std::string& path)
{
  synchronize(folderOf(path), O_RDONLY | O_DIRECTORY);
}

void
writeBytes(const std::string& path, const void* bytes, std::size_t size)
{
  AtomicFile file(path);
  file.stream().write(static_cast<const char*>(bytes), std::streamsize(size));
  file.commit();
}

void
writeTextFile(const std::string& path, const std::string& text)
{
  writeBytes(path, text.data(), text.size());
}

void
makeOutputFolder(const std::string& path)
{
  std::error_code error;
  fs::create_directories(path, error);
  if (error)
    fail<OutputException>(path, ": cannot be made: ", error.message());
  removeAbandoned(path);
  AtomicFile probe((fs::path(path) / "pcl_semantic_probe").string());
}

void
removeFrameFiles(const std::string& folder, const std::string& extension,
                 const std::function<bool(int frame)>& is_removed)
{
  for (const FrameFile& file : listFrameFiles(folder, {extension})) {
    if (is_removed && !is_removed(file.frame))
      continue;
    std::error_code error;
    fs::remove(file.path, error);
    if (error)
      fail<OutputException>(file.path, ": cannot be removed: ", error.message());
  }
}

} // namespace pcl_semantic
