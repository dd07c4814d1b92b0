// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/pipeline/tuning_search.h>

#include <algorithm>
#include <random>
#include <set>
#include <tuple>

namespace pcl_semantic {

namespace {

// Makes the next choice of a grid. \return false after the last
bool
countUp(TuningChoice& choice, const std::vector<std::size_t>& sizes)
{
  for (std::size_t i = choice.size(); i-- > 0;) {
    if (++choice[i] < sizes[i])
      return true;
    choice[i] = 0;
  }
  return false;
}

double
gridSize(const std::vector<std::size_t>& sizes)
{
  double size = 1.0;
  for (const std::size_t each : sizes)
    size *= double(each);
  return size;
}

} // namespace

TuningSearch::TuningSearch(std::vector<std::size_t> sizes, TuningChoice start,
                           const Options& options, Possible possible)
    : sizes_(std::move(sizes)), start_(std::move(start)), options_(options),
      possible_(std::move(possible)), current_(start_)
{
  if (options_.budget < 1)
    PCL_THROW_EXCEPTION(InvalidParameterException, "budget of a search is "
                                                       << options_.budget
                                                       << ", expected 1 or more");
  if (options_.method == TuningMethod::grid)
    wantGrid();
  else if (options_.method == TuningMethod::random)
    wantRandom();
  else
    wanted_ = {start_};
}

void
TuningSearch::wantGrid()
{
  if (gridSize(sizes_) > options_.budget)
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "the grid has " << gridSize(sizes_)
                                        << " configurations, more than the budget of "
                                        << options_.budget);
  TuningChoice choice(sizes_.size(), 0);
  do
    if (choice == start_ || !possible_ || possible_(choice))
      wanted_.push_back(choice);
  while (countUp(choice, sizes_));
}

void
TuningSearch::wantRandom()
{
  std::mt19937 random(options_.seed);
  std::set<TuningChoice> chosen = {start_};
  wanted_ = {start_};
  const double all = gridSize(sizes_);
  // Bounded: what is impossible may be all that is left.
  for (long tries = 0; tries < 1000L * options_.budget; ++tries) {
    if (wanted_.size() >= std::size_t(options_.budget) || double(chosen.size()) >= all)
      return;
    TuningChoice choice;
    for (const std::size_t size : sizes_)
      choice.push_back(random() % size);
    if (chosen.insert(choice).second && (!possible_ || possible_(choice)))
      wanted_.push_back(choice);
  }
}

void
TuningSearch::take(const std::vector<double>& scores)
{
  for (std::size_t i = 0; i < wanted_.size(); ++i)
    seen_[wanted_[i]] = scores.at(i);
  wanted_.clear();
  if (options_.method == TuningMethod::coordinate)
    descend();
}

// Goes on until something has to be known, or nothing gets better.
void
TuningSearch::descend()
{
  while (unchanged_ < sizes_.size()) {
    wanted_ = unseenAlong(axis_);
    const std::size_t left = std::size_t(options_.budget) - seen_.size();
    if (wanted_.size() > left)
      wanted_.resize(left);
    if (!wanted_.empty())
      return;
    unchanged_ = moveAlong(axis_) ? 1 : unchanged_ + 1;
    axis_ = (axis_ + 1) % sizes_.size();
  }
}

std::vector<TuningChoice>
TuningSearch::unseenAlong(std::size_t axis) const
{
  std::vector<TuningChoice> unseen;
  TuningChoice choice = current_;
  for (choice[axis] = 0; choice[axis] < sizes_[axis]; ++choice[axis])
    if (!seen_.count(choice) && (!possible_ || possible_(choice)))
      unseen.push_back(choice);
  return unseen;
}

// To the best that was seen along an axis, if it is better by enough.
// \return whether it is
bool
TuningSearch::moveAlong(std::size_t axis)
{
  TuningChoice best = current_, choice = current_;
  for (choice[axis] = 0; choice[axis] < sizes_[axis]; ++choice[axis]) {
    const auto found = seen_.find(choice);
    if (found != seen_.end() && found->second > seen_.at(best))
      best = choice;
  }
  if (!(seen_.at(best) > seen_.at(current_) + options_.least_gain))
    return false;
  current_ = best;
  return true;
}

TuningChoice
plainestOfTheBest(const std::map<TuningChoice, double>& seen, const TuningChoice& start,
                  double margin)
{
  if (seen.empty())
    return start;
  double best = seen.begin()->second;
  for (const auto& [choice, score] : seen)
    best = std::max(best, score);
  using Rank = std::tuple<std::size_t, std::size_t, double>;
  const auto rank = [&](const TuningChoice& choice, double score) {
    std::size_t changed = 0, steps = 0;
    for (std::size_t i = 0; i < choice.size(); ++i) {
      changed += choice[i] != start[i];
      steps += std::max(choice[i], start[i]) - std::min(choice[i], start[i]);
    }
    return Rank(changed, steps, -score);
  };
  const TuningChoice* plainest = nullptr;
  for (const auto& [choice, score] : seen)
    if (score >= best - margin &&
        (!plainest || rank(choice, score) < rank(*plainest, seen.at(*plainest))))
      plainest = &choice;
  return *plainest;
}

} // namespace pcl_semantic
