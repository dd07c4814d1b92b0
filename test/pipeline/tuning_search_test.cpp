// SPDX-License-Identifier: BSD-3-Clause
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/pipeline/tuning_search.h>

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <set>

namespace pcl_semantic {

namespace {

using Score = std::function<double(const TuningChoice&)>;

// Runs a search to its end; it must not ask for anything twice, nor for too much.
TuningSearch
finished(TuningSearch search, const Score& score, int budget)
{
  std::set<TuningChoice> asked;
  while (!search.wanted().empty()) {
    std::vector<double> scores;
    for (const TuningChoice& choice : search.wanted()) {
      EXPECT_TRUE(asked.insert(choice).second) << "asked twice";
      scores.push_back(score(choice));
    }
    search.take(scores);
  }
  EXPECT_LE(int(asked.size()), budget);
  EXPECT_EQ(asked.size(), search.seen().size());
  return search;
}

TuningChoice
bestOf(const TuningSearch& search)
{
  return plainestOfTheBest(search.seen(), search.start(), 0.0);
}

double
distance(std::size_t a, double b)
{
  return std::abs(double(a) - b);
}

} // namespace

TEST(TuningSearch, TheDescentFindsTheBestOfASeparableFunction)
{
  const Score score = [](const TuningChoice& c) {
    return -distance(c[0], 4) - 10.0 * distance(c[1], 0) - 0.1 * distance(c[2], 2);
  };
  TuningSearch::Options options;
  options.budget = 20; // of 6 * 4 * 5 = 120
  const TuningSearch search =
      finished({{6, 4, 5}, {0, 3, 1}, options}, score, options.budget);
  EXPECT_EQ(bestOf(search), (TuningChoice{4, 0, 2}));
}

TEST(TuningSearch, TheDescentEndsWhereNoSingleParameterGetsBetter)
{
  // A ridge: each step along one parameter makes room for one along the other.
  const Score score = [](const TuningChoice& c) {
    return -3.0 * distance(c[0], double(c[1])) - distance(c[0], 5);
  };
  TuningSearch::Options options;
  options.budget = 1000;
  const TuningSearch search = finished({{8, 8}, {1, 6}, options}, score, 64);
  const TuningChoice best = bestOf(search);
  for (std::size_t axis = 0; axis < 2; ++axis) {
    TuningChoice other = best;
    for (other[axis] = 0; other[axis] < 8; ++other[axis]) {
      EXPECT_TRUE(search.seen().count(other));
      EXPECT_LE(score(other), score(best));
    }
  }
}

TEST(TuningSearch, ADescentDoesNotMoveForNothing)
{
  const Score score = [](const TuningChoice& c) {
    return 0.04 * double(c[0]) + 0.03 * double(c[1]);
  };
  for (const double least_gain : {0.0, 0.035, 0.05}) {
    TuningSearch::Options options;
    options.least_gain = least_gain;
    const TuningSearch search = finished({{2, 2}, {0, 0}, options}, score, 60);
    // To {1, 0} and on to {1, 1}; to {1, 0}, from where {1, 1} is seen; nowhere.
    EXPECT_TRUE(search.seen().count({1, 0}));
    EXPECT_EQ(search.seen().count({1, 1}), least_gain < 0.04 ? 1u : 0u);
    EXPECT_EQ(search.seen().size(), least_gain == 0.0 ? 4u : 3u);
  }
}

TEST(TuningSearch, ABudgetEndsTheDescent)
{
  const Score score = [](const TuningChoice& c) { return double(c[0] + c[1]); };
  for (int budget = 1; budget <= 30; ++budget) {
    TuningSearch::Options options;
    options.budget = budget;
    const TuningSearch search =
        finished({{5, 5, 5}, {0, 0, 0}, options}, score, budget);
    EXPECT_TRUE(search.seen().count({0, 0, 0}));
    EXPECT_EQ(int(search.seen().size()), std::min(budget, 17)); // 1 + 4 + 4 + 4 + 4
  }
}

TEST(TuningSearch, WhatIsImpossibleIsPassedOver)
{
  const Score score = [](const TuningChoice& c) { return double(c[0] + c[1]); };
  const auto possible = [](const TuningChoice& c) { return c[0] + c[1] < 5; };
  for (const TuningMethod method :
       {TuningMethod::coordinate, TuningMethod::grid, TuningMethod::random}) {
    TuningSearch::Options options;
    options.method = method;
    const TuningSearch search =
        finished({{4, 4}, {0, 0}, options, possible}, score, 60);
    for (const auto& [choice, unused] : search.seen())
      EXPECT_TRUE(possible(choice));
    EXPECT_EQ(score(bestOf(search)), 4.0);
    if (method != TuningMethod::coordinate) {
      EXPECT_EQ(search.seen().size(), 13u) << "16 without 2 3, 3 2 and 3 3";
    }
  }
}

TEST(TuningSearch, AGridIsSeenWholeOrRefused)
{
  const std::vector<std::size_t> sizes = {3, 1, 4};
  TuningSearch::Options options;
  options.method = TuningMethod::grid;
  options.budget = 12;
  const TuningSearch search = finished(
      {sizes, {0, 0, 0}, options},
      [](const TuningChoice& c) { return double(c[0] * c[2]); }, 12);
  EXPECT_EQ(search.seen().size(), 12u);
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 4; ++j)
      EXPECT_TRUE(search.seen().count({i, 0, j}));
  EXPECT_EQ(bestOf(search), (TuningChoice{2, 0, 3}));
  options.budget = 11;
  EXPECT_TRUE(holds(thrownMessage<InvalidParameterException>([&] {
                      TuningSearch(sizes, {0, 0, 0}, options);
                    }),
                    "12 configurations, more than the budget of 11"));
}

