// SPDX-License-Identifier: BSD-3-Clause
#include "support/temporary_folder.h"
#include "support/thrown_message.h"
#include "support/toy_tuning.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/pipeline/tuning_report.h>

#include <gtest/gtest.h>

#include <random>

namespace pcl_semantic {

namespace {

// Another number at every place, the same for the same arguments.
int
noise(double a, double b, std::size_t sequence)
{
  std::mt19937 random(unsigned(a) * 100 + unsigned(b) * 10 + unsigned(sequence));
  return int(random() % 1000);
}

// Of one sequence the best is elsewhere than of the others.
int
hills(double a, double b, std::size_t sequence)
{
  const double wanted = sequence == 0 ? 4.0 : 1.0;
  return int(900 - 40 * std::abs(a - wanted) - 30 * std::abs(b - 3.0));
}

} // namespace

TEST(Tuner, WhatIsLeftOutIsScoredWithWhatTheOthersChoose)
{
  ToyTuning toy(noise);
  toy.options.search.method = TuningMethod::grid;
  TuningStore store("", "", 2);
  Tuner tuner = toy.make(store);
  ASSERT_TRUE(tuner.search());
  int held_out = 0;
  for (std::size_t left_out = 0; left_out <= 3; ++left_out) { // 3: none
    int best = -1;
    TuningChoice chosen;
    for (std::size_t a = 0; a < 5; ++a)
      for (std::size_t b = 0; b < 4; ++b) {
        int sum = 0;
        for (std::size_t s = 0; s < 3; ++s)
          sum += s == left_out ? 0 : noise(double(a), double(b), s);
        if (sum > best) {
          best = sum;
          chosen = {a, b};
        }
      }
    if (left_out == 3) {
      EXPECT_EQ(tuner.chosen(), chosen);
      EXPECT_NEAR(toy.options.score(tuner.pooled(chosen)), best / 30.0, 1e-9);
      break;
    }
    EXPECT_EQ(tuner.chosenWithout(left_out), chosen);
    held_out += noise(double(chosen[0]), double(chosen[1]), left_out);
  }
  EXPECT_NEAR(toy.options.score(tuner.heldOut()), held_out / 30.0, 1e-9);
}

TEST(Tuner, TheDescentWithoutASequenceKnowsNothingOfIt)
{
  ToyTuning toy(hills);
  ToyTuning other([](double a, double b, std::size_t sequence) {
    return sequence == 0 ? 1000 - hills(a, b, 0) : hills(a, b, sequence);
  });
  TuningStore store("", "", 2), other_store("", "", 2);
  Tuner tuner = toy.make(store), other_tuner = other.make(other_store);
  ASSERT_TRUE(tuner.search());
  ASSERT_TRUE(other_tuner.search());
  EXPECT_EQ(tuner.chosenWithout(0), (TuningChoice{1, 3}));
  EXPECT_EQ(other_tuner.chosenWithout(0), (TuningChoice{1, 3}));
  EXPECT_NE(tuner.chosenWithout(1), other_tuner.chosenWithout(1));
  // A gain in training that is a loss on the street left out is seen.
  const double start = toy.options.score(tuner.result({2, 2}, 0));
  EXPECT_LT(toy.options.score(tuner.result(tuner.chosenWithout(0), 0)), start);
}

TEST(Tuner, NothingRunsTwice)
{
  for (const int workers : {1, 3, 8}) {
    ToyTuning toy(hills);
    toy.options.workers = workers;
    TuningStore store("", "", 2);
    Tuner tuner = toy.make(store);
    ASSERT_TRUE(tuner.search());
    for (const auto& [key, count] : toy.runs)
      EXPECT_EQ(count, 1);
    EXPECT_EQ(tuner.runs(), toy.runs.size());
    EXPECT_LT(toy.runs.size(), 60u) << "a descent that looks at everything";
    EXPECT_EQ(tuner.chosen(), (TuningChoice{1, 3}));
  }
}

TEST(Tuner, ASearchThatWasEndedGoesOn)
{
  const TemporaryFolder folder;
  const std::string path = folder.path("runs.jsonl");
  ToyTuning whole(hills);
  TuningStore unused("", "", 2);
  Tuner reference = whole.make(unused);
  ASSERT_TRUE(reference.search());

  ToyTuning toy(hills);
  toy.options.workers = 1;
  {
    TuningStore store(path, "data: x\n", 2);
    Tuner tuner = toy.make(store);
    tuner.is_stopped = [&] { return toy.runs.size() == 10; };
    EXPECT_FALSE(tuner.search());
    EXPECT_EQ(toy.runs.size(), 10u);
  }
  TuningStore store(path, "data: x\n", 2);
  EXPECT_EQ(store.known(), 10u);
  Tuner tuner = toy.make(store);
  ASSERT_TRUE(tuner.search());
  for (const auto& [key, count] : toy.runs)
    EXPECT_EQ(count, 1);
  EXPECT_EQ(toy.runs.size(), whole.runs.size());
  EXPECT_EQ(tuningTable(tuner), tuningTable(reference));
}

TEST(Tuner, ProgressCountsEveryRun)
{
  ToyTuning toy(hills);
  TuningStore store("", "", 2);
  Tuner tuner = toy.make(store);
  std::size_t begun = 0, steps = 0;
  tuner.on_progress = [&](std::size_t done, std::size_t total) {
    begun += done == 0 ? total : 0;
    steps += done == 0 ? 0 : 1;
  };
  ASSERT_TRUE(tuner.search());
  EXPECT_EQ(begun, toy.runs.size());
  EXPECT_EQ(steps, toy.runs.size());
}

TEST(Tuner, WhatARunThrowsComesThrough)
{
  ToyTuning toy([](double, double, std::size_t) -> int {
    PCL_THROW_EXCEPTION(BadInputException, "frame 3: no labels");
  });
  TuningStore store("", "", 2);
  Tuner tuner = toy.make(store);
  EXPECT_TRUE(holds(thrownMessage<BadInputException>([&] { tuner.search(); }),
                    "frame 3: no labels"));
  EXPECT_EQ(tuner.runs(), 0u);
}

TEST(Tuner, OneSequenceHasNoneToLeaveOut)
{
  ToyTuning toy(hills);
  toy.names = {"one"};
  TuningStore store("", "", 2);
  Tuner tuner = toy.make(store);
  ASSERT_TRUE(tuner.search());
  EXPECT_EQ(tuner.chosen(), (TuningChoice{4, 3}));
  EXPECT_EQ(tuner.chosenWithout(0), tuner.chosen());
}

TEST(Tuner, BadOptionsAreRefused)
{
  const auto messageOf = [](const std::function<void(ToyTuning&)>& change) {
    ToyTuning toy(hills);
    change(toy);
    TuningStore store("", "", 2);
    return thrownMessage<InvalidParameterException>([&] { toy.make(store); });
  };
  EXPECT_TRUE(holds(messageOf([](ToyTuning& toy) {
                      toy.names = {"a", "a"};
                    }),
                    "each of another name"));
  EXPECT_TRUE(holds(messageOf([](ToyTuning& toy) { toy.options.workers = 0; }),
                    "runs at a time are 0"));
  EXPECT_TRUE(holds(messageOf([](ToyTuning& toy) { toy.options.margin = -1.0; }),
                    "margin is -1"));
  EXPECT_TRUE(holds(messageOf([](ToyTuning& toy) {
                      toy.options.search.method = TuningMethod::grid;
                      toy.options.search.budget = 19;
                    }),
                    "20 configurations"));
  EXPECT_TRUE(
      holds(messageOf([](ToyTuning& toy) { toy.grid.start.map.voxel_size = -1.0; }),
            "start"));
}

TEST(TuningTable, TheBestIsFirst)
{
  ToyTuning toy(hills);
  TuningStore store("", "", 2);
  Tuner tuner = toy.make(store);
  ASSERT_TRUE(tuner.search());
  const std::string table = tuningTable(tuner);
  EXPECT_EQ(table.rfind("smoothness_weight\tappearance_weight\tscore\tscore one\t", 0),
            0u);
  // (780 + 900 + 900) / 30, 78 and 90 and 90
  EXPECT_NE(table.find("\n1\t3\t86.00\t78.00\t90.00\t90.00\t"), std::string::npos)
      << table;
  EXPECT_LT(table.find("\n1\t3\t"), table.find("\n2\t2\t"));
}

} // namespace pcl_semantic
