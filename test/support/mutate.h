// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <random>
#include <string>
#include <vector>

namespace pcl_semantic {

/** \brief Damages bytes at random: flips bits, writes bytes, cuts, inserts, repeats and
 * swaps chunks, and inserts words that are difficult for parsers. A seed gives the same
 * damage on every platform (no std distributions). */
class Mutator {
public:
  Mutator(unsigned seed, std::vector<std::string> words)
      : random_(seed), words_(std::move(words))
  {}

  std::string
  operator()(std::string bytes)
  {
    for (std::size_t n = 1 + below(4); n > 0; --n)
      mutate(bytes);
    return bytes;
  }

private:
  std::size_t
  below(std::size_t end)
  {
    return end == 0 ? 0 : random_() % end;
  }

  void
  mutate(std::string& bytes)
  {
    // Half of the damage affects the first bytes, which contain headers.
    const std::size_t reach =
        below(2) ? bytes.size() : std::min<std::size_t>(bytes.size(), 250);
    const std::size_t at = below(reach);
    const std::size_t length = std::min(bytes.size() - at, below(40));
    switch (below(8)) {
    case 0:
      if (!bytes.empty())
        bytes[at] = char(bytes[at] ^ (1 << below(8)));
      break;
    case 1:
      if (!bytes.empty())
        bytes[at] = char(below(256));
      break;
    case 2:
      bytes.resize(at);
      break;
    case 3:
      bytes.erase(at, length);
      break;
    case 4:
      bytes.insert(at, bytes.substr(at, length));
      break;
    case 5:
      bytes.insert(at, bytes.substr(below(bytes.size()), length));
      break;
    default: {
      // Replaces a word.
      const std::string& word = words_[below(words_.size())];
      const std::size_t end = bytes.find_first_of(" \n", at);
      bytes.replace(at, below(2) && end != std::string::npos ? end - at : 0, word);
    }
    }
  }

  std::mt19937 random_;
  std::vector<std::string> words_;
};

} // namespace pcl_semantic
