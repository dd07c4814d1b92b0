// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>
#include <vector>

namespace pcl_semantic {

/** \brief Sets of the numbers 0, 1, ..., each with one member that stands for it, its
 * root (union-find). */
class DisjointSets {
public:
  /** \brief Adds numbers, each a set of its own, until there are so many. */
  void
  grow(std::size_t size)
  {
    const std::size_t old = parents_.size();
    parents_.resize(size);
    std::iota(parents_.begin() + std::ptrdiff_t(old), parents_.end(), int(old));
  }

  int
  rootOf(int member)
  {
    int root = member;
    while (parents_[std::size_t(root)] != root)
      root = parents_[std::size_t(root)];
    while (member != root) // the next search is short
      member = std::exchange(parents_[std::size_t(member)], root);
    return root;
  }

  /** \brief Joins the set of a root to that of another, which stays the root. */
  void
  join(int root, int other)
  {
    parents_[std::size_t(root)] = other;
  }

  /** \brief Joins the sets of two members; the smaller root stands for both. */
  void
  joinMembers(int a, int b)
  {
    const int root = rootOf(a), other = rootOf(b);
    join(std::max(root, other), std::min(root, other));
  }

private:
  std::vector<int> parents_;
};

} // namespace pcl_semantic
