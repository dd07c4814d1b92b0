// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/core/label_set.h>

#include "fail.h"
#include "text_stream.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <set>

namespace pcl_semantic {

LabelSet::LabelSet(std::vector<LabelClass> classes) : classes_(std::move(classes))
{
  if (classes_.empty() || classes_.size() > 255)
    badParameter("the label set has ", classes_.size(), " classes, expected 1 to 255");
  std::set<std::string> names;
  constexpr std::size_t longest = 100;
  for (const LabelClass& c : classes_) {
    const bool is_word =
        std::none_of(c.name.begin(), c.name.end(),
                     [](unsigned char x) { return x < 0x20 || x == 0x7F; });
    if (!is_word || c.name.size() > longest)
      badParameter("a class name has control characters, or more than ", longest,
                   " bytes");
    if (c.name.empty() || !names.insert(c.name).second)
      badParameter("class name '", c.name, "' is empty or used twice");
  }
}

const LabelClass&
LabelSet::operator[](Label label) const
{
  static const LabelClass unlabelled{"unlabelled"};
  if (label == kUnlabelled)
    return unlabelled;
  if (label > size())
    badParameter("label ", int(label), " is beyond the ", size(),
                 " classes of the label set");
  return classes_[label - 1];
}

Label
LabelSet::find(const std::string& name) const
{
  for (std::size_t i = 0; i < classes_.size(); ++i)
    if (classes_[i].name == name)
      return static_cast<Label>(i + 1);
  return kUnlabelled;
}

std::vector<Label>
LabelSet::thinLabels() const
{
  std::vector<Label> labels;
  for (int label = 1; label <= size(); ++label)
    if ((*this)[Label(label)].thin)
      labels.push_back(Label(label));
  return labels;
}

bool
LabelSet::hasThings() const
{
  return std::any_of(classes_.begin(), classes_.end(),
                     [](const LabelClass& each) { return each.thing; });
}

ColourMapping::ColourMapping(const LabelSet& label_set)
{
  for (int label = 1; label <= label_set.size(); ++label) {
    const LabelClass& each = label_set[Label(label)];
    const auto [other, is_new] = labels_.emplace(each.colour, Label(label));
    if (!is_new)
      badParameter(
          "'", label_set[other->second].name, "' and '", each.name,
          "' of the label set have the same colour, expected different colours");
  }
  labels_.emplace(label_set[kUnlabelled].colour, kUnlabelled);
}

std::optional<Label>
ColourMapping::operator()(std::uint8_t red, std::uint8_t green, std::uint8_t blue) const
{
  const auto found = labels_.find({red, green, blue});
  return found == labels_.end() ? std::nullopt : std::optional(found->second);
}

struct LabelMapping::Counts {
  std::array<std::atomic<std::size_t>, 65536> times{};
};

LabelMapping::LabelMapping() : counts_(std::make_shared<Counts>())
{}

void
LabelMapping::set(std::uint32_t id, Label label)
{
  constexpr std::uint32_t max_id = 65535;
  if (id > max_id)
    badParameter("label id ", id, " is beyond ", max_id);
  if (id >= labels_.size()) {
    labels_.resize(id + 1, kUnlabelled);
    known_.resize(id + 1, false);
  }
  labels_[id] = label;
  known_[id] = true;
}

std::map<std::uint32_t, std::size_t>
LabelMapping::lacking() const
{
  std::map<std::uint32_t, std::size_t> lacking;
  for (std::uint32_t id = 0; id < counts_->times.size(); ++id)
    if (const std::size_t times = counts_->times[id])
      lacking.emplace(id, times);
  return lacking;
}

void
LabelMapping::count(std::uint32_t id) const
{
  counts_->times[id].fetch_add(1, std::memory_order_relaxed);
}

std::string
textOfLacking(const LabelMapping& mapping, const std::string& name,
              const std::string& unit)
{
  const auto lacking = mapping.lacking();
  if (lacking.empty())
    return {};
  std::vector<std::pair<std::uint32_t, std::size_t>> numbers(lacking.begin(),
                                                             lacking.end());
  std::stable_sort(numbers.begin(), numbers.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  TextStream text;
  text << "label mapping " << name << " lacks " << numbers.size()
       << " numbers of the input: ";
  constexpr std::size_t most = 5;
  for (std::size_t i = 0; i < std::min(most, numbers.size()); ++i)
    text << (i > 0 ? ", " : "") << numbers[i].first << " (" << numbers[i].second
         << (i > 0 ? ")" : " " + unit + ")");
  text << (numbers.size() > most ? ", ...: " : ": ") << "they count as unlabelled";
  return text.str();
}

} // namespace pcl_semantic
