// SPDX-License-Identifier: BSD-3-Clause
#include "file_pattern.h"
#include "core/parse_whole.h"

#include "core/fail.h"

#include <pcl_semantic/files/input_file.h>

#include <boost/algorithm/string/case_conv.hpp>
#include <boost/algorithm/string/predicate.hpp>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <map>
#include <memory>
#include <new>

#include <glob.h>

namespace pcl_semantic {

namespace fs = std::filesystem;

namespace {

bool
isDigit(char c)
{
  return c >= '0' && c <= '9';
}

// Parses the number at `at`, without leading zeros, and advances `at`.
std::string
takeNumber(const std::string& text, std::size_t& at)
{
  const std::size_t begin = at;
  while (at < text.size() && isDigit(text[at]))
    ++at;
  std::size_t first = begin;
  while (first + 1 < at && text[first] == '0')
    ++first;
  return text.substr(first, at - first);
}

// A missing folder contains no files, but an unreadable one may.
int
isTrouble(const char*, int error)
{
  return error != ENOENT && error != ENOTDIR;
}

std::vector<std::string>
globbed(const std::string& pattern)
{
  glob_t found{};
  const int code = ::glob(pattern.c_str(), GLOB_NOSORT, &isTrouble, &found);
  const std::unique_ptr<glob_t, decltype(&::globfree)> guard(&found, &::globfree);
  if (code == GLOB_NOMATCH)
    badInput(pattern, ": no file matches");
  if (code == GLOB_NOSPACE)
    throw std::bad_alloc();
  if (code != 0)
    badInput(pattern, ": a folder cannot be read");
  return {found.gl_pathv, found.gl_pathv + found.gl_pathc};
}

std::vector<std::string>
filesIn(const std::string& folder, const std::vector<std::string>& extensions)
{
  std::map<std::string, std::string> files; // by name without extension
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    const fs::path& path = entry.path();
    const std::string extension =
        boost::algorithm::to_lower_copy(path.extension().string());
    if (path.filename().string()[0] == '.' || // hidden, as in the shell
        !std::count(extensions.begin(), extensions.end(), extension))
      continue;
    const auto [other, is_new] = files.emplace(path.stem().string(), path.string());
    if (!is_new)
      badInput(folder, ": holds ", fs::path(other->second).filename().string(), " and ",
               path.filename().string(),
               ", expected one kind of file; select one by a pattern: '", folder, "/*",
               extension, "'");
  }
  if (error)
    badInput(folder, ": the folder cannot be read");
  if (files.empty())
    badInput(folder, ": holds no file named *", extensions.front());
  std::vector<std::string> paths;
  for (const auto& [stem, path] : files)
    paths.push_back(path);
  return paths;
}

} // namespace

std::vector<std::string>
findFiles(const std::string& pattern, const std::vector<std::string>& extensions)
{
  std::error_code error;
  if (fs::is_regular_file(pattern, error))
    return {pattern};
  std::vector<std::string> files = fs::is_directory(pattern, error)
                                       ? filesIn(pattern, extensions)
                                       : globbed(pattern);
  std::sort(files.begin(), files.end(), naturalLess);
  return files;
}

std::vector<std::string>
filesEndingIn(const std::string& ending, const std::string& folder)
{
  std::vector<std::string> found;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error))
    if (boost::algorithm::ends_with(entry.path().filename().string(), ending))
      found.push_back(entry.path().string());
  std::sort(found.begin(), found.end(), naturalLess);
  return found;
}

bool
naturalLess(const std::string& a, const std::string& b)
{
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (isDigit(a[i]) && isDigit(b[j])) {
      const std::string left = takeNumber(a, i), right = takeNumber(b, j);
      if (left != right)
        return left.size() != right.size() ? left.size() < right.size() : left < right;
    }
    else if (a[i] != b[j])
      return a[i] < b[j];
    else
      ++i, ++j;
  }
  // Equal except for leading zeros: any total order will do.
  return a.size() - i != b.size() - j ? a.size() - i < b.size() - j : a < b;
}

std::vector<std::string>
numbersIn(const std::string& text)
{
  std::vector<std::string> numbers;
  for (std::size_t at = 0; at < text.size();)
    if (isDigit(text[at]))
      numbers.push_back(takeNumber(text, at));
    else
      ++at;
  return numbers;
}

std::string
frameNameOf(const std::string& path)
{
  const fs::path file(path), name = file.stem();
  const bool has_two = file.extension() == ".bin" && name.extension() == ".pcd";
  return (has_two ? name.stem() : name).string();
}

std::vector<int>
frameNumbersOf(const std::vector<std::string>& paths)
{
  std::vector<int> numbers;
  for (const std::string& path : paths) {
    const std::string name = frameNameOf(path);
    int number = -1;
    if (!parseWhole(name, number) || number < 0 || number > kMaxFrameNumber)
      return {};
    numbers.push_back(number);
  }
  for (std::size_t i = 1; i < numbers.size(); ++i)
    if (numbers[i] == numbers[i - 1])
      badInput(paths[i - 1], " and ", paths[i], ": are both frame ", numbers[i]);
  return numbers;
}

} // namespace pcl_semantic
