// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/parallel_guard.h>
#include <pcl_semantic/pipeline/tuner.h>

#include <algorithm>
#include <atomic>
#include <mutex>
#include <set>
#include <thread>

namespace pcl_semantic {

namespace {

TuningSearch
makeSearch(const TuningGrid& grid, const TuningOptions& options)
{
  std::vector<std::size_t> sizes;
  for (const TuningAxis& axis : grid.axes)
    sizes.push_back(axis.candidates.size());
  return {sizes, grid.startChoice(), options.search,
          [&grid](const TuningChoice& choice) { return grid.isPossible(choice); }};
}

} // namespace

Tuner::Tuner(const TuningGrid& grid, const std::vector<std::string>& sequences,
             int classes, Run run, TuningStore& store, const TuningOptions& options)
    : grid_(grid), sequences_(sequences), classes_(classes), run_(std::move(run)),
      store_(store), options_(options), chosen_(grid.startChoice())
{
  require(grid, sequences, options);
}

void
Tuner::require(const TuningGrid& grid, const std::vector<std::string>& sequences,
               const TuningOptions& options)
{
  const std::set<std::string> names(sequences.begin(), sequences.end());
  if (sequences.empty() || names.size() != sequences.size())
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "a search needs sequences, each of another name");
  if (options.workers < 1 || options.workers > 1024)
    PCL_THROW_EXCEPTION(InvalidParameterException, "runs at a time are "
                                                       << options.workers
                                                       << ", expected 1 to 1024");
  if (!(options.margin >= 0.0 && options.margin <= 100.0))
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "margin is " << options.margin << ", expected 0 to 100");
  if (!(options.search.least_gain >= 0.0 && options.search.least_gain <= 100.0))
    PCL_THROW_EXCEPTION(InvalidParameterException, "least gain is "
                                                       << options.search.least_gain
                                                       << ", expected 0 to 100");
  if (!grid.isPossible(grid.startChoice()))
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "the values of the start do not go together");
  makeSearch(grid, options); // checks the rest
}

bool
Tuner::search()
{
  // One without each sequence, and one with all, which is the last.
  const std::size_t folds = sequences_.size() > 1 ? sequences_.size() : 0;
  std::vector<TuningSearch> searches(folds + 1, makeSearch(grid_, options_));
  const std::size_t all = sequences_.size(); // leaves none out
  const auto leftOutBy = [&](std::size_t i) {
    return i + 1 == searches.size() ? all : i;
  };
  for (;;) {
    std::vector<TuningChoice> wanted;
    for (const TuningSearch& search : searches)
      wanted.insert(wanted.end(), search.wanted().begin(), search.wanted().end());
    if (wanted.empty())
      break;
    if (!compute(wanted))
      return false;
    for (std::size_t i = 0; i < searches.size(); ++i) {
      std::vector<double> scores;
      for (const TuningChoice& choice : searches[i].wanted())
        scores.push_back(scoreWithout(choice, leftOutBy(i)));
      if (!scores.empty())
        searches[i].take(scores);
    }
  }
  const auto choose = [&](const TuningSearch& search) {
    return plainestOfTheBest(search.seen(), search.start(), options_.margin);
  };
  chosen_ = choose(searches.back());
  chosen_without_.assign(sequences_.size(), chosen_);
  for (std::size_t i = 0; i + 1 < searches.size(); ++i)
    chosen_without_[i] = choose(searches[i]);
  return lookAround();
}

double
Tuner::scoreWithout(const TuningChoice& choice, std::size_t left_out) const
{
  TuningResult sum(classes_);
  for (std::size_t i = 0; i < sequences_.size(); ++i)
    if (i != left_out)
      sum += result(choice, i);
  return options_.score(sum);
}

// The neighbours of what was chosen along each parameter, for a reader to see how much
// depends on it. Those of the choices without a sequence would be as many again for
// each.
bool
Tuner::lookAround()
{
  std::vector<TuningChoice> around;
  for (std::size_t axis = 0; axis < chosen_.size(); ++axis) {
    TuningChoice choice = chosen_;
    for (choice[axis] = 0; choice[axis] < grid_.axes[axis].candidates.size();
         ++choice[axis])
      if (grid_.isPossible(choice))
        around.push_back(choice);
  }
  return compute(around);
}

bool
Tuner::compute(const std::vector<TuningChoice>& choices)
{
  std::vector<Task> tasks;
  for (const TuningChoice& choice :
       std::set<TuningChoice>(choices.begin(), choices.end())) {
    if (results_.count(choice))
      continue;
    const MapperConfig config = grid_.config(choice);
    for (std::size_t i = 0; i < sequences_.size(); ++i)
      if (!store_.find(config, sequences_[i]))
        tasks.push_back({choice, i});
  }
  if (!tasks.empty() && !runTasks(tasks))
    return false;
  for (const TuningChoice& choice : choices) {
    const MapperConfig config = grid_.config(choice);
    std::vector<TuningResult> results;
    for (const std::string& sequence : sequences_)
      results.push_back(*store_.find(config, sequence));
    results_.emplace(choice, results);
  }
  return true;
}

bool
Tuner::runTasks(const std::vector<Task>& tasks)
{
  std::atomic<std::size_t> next{0};
  std::atomic<bool> ended{false};
  std::mutex storing;
  std::size_t done = 0;
  ParallelGuard guard;
  if (on_progress)
    on_progress(0, tasks.size());
  const auto work = [&] {
    for (std::size_t i = 0; !ended && (i = next++) < tasks.size();) {
      if (is_stopped && is_stopped()) {
        ended = true;
        return;
      }
      const MapperConfig config = grid_.config(tasks[i].choice);
      const TuningResult result = run_(config, tasks[i].sequence);
      const std::lock_guard<std::mutex> lock(storing);
      store_.add(config, sequences_[tasks[i].sequence], result);
      ++runs_;
      if (on_progress)
        on_progress(++done, tasks.size());
    }
  };
  std::vector<std::thread> threads;
  for (int i = 0; i < std::min(options_.workers, int(tasks.size())); ++i)
    threads.emplace_back([&] {
      guard.run([&] {
        try {
          work();
        }
        catch (...) {
          ended = true;
          throw;
        }
      });
    });
  for (std::thread& thread : threads)
    thread.join();
  guard.rethrow();
  return !ended;
}

const TuningResult&
Tuner::result(const TuningChoice& choice, std::size_t sequence) const
{
  return results_.at(choice).at(sequence);
}

TuningResult
Tuner::pooled(const TuningChoice& choice) const
{
  TuningResult sum(classes_);
  for (std::size_t i = 0; i < sequences_.size(); ++i)
    sum += result(choice, i);
  return sum;
}

TuningResult
Tuner::heldOut(std::size_t axis, std::size_t candidate) const
{
  TuningResult sum(classes_);
  for (std::size_t i = 0; i < sequences_.size(); ++i) {
    TuningChoice choice = chosenWithout(i);
    if (axis != no_axis)
      choice.at(axis) = candidate;
    if (!results_.count(choice))
      return TuningResult(classes_);
    sum += result(choice, i);
  }
  return sum;
}

std::map<TuningChoice, double>
Tuner::scores() const
{
  std::map<TuningChoice, double> scores;
  for (const auto& [choice, results] : results_)
    scores[choice] = options_.score(pooled(choice));
  return scores;
}

} // namespace pcl_semantic
