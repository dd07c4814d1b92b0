// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "support/tiny_street.h"

namespace pcl_semantic {

struct CodeBlock {
  std::string language; ///< "bash"; empty if unspecified
  std::vector<std::string> lines;
};

inline std::vector<CodeBlock>
codeBlocksOf(const std::string& path)
{
  std::vector<CodeBlock> blocks;
  bool inside = false;
  for (const std::string& line : linesOf(path)) {
    const bool is_fence = line.rfind("```", 0) == 0;
    if (is_fence && !inside)
      blocks.push_back({line.substr(3), {}});
    else if (!is_fence && inside)
      blocks.back().lines.push_back(line);
    inside = inside != is_fence;
  }
  EXPECT_FALSE(inside) << path << ": the last block does not end";
  return blocks;
}

/** \brief The commands of a bash block, continued lines joined. */
inline std::vector<std::string>
commandsOf(const CodeBlock& block)
{
  std::vector<std::string> commands;
  bool continued = false;
  for (std::string line : block.lines) {
    const bool continues = !line.empty() && line.back() == '\\';
    if (continues)
      line.pop_back();
    if (continued)
      commands.back() += line;
    else if (!line.empty())
      commands.push_back(line);
    continued = continues;
  }
  return commands;
}

inline std::vector<std::string>
bashCommandsOf(const std::string& path)
{
  std::vector<std::string> commands;
  for (const CodeBlock& block : codeBlocksOf(path))
    if (block.language == "bash")
      for (const std::string& command : commandsOf(block))
        commands.push_back(command);
  return commands;
}

/** \brief Targets of the local links in a Markdown file. */
inline std::vector<std::string>
localLinksOf(const std::string& path)
{
  std::vector<std::string> links;
  const std::string text = bytesOf(path);
  for (std::size_t at = 0; (at = text.find("](", at)) != std::string::npos; ++at) {
    const std::string target = text.substr(at + 2, text.find(')', at) - at - 2);
    if (target.rfind("http", 0) != 0)
      links.push_back(target);
  }
  return links;
}

/** \brief Whether the lines of a block are consecutive in a source file, at any
 * indentation; empty lines are ignored. */
inline bool
isPartOf(const std::string& source, const CodeBlock& block)
{
  const auto flatten = [](const std::vector<std::string>& lines) {
    std::string text = "\n";
    for (const std::string& line : lines) {
      const std::size_t begin = line.find_first_not_of(' ');
      if (begin != std::string::npos)
        text += line.substr(begin) + "\n";
    }
    return text;
  };
  const std::string wanted = flatten(block.lines);
  return wanted.size() > 1 &&
         flatten(linesOf(source)).find(wanted) != std::string::npos;
}

} // namespace pcl_semantic
