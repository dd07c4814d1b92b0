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

/** \brief The label of points without a class. */
constexpr Label kUnlabelled = 0;

struct LabelClass {
  std::string name;
  std::array<std::uint8_t, 3> colour{}; ///< red, green, blue
  bool sky = false;                     ///< has no surface: casts no ray
  bool dynamic = false;                 ///< moves or can move
  bool thin = false;  ///< thinner than the neighbourhood of a CRF, such as a pole or
                      ///< fence
  bool thing = false; ///< consists of objects that can be counted
  double gap = 0.0;   ///< between neighbouring points of an object [m]; 0 = the default
};

/** \brief The classes of a map: numbers 1..L with names and colours, chosen at run time
 * (`data/label_sets`, read by readLabelSet). */
class LabelSet {
public:
  LabelSet() = default;

  /** \brief Takes the classes in the order of their labels, 1 first.
   * \throws InvalidParameterException unless there are 1 to 255 classes with unique
   * names of at most 100 bytes without control characters */
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

  /** \brief Whether a class is marked `thing`. */
  bool hasThings() const;

  /** \brief The label of a class name; kUnlabelled if there is no such class. */
  Label find(const std::string& name) const;

  std::vector<Label> thinLabels() const;

private:
  std::vector<LabelClass> classes_;
};

/** \brief The class in a stored label number: its lower 16 bits. As in SemanticKITTI,
 * the upper bits are an instance. */
constexpr std::uint32_t
classOf(std::uint32_t number)
{
  return number & 0xFFFFu;
}

/** \brief Maps another numbering (raw SemanticKITTI ids reach 259) to labels, and
 * counts the numbers without a mapping. Copies share the counts; several threads may
 * use them at once. */
class LabelMapping {
public:
  LabelMapping();

  /** \brief Maps an id to a label; ids that are not set map to unlabelled.
   * \param[in] label kUnlabelled: the id has no class, as 0 always has, and is not
   * counted
   * \throws InvalidParameterException if \a id exceeds 65535 */
  void set(std::uint32_t id, Label label);

  bool
  has(std::uint32_t id) const
  {
    return id < known_.size() && known_[id];
  }

  /** \brief The label of classOf(\a number); an unmapped number is counted and gives
   * kUnlabelled. */
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

  /** \brief The unmapped numbers that were looked up, with their counts. */
  std::map<std::uint32_t, std::size_t> lacking() const;

private:
  struct Counts;

  void count(std::uint32_t id) const;

  std::vector<Label> labels_;
  std::vector<bool> known_;
  std::shared_ptr<Counts> counts_;
};

/** \brief One line that lists the unmapped numbers, the most frequent first; empty if
 * there are none.
 * \param[in] name of the mapping
 * \param[in] unit of the counts: "points" */
std::string textOfLacking(const LabelMapping& mapping, const std::string& name,
                          const std::string& unit);

/** \brief Maps the colours of a label image to labels. */
class ColourMapping {
public:
  /** \throws InvalidParameterException if two classes have the same colour */
  explicit ColourMapping(const LabelSet& label_set);

  /** \brief The class of a colour, kUnlabelled for black; nothing for other colours. */
  std::optional<Label> operator()(std::uint8_t red, std::uint8_t green,
                                  std::uint8_t blue) const;

private:
  std::map<std::array<std::uint8_t, 3>, Label> labels_;
};

/** \brief Meaning of the pixels of a label image: classes, other numbers or colours. */
using PixelMapping = std::variant<std::monostate, LabelMapping, ColourMapping>;

} // namespace pcl_semantic
