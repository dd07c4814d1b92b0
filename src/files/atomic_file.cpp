// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/files/atomic_file.h>

#include "core/fail.h"

#include <pcl_semantic/files/input_file.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <locale>
#include <system_error>

#include <fcntl.h>
#include <sys/file.h>
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

// Flushes a file or the entries of a folder to disk.
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

constexpr const char* temporary_ending = ".pcl_semantic";

// Hidden, in the same folder: .NAME.PROCESS.pcl_semantic
std::string
temporaryNameOf(const std::string& path)
{
  const std::string name = "." + fs::path(path).filename().string() + "." +
                           std::to_string(::getpid()) + temporary_ending;
  return (folderOf(path) / name).string();
}

// The writer of a temporary file holds its lock until the process ends; this works
// across machines. \return -1 if another process holds it, or the file system has no
// locks
int
lock(const std::string& path)
{
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_CLOEXEC);
  if (descriptor < 0 || ::flock(descriptor, LOCK_EX | LOCK_NB) == 0)
    return descriptor;
  ::close(descriptor);
  return -1;
}

bool
isAbandoned(const fs::directory_entry& entry)
{
  // A new file is briefly unlocked.
  constexpr std::chrono::seconds settled{10};
  std::error_code error;
  return entry.path().filename().string()[0] == '.' &&
         entry.path().extension() == temporary_ending && entry.is_regular_file(error) &&
         fs::file_time_type::clock::now() - entry.last_write_time(error) > settled &&
         !error;
}

void
removeAbandoned(const std::string& folder)
{
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    if (!isAbandoned(*entry))
      continue;
    const int descriptor = lock(entry->path().string());
    if (descriptor < 0)
      continue;
    ::unlink(entry->path().c_str());
    ::close(descriptor);
  }
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
  lock_ = lock(temporary_path_);
}

AtomicFile::~AtomicFile()
{
  stream_.close();
  ::unlink(temporary_path_.c_str()); // does not allocate
  if (lock_ >= 0)
    ::close(lock_);
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