TEST(TuningSearch, ChanceIsRepeatable)
{
  const Score score = [](const TuningChoice& c) { return double(c[0]); };
  TuningSearch::Options options;
  options.method = TuningMethod::random;
  options.budget = 15;
  const std::vector<std::size_t> sizes = {10, 10};
  const auto one = finished({sizes, {7, 2}, options}, score, 15).seen();
  const auto same = finished({sizes, {7, 2}, options}, score, 15).seen();
  options.seed = 2;
  const auto other = finished({sizes, {7, 2}, options}, score, 15).seen();
  EXPECT_EQ(one.size(), 15u);
  EXPECT_TRUE(one.count({7, 2})) << "the start";
  EXPECT_EQ(one, same);
  EXPECT_NE(one, other);
  options.budget = 1000; // more than there are
  EXPECT_EQ(finished({sizes, {7, 2}, options}, score, 100).seen().size(), 100u);
}

TEST(TuningSearch, NoBudgetIsRefused)
{
  TuningSearch::Options options;
  options.budget = 0;
  EXPECT_TRUE(holds(thrownMessage<InvalidParameterException>(
                        [&] { TuningSearch({2}, {0}, options); }),
                    "budget of a search is 0"));
}

TEST(PlainestOfTheBest, ChangesNoMoreThanTheGainIsWorth)
{
  const TuningChoice start = {2, 0, 1};
  const std::map<TuningChoice, double> seen = {{{2, 0, 1}, 50.0},
                                               {{2, 3, 1}, 51.85},
                                               {{2, 1, 1}, 51.82},
                                               {{3, 1, 1}, 52.0},
                                               {{4, 1, 0}, 51.99}};
  EXPECT_EQ(plainestOfTheBest(seen, start, 0.0), (TuningChoice{3, 1, 1}));
  // Two change one parameter; the second of them by one step.
  EXPECT_EQ(plainestOfTheBest(seen, start, 0.2), (TuningChoice{2, 1, 1}));
  EXPECT_EQ(plainestOfTheBest(seen, start, 0.16), (TuningChoice{2, 3, 1}));
  EXPECT_EQ(plainestOfTheBest(seen, start, 2.0), start);
  // As many changes and steps: the better one.
  EXPECT_EQ(plainestOfTheBest({{{1, 0}, 3.0}, {{0, 1}, 3.1}}, {0, 0}, 0.5),
            (TuningChoice{0, 1}));
}

} // namespace pcl_semantic
