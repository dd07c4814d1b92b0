// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief A class number: 0 is unlabelled, classes are 1..L with L from 1 to 255. */
using Label = std::uint8_t;

/** \brief The label of everything that has no class. */
constexpr Label kUnlabelled = 0;

/** \brief Name, colour and properties of one class. */
struct LabelClass {
  std::string name;
  std::array<std::uint8_t, 3> colour{}; ///< red, green, blue
  bool sky = false;                     ///< has no surface: casts no ray
  bool dynamic = false;                 ///< moves, or may move
  bool thin = false; ///< thinner than the neighbourhood of a CRF: a pole, a fence
};

/** \brief The classes of a map: numbers 1..L with names and colours, chosen at run time
 * (`data/label_sets`, read by readLabelSet). */
class LabelSet {
public:
  LabelSet() = default;

  /** \brief Takes the classes in the order of their labels, 1 first.
   * \throws InvalidParameterException unless there are 1 to 255, named uniquely, by
   * at most 100 bytes without control characters. */
  explicit LabelSet(std::vector<LabelClass> classes);

  /** \brief L, the number of classes without the unlabelled one. */
  int
  size() const
  {
    return static_cast<int>(classes_.size());
  }

  /** \brief The class of a label.
   * \param[in] label 0 (black, "unlabelled") to L
   * \throws InvalidParameterException beyond L */
  const LabelClass& operator[](Label label) const;

  /** \brief The label of a name; kUnlabelled if no class is called so. */
  Label find(const std::string& name) const;

  /** \brief The labels of the classes that are thin. */
  std::vector<Label> thinLabels() const;

private:
  std::vector<LabelClass> classes_;
};

/** \brief The class in a number that labels a point or a pixel, in any file: its lower
 * 16 bits. The upper ones are an instance, as in SemanticKITTI. */
constexpr std::uint32_t
classOf(std::uint32_t number)
{
  return number & 0xFFFFu;
}

/** \brief Turns another numbering (raw SemanticKITTI ids go to 259) into labels, and
 * counts the numbers that it lacks. Copies of a mapping share the counts; several
 * threads may use them at once. */
class LabelMapping {
public:
  LabelMapping();

  /** \brief Every id that is not set maps to unlabelled.
   * \param[in] label kUnlabelled: the id is known to have no class, as 0 always is, and
   * is not counted
   * \throws InvalidParameterException beyond 65535 */
  void set(std::uint32_t id, Label label);

  /** \brief Whether an id was set. */
  bool
  has(std::uint32_t id) const
  {
    return id < known_.size() && known_[id];
  }

  /** \brief The label of classOf() a number; kUnlabelled, and counted, if it is
   * lacking.
   */
  Label
  operator()(std::uint32_t number) const
  {
    const std::uint32_t id = classOf(number);
    if (id < labels_.size() && labels_[id] != kUnlabelled)
      return labels_[id];
    if (id != 0 && !has(id))
      count(id);
    return kUnlabelled;
  }

  /** \brief The classes that were looked up and not set, and how often. */
  std::map<std::uint32_t, std::size_t> lacking() const;

private:
  struct Counts;

  void count(std::uint32_t id) const;

  std::vector<Label> labels_;
  std::vector<bool> known_;
  std::shared_ptr<Counts> counts_;
};

/** \brief One line that names the numbers a mapping lacks, the most frequent first;
 * empty if it lacks none.
 * \param[in] name of the mapping
 * \param[in] unit that is counted: "points" */
std::string textOfLacking(const LabelMapping& mapping, const std::string& name,
                          const std::string& unit);

/** \brief Turns the colours in which labels are drawn into labels. */
class ColourMapping {
public:
  /** \throws InvalidParameterException if two classes have one colour: it cannot be
   * told which is meant */
  explicit ColourMapping(const LabelSet& label_set);

  /** \brief The class of a colour, kUnlabelled for black; nothing for others. */
  std::optional<Label> operator()(std::uint8_t red, std::uint8_t green,
                                  std::uint8_t blue) const;

private:
  std::map<std::array<std::uint8_t, 3>, Label> labels_;
};

/** \brief Meaning of a label image's pixels: classes, other numbers or colours. */
using PixelMapping = std::variant<std::monostate, LabelMapping, ColourMapping>;

} // namespace pcl_semantic
