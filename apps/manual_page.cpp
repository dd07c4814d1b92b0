// SPDX-License-Identifier: BSD-3-Clause
#include "manual_page.h"

#include <pcl_semantic/version.h>

namespace pcl_semantic::tool {

namespace {

// Text that no macro is made of: hyphens are those of options, to be copied.
std::string
escaped(const std::string& text)
{
  std::string result;
  bool begins_line = true;
  for (const char letter : text) {
    if (begins_line && (letter == '.' || letter == '\''))
      result += "\\&";
    if (letter == '\\')
      result += "\\e";
    else if (letter == '-')
      result += "\\-";
    else
      result += letter;
    begins_line = letter == '\n';
  }
  return result;
}

// "does this" of "Does this. And that.", with its lines made one.
std::string
firstSentence(const std::string& description)
{
  std::string sentence = description.substr(0, description.find(". "));
  for (char& letter : sentence)
    if (letter == '\n')
      letter = ' ';
  if (!sentence.empty() && sentence.back() == '.')
    sentence.pop_back();
  return sentence;
}

// Boost writes "-o [ --output ]".
std::string
optionLine(const po::option_description& option)
{
  std::string line;
  const std::string name = option.format_name();
  if (name.size() > 1 && name[1] != '-')
    line = name.substr(0, 2) + ", ";
  line = "\\fB" + escaped(line + "--" + option.long_name()) + "\\fR";
  const std::string value = option.format_parameter();
  return value.empty() ? line : line + " " + escaped(value);
}

} // namespace

std::string
manualPage(const Usage& usage, const po::options_description& options)
{
  std::string page = ".TH " + usage.name + " 1 \"\" \"pcl_semantic " +
                     PCL_SEMANTIC_VERSION + "\" \"User Commands\"\n";
  page += ".SH NAME\n" + usage.name + " \\- " +
          escaped(firstSentence(usage.description)) + "\n";
  page += ".SH SYNOPSIS\n.B " + usage.name + "\n" + escaped(usage.synopsis) + "\n";
  page += ".SH DESCRIPTION\n" + escaped(usage.description) + "\n";
  page += ".SH OPTIONS\n";
  for (const auto& option : options.options())
    page +=
        ".TP\n" + optionLine(*option) + "\n" + escaped(option->description()) + "\n";
  page += ".SH EXAMPLE\n.nf\n" + escaped(usage.example) + "\n.fi\n";
  page += ".SH EXIT STATUS\n"
          "0: done; 2: the command line is wrong; 3: an input is; 4: a network is; "
          "5: an output could not be written; 6: out of memory; 130: interrupted.\n";
  return page;
}

} // namespace pcl_semantic::tool
