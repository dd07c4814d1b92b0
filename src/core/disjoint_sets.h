// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>
#include <vector>

namespace pcl_semantic {

/** \brief Disjoint sets of the numbers 0, 1, ..., each represented by its root
 * (union-find). */
class DisjointSets {
public:
  /** \brief Adds single-element sets up to \a size numbers. */
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
    while (member != root) // path compression
      member = std::exchange(parents_[std::size_t(member)], root);
    return root;
  }

  /** \brief Merges the set of a root into that of another root, which stays the root.
   */
  void
  join(int root, int other)
  {
    parents_[std::size_t(root)] = other;
  }

  /** \brief Merges the sets of two members; the smaller root stays the root. */
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
