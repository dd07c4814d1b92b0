// SPDX-License-Identifier: BSD-3-Clause
#include "archive_file.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/atomic_file.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include <fcntl.h>
#include <unistd.h>

namespace pcl_semantic {

namespace fs = std::filesystem;

namespace {

void
refuseExisting(const std::string& path)
{
  std::error_code error;
  if (fs::exists(path, error))
    PCL_THROW_EXCEPTION(OutputException, path << ": is there already");
  for (const char* const ending : {"-wal", "-journal"})
    if (fs::exists(path + ending, error))
      PCL_THROW_EXCEPTION(OutputException,
                          path + ending << ": is left of an earlier archive of that "
                                           "name; remove it");
}

// Never over a file that has appeared meanwhile; some file systems cannot promise that.
void
rename(const std::string& from, const std::string& to)
{
  int result =
      ::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE);
  if (result != 0 && (errno == EINVAL || errno == ENOSYS)) {
    refuseExisting(to);
    result = ::rename(from.c_str(), to.c_str());
  }
  if (result != 0)
    PCL_THROW_EXCEPTION(OutputException,
                        to << ": cannot be written: " << std::strerror(errno));
}

// Removes what was made if it has not got its name.
class Temporary {
public:
  explicit Temporary(const std::string& path)
  {
    const fs::path final_path(path);
    name = (final_path.parent_path() / ("." + final_path.filename().string() + "." +
                                        std::to_string(::getpid()) + ".tmp"))
               .string();
    remove();
  }

  ~Temporary() { remove(); }

  Temporary(const Temporary&) = delete;
  Temporary& operator=(const Temporary&) = delete;

  std::string name;

private:
  void
  remove() const
  {
    std::error_code ignored;
    for (const char* const ending : {"", "-wal", "-shm", "-journal"})
      fs::remove(name + ending, ignored);
  }
};

} // namespace

void
makeArchiveFile(const std::string& path,
                const std::function<void(const std::string&)>& make)
{
  refuseExisting(path);
  const Temporary temporary(path);
  try {
    make(temporary.name);
  }
  catch (const OutputException& error) {
    std::string message = error.what();
    const std::size_t at = message.find(temporary.name);
    if (at != std::string::npos)
      message.replace(at, temporary.name.size(), path);
    PCL_THROW_EXCEPTION(OutputException, message);
  }
  rename(temporary.name, path);
  synchronizeFolderOf(path);
}

void
requireReadableFile(const std::string& path)
{
  std::error_code error;
  if (fs::is_directory(path, error))
    PCL_THROW_EXCEPTION(BadInputException, path << ": is a folder, expected a file");
  // Not by opening it: closing it again would drop the locks that SQLite holds on the
  // file in this process.
  if (::access(path.c_str(), R_OK) != 0)
    PCL_THROW_EXCEPTION(BadInputException,
                        path << ": cannot be read: " << std::strerror(errno));
}

} // namespace pcl_semantic
