// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/abi_check.h>
#include <pcl_semantic/core/export.h>

#include <Eigen/Core>

#include <functional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief An enumerated value with one word per enumerator. */
struct ConfigChoice {
  std::vector<std::string> words; ///< words of the values 0, 1, ...
  std::function<int()> get;
  std::function<void(int)> set;
};

/** \brief Makes a choice for an enumeration whose values are 0, 1, ... in the order of
 * the words. */
template <typename Enum>
ConfigChoice
chooseFrom(Enum& value, std::vector<std::string> words)
{
  return {std::move(words), [&value] { return static_cast<int>(value); },
          [&value](int number) { value = static_cast<Enum>(number); }};
}

/** \brief One parameter of a configuration: its name (`voxel_size` in a YAML file,
 * `--voxel-size` as an option), its help text and a pointer to its value. */
struct ConfigParameter {
  using Value =
      std::variant<bool*, int*, double*, std::string*, Eigen::Vector3d*, ConfigChoice>;

  std::string name;
  std::string help;
  Value value;
  /// Default of a parameter that only presets set. It has no option and is printed only
  /// if its value differs from this default.
  std::string preset_default{};

  /** \brief Name of the option: dashes for underscores. */
  std::string option() const;

  /** \brief The value as text: "0.1", "25,25,8", "true". */
  std::string text() const;

  /** \brief Sets the value from text.
   * \param[in] where source of the text, for the error message
   * \throws BadInputException if \a text cannot be parsed */
  void set(const std::string& text, const std::string& where);
};

using ConfigParameters = std::vector<ConfigParameter>;

/** \brief Joins words as "a, b or c". */
std::string joinWords(const std::vector<std::string>& words);

} // namespace pcl_semantic
