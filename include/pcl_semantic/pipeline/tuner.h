// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/pipeline/tuning_search.h>
#include <pcl_semantic/pipeline/tuning_store.h>

#include <functional>
#include <map>
#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief How parameters are searched and judged. */
struct TuningOptions {
  TuningSearch::Options search;
  TuningScore score;
  double margin = 0.2; ///< see plainestOfTheBest() [points]
  int workers = 1;     ///< runs at a time
};

/** \brief Searches the parameters that do best on several sequences, and says what that
 * is worth on a sequence that was not looked at.
 *
 * One search sees all sequences; besides, for each sequence one sees only the others,
 * and what it chooses is scored on the one left out. The searches go side by side, each
 * with its whole budget, and share their runs. */
class Tuner {
public:
  /** \brief Maps one sequence; several threads call it at once. */
  using Run = std::function<TuningResult(const MapperConfig&, std::size_t sequence)>;

  /** \param[in] sequences their names, each once
   * \param[in] classes L
   * \param[in] store where results are kept
   * \throws InvalidParameterException */
  Tuner(const TuningGrid& grid, const std::vector<std::string>& sequences, int classes,
        Run run, TuningStore& store, const TuningOptions& options);

  /** \brief The checks of the constructor, before anything is written.
   * \throws InvalidParameterException */
  static void require(const TuningGrid& grid, const std::vector<std::string>& sequences,
                      const TuningOptions& options);

  /** \brief Called when some runs begin, with 0 of so many done, and after each. */
  std::function<void(std::size_t done, std::size_t total)> on_progress;

  /** \brief Asked before each run; true ends the search. */
  std::function<bool()> is_stopped;

  /** \brief \return whether it came to its end; the store keeps what was run
   * \throws what a run throws, OutputException */
  bool search();

  // After the search:

  const TuningChoice&
  chosen() const
  {
    return chosen_;
  }

  /** \brief What is chosen without a sequence; as chosen() if there is but one. */
  const TuningChoice&
  chosenWithout(std::size_t sequence) const
  {
    return chosen_without_.at(sequence);
  }

  /** \brief Of a choice that was looked at: on one sequence, or on all. */
  const TuningResult& result(const TuningChoice& choice, std::size_t sequence) const;

  TuningResult pooled(const TuningChoice& choice) const;

  /** \brief Each sequence with what was chosen without it, pooled. If \a axis is one,
   * with its candidate \a candidate in the place of the one chosen; without counts if
   * one of these was not looked at. */
  TuningResult heldOut(std::size_t axis = no_axis, std::size_t candidate = 0) const;

  static constexpr std::size_t no_axis = std::size_t(-1);

  /** \brief All choices that have results, with the score over all sequences. */
  std::map<TuningChoice, double> scores() const;

  const TuningGrid&
  grid() const
  {
    return grid_;
  }

  const std::vector<std::string>&
  sequences() const
  {
    return sequences_;
  }

  const TuningOptions&
  options() const
  {
    return options_;
  }

  /** \brief Runs of one sequence that this search made itself. */
  std::size_t
  runs() const
  {
    return runs_;
  }

private:
  struct Task {
    TuningChoice choice;
    std::size_t sequence;
  };

  double scoreWithout(const TuningChoice& choice, std::size_t left_out) const;

  bool compute(const std::vector<TuningChoice>& choices);

  bool runTasks(const std::vector<Task>& tasks);

  bool lookAround();

  TuningGrid grid_;
  std::vector<std::string> sequences_;
  int classes_;
  Run run_;
  TuningStore& store_;
  TuningOptions options_;
  std::map<TuningChoice, std::vector<TuningResult>> results_; // by sequence
  TuningChoice chosen_;
  std::vector<TuningChoice> chosen_without_;
  std::size_t runs_ = 0;
};

} // namespace pcl_semantic
