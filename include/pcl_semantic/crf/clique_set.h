// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief A run of indices, for range-based loops. */
struct IndexRange {
  const std::int32_t* first;
  const std::int32_t* last;

  const std::int32_t*
  begin() const
  {
    return first;
  }

  const std::int32_t*
  end() const
  {
    return last;
  }

  std::size_t
  size() const
  {
    return std::size_t(last - first);
  }
};

/** \brief Lists of indices, one after the other: list r is indices[starts[r]] up to
 * indices[starts[r + 1]]. */
struct IndexLists {
  std::vector<std::size_t> starts{0};
  std::vector<std::int32_t> indices;

  std::size_t
  size() const
  {
    return starts.size() - 1;
  }

  IndexRange
  operator[](std::size_t row) const
  {
    return {indices.data() + starts[row], indices.data() + starts[row + 1]};
  }
};

/** \brief C cliques over N variables: the members of each clique, and the cliques of
 * each variable. Cliques may overlap and need not cover every variable. */
class CliqueSet {
public:
  /** \brief No cliques over no variables. */
  CliqueSet() = default;

  /** \param[in] cliques the members of each, from 0 (pcl::Indices fit)
   * \param[in] variables N, up to 2^31 - 1
   * \throws InvalidParameterException that names the clique, if one is empty, has a
   * member outside 0..N-1 or one twice */
  CliqueSet(const std::vector<std::vector<std::int32_t>>& cliques,
            std::size_t variables);

  /** \brief C, the number of cliques. */
  std::size_t
  size() const
  {
    return members_.size();
  }

  /** \brief N, the number of variables. */
  std::size_t
  variables() const
  {
    return cliques_.size();
  }

  /** \brief The variables of every clique, in the order they were given in. */
  const IndexLists&
  members() const
  {
    return members_;
  }

  /** \brief The cliques of every variable, in rising order. */
  const IndexLists&
  cliques() const
  {
    return cliques_;
  }

private:
  IndexLists members_;
  IndexLists cliques_;
};

} // namespace pcl_semantic
