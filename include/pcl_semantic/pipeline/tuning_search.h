// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/pipeline/tuning_grid.h>

#include <functional>
#include <map>
#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief How a grid is searched. */
enum class TuningMethod {
  coordinate, ///< one parameter after the other, until none gets better
  grid,       ///< everything
  random      ///< choices by chance
};

/** \brief A search for the choice of the largest score. It asks for the scores of
 * several choices at a time, so that many can be computed together:
 * \code
 * while (!search.wanted().empty())
 *   search.take(scoresOf(search.wanted()));
 * \endcode */
class TuningSearch {
public:
  using Possible = std::function<bool(const TuningChoice&)>;

  struct Options {
    TuningMethod method = TuningMethod::coordinate;
    double least_gain = 0.05; ///< a descent moves for no less
    int budget = 60;          ///< choices to look at, at most
    unsigned seed = 1;        ///< of TuningMethod::random
  };

  /** \param[in] sizes number of candidates of each parameter
   * \param[in] start choice to begin with
   * \param[in] possible false for choices that are passed over; null = none
   * \throws InvalidParameterException if the budget is less than 1, or less than the
   * whole grid that is to be searched */
  TuningSearch(std::vector<std::size_t> sizes, TuningChoice start,
               const Options& options, Possible possible = nullptr);

  /** \brief Choices it has not seen yet and wants to know; empty = finished. */
  const std::vector<TuningChoice>&
  wanted() const
  {
    return wanted_;
  }

  /** \brief Takes the scores of wanted(), in its order. */
  void take(const std::vector<double>& scores);

  /** \brief All that was looked at, and its score. */
  const std::map<TuningChoice, double>&
  seen() const
  {
    return seen_;
  }

  const TuningChoice&
  start() const
  {
    return start_;
  }

private:
  void wantGrid();

  void wantRandom();

  void descend();

  std::vector<TuningChoice> unseenAlong(std::size_t axis) const;

  bool moveAlong(std::size_t axis);

  std::vector<std::size_t> sizes_;
  TuningChoice start_;
  Options options_;
  Possible possible_;
  std::vector<TuningChoice> wanted_;
  std::map<TuningChoice, double> seen_;
  TuningChoice current_;
  std::size_t axis_ = 0;
  std::size_t unchanged_ = 0; // axes in a row along which nothing got better
};

/** \brief The choice to recommend: of those whose score is at most \a margin below the
 * best, the one that changes the fewest parameters of the start; of these the one with
 * the fewest steps from it; of these the one of the largest score. A gain within the
 * margin is one that another street may take away. */
TuningChoice plainestOfTheBest(const std::map<TuningChoice, double>& seen,
                               const TuningChoice& start, double margin);

} // namespace pcl_semantic
