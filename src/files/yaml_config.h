// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <memory>
#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief A mapping of a YAML file, read strictly: unknown and duplicate keys, and
 * values of another type than requested, are refused with file and line.
 *
 * Call get() or require() for every allowed key, then refuseUnknownKeys(). */
class YamlMap {
public:
  /** \brief Reads a file, with or without OpenCV's `%YAML:1.0` line.
   * \throws BadInputException if it cannot be read, is no YAML or no mapping */
  static YamlMap load(const std::string& path);

  bool has(const std::string& key) const;

  /** \brief Sets \a value if the key exists. T is bool, int, double, std::string or a
   * vector of int, double or std::string.
   * \return whether the key exists
   * \throws BadInputException if the value cannot be read as T */
  template <typename T> bool get(const std::string& key, T& value) const;

  /** \brief The value of a required key. \throws BadInputException */
  template <typename T>
  T
  require(const std::string& key) const
  {
    T value{};
    if (!get(key, value))
      throwMissing(key);
    return value;
  }

  /** \brief The mappings in a list. \throws BadInputException if the key is missing */
  std::vector<YamlMap> requireList(const std::string& key) const;

  /** \brief Whether the key exists and its value is a mapping. */
  bool isMap(const std::string& key) const;

  /** \brief The mapping under a key. \throws BadInputException if it is missing */
  YamlMap requireMap(const std::string& key) const;

  std::vector<std::string> keys() const;

  /** \brief "FILE line N" of a key, or of the mapping if the key is missing. */
  std::string where(const std::string& key) const;

  /** \throws BadInputException for the first key that was not requested */
  void refuseUnknownKeys() const;

private:
  struct Impl;

  explicit YamlMap(std::shared_ptr<Impl> impl) : impl_(std::move(impl)) {}

  [[noreturn]] void throwMissing(const std::string& key) const;

  std::shared_ptr<Impl> impl_;
};

} // namespace pcl_semantic
