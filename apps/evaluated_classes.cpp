// SPDX-License-Identifier: BSD-3-Clause
#include "evaluated_classes.h"

#include <pcl_semantic/core/exceptions.h>

#include <algorithm>
#include <charconv>
#include <sstream>

namespace pcl_semantic::tool {

namespace {

// The class that a number or a name of --ignore means.
Label
ignoredLabel(const std::string& word, const LabelSet& label_set)
{
  int number = 0;
  const auto [rest, error] =
      std::from_chars(word.data(), word.data() + word.size(), number);
  if (error == std::errc() && rest == word.data() + word.size()) {
    if (number >= 1 && number <= label_set.size())
      return static_cast<Label>(number);
  }
  else if (const Label label = label_set.find(word))
    return label;
  PCL_THROW_EXCEPTION(InvalidParameterException,
                      "--ignore: '" << word << "' is no class of the label set");
}

} // namespace

std::vector<Label>
evaluatedClasses(const std::optional<std::string>& ignored, const LabelSet& label_set)
{
  std::vector<Label> left_out;
  if (!ignored)
    left_out = {label_set.find("sky"), label_set.find("pedestrian"),
                label_set.find("cyclist")};
  else if (*ignored != "none") {
    std::istringstream words(*ignored);
    for (std::string word; std::getline(words, word, ',');)
      left_out.push_back(ignoredLabel(word, label_set));
  }
  std::vector<Label> evaluated;
  for (int label = 1; label <= label_set.size(); ++label)
    if (std::find(left_out.begin(), left_out.end(), label) == left_out.end())
      evaluated.push_back(static_cast<Label>(label));
  if (evaluated.empty())
    PCL_THROW_EXCEPTION(InvalidParameterException, "--ignore leaves no class");
  return evaluated;
}

} // namespace pcl_semantic::tool
