// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/core/parse_number.h>

#include "fail.h"
#include "parse_whole.h"
#include "split.h"

#include <cmath>

namespace pcl_semantic {

double
parseNumber(const std::string& text, const std::string& where)
{
  double value = 0.0;
  const bool has_plus = !text.empty() && text[0] == '+';
  const std::string_view digits = std::string_view(text).substr(has_plus ? 1 : 0);
  const bool has_two_signs = has_plus && digits.substr(0, 1) == "-";
  if (has_two_signs || !parseWhole(digits, value))
    badInput(where, ": ", inQuotes(text), " is not a number");
  return value;
}

std::vector<double>
parseNumbers(const std::string& text, const std::string& where)
{
  std::vector<double> numbers;
  for (const std::string_view word : wordsOf(text)) {
    numbers.push_back(parseNumber(std::string(word), where));
    if (!std::isfinite(numbers.back()))
      badInput(where, ": '", word, "' is not a finite number");
  }
  return numbers;
}

std::string
inQuotes(std::string_view text)
{
  constexpr std::size_t longest = 40;
  std::string result = "'";
  for (const char c : text.substr(0, longest))
    result += c >= ' ' && c <= '~' ? c : '?';
  return result + (text.size() > longest ? "...'" : "'");
}

} // namespace pcl_semantic
