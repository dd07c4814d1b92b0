// SPDX-License-Identifier: BSD-3-Clause
#include "support/temporary_folder.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/pipeline/tuning_store.h>

#include <gtest/gtest.h>

#include <random>

namespace pcl_semantic {

namespace {

constexpr int classes = 4;
const std::string data = "program: 1\n05: ten frames\n";

ConfusionMatrix
randomConfusion(std::mt19937& random)
{
  ConfusionMatrix confusion(classes);
  for (int truth = 0; truth <= classes; ++truth)
    for (int label = 0; label <= classes; ++label)
      if (random() % 2)
        confusion.add(Label(truth), Label(label), random());
  return confusion;
}

TuningResult
randomResult(unsigned seed)
{
  std::mt19937 random(seed);
  TuningResult result(classes);
  for (TuningCounts* const counts : {&result.at_depth, &result.rendered}) {
    counts->network = randomConfusion(random);
    counts->fused = randomConfusion(random);
    counts->refined = randomConfusion(random);
  }
  return result;
}

void
expectSame(const ConfusionMatrix& a, const ConfusionMatrix& b)
{
  for (int truth = 0; truth <= classes; ++truth)
    for (int label = 0; label <= classes; ++label)
      EXPECT_EQ(a(Label(truth), Label(label)), b(Label(truth), Label(label)));
}

void
expectSame(const TuningResult* a, const TuningResult& b)
{
  ASSERT_NE(a, nullptr);
  for (const auto view : {&TuningResult::at_depth, &TuningResult::rendered})
    for (const auto counts :
         {&TuningCounts::network, &TuningCounts::fused, &TuningCounts::refined})
      expectSame((a->*view).*counts, (b.*view).*counts);
}

MapperConfig
withWeight(double weight)
{
  MapperConfig config;
  config.crf_parameters.smoothness_weight = weight;
  return config;
}

// A file with two runs.
std::string
madeStore(const TemporaryFolder& folder)
{
  const std::string path = folder.path("runs.jsonl");
  TuningStore store(path, data, classes);
  store.add(withWeight(1.0), "05", randomResult(1));
  store.add(withWeight(1.5), "05", randomResult(2));
  return path;
}

} // namespace

TEST(TuningStore, WhatWasAddedIsFoundAgain)
{
  const TemporaryFolder folder;
  const std::string path = madeStore(folder);
  TuningStore store(path, data, classes);
  EXPECT_EQ(store.known(), 2u);
  expectSame(store.find(withWeight(1.0), "05"), randomResult(1));
  expectSame(store.find(withWeight(1.5), "05"), randomResult(2));
  EXPECT_EQ(store.find(withWeight(1.5), "07"), nullptr);
  EXPECT_EQ(store.find(withWeight(2.0), "05"), nullptr);
  MapperConfig threads = withWeight(1.0);
  threads.threads = 7; // nothing depends on it
  EXPECT_NE(store.find(threads, "05"), nullptr);
  store.add(withWeight(2.0), "05", randomResult(3));
  expectSame(TuningStore(path, data, classes).find(withWeight(2.0), "05"),
             randomResult(3));
}

TEST(TuningStore, WithoutAFileItRemembers)
{
  TuningStore store("", data, classes);
  store.add(withWeight(1.0), "05", randomResult(1));
  expectSame(store.find(withWeight(1.0), "05"), randomResult(1));
}

TEST(TuningStore, OtherDataAreRefused)
{
  const TemporaryFolder folder;
  const std::string path = madeStore(folder);
  const std::string before = bytesOf(path);
  EXPECT_EQ(thrownMessage<BadInputException>(
                [&] { TuningStore(path, "program: 2\n05: ten frames\n", classes); }),
            path + ": holds other runs: program was 1, is 2; name another file, or "
                   "remove it");
  EXPECT_EQ(bytesOf(path), before);
}

TEST(TuningStore, AKilledRunsLastLineIsDropped)
{
  const TemporaryFolder folder;
  const std::string path = madeStore(folder);
  const std::string whole = bytesOf(path);
  const std::size_t second = whole.find('\n', whole.find('\n') + 1) + 1;
  for (const std::size_t length : {second, second + 1, whole.size() - 1}) {
    folder.write("runs.jsonl", whole.substr(0, length));
    TuningStore store(path, data, classes);
    EXPECT_EQ(store.known(), 1u);
    store.add(withWeight(3.0), "07", randomResult(4));
    TuningStore again(path, data, classes);
    EXPECT_EQ(again.known(), 2u);
    expectSame(again.find(withWeight(1.0), "05"), randomResult(1));
    expectSame(again.find(withWeight(3.0), "07"), randomResult(4));
  }
  folder.write("runs.jsonl", whole.substr(0, 5)); // not even the first line
  EXPECT_EQ(TuningStore(path, data, classes).known(), 0u);
  EXPECT_EQ(TuningStore(path, data, classes).known(), 0u);
}

TEST(TuningStore, DamageIsNamedByItsLine)
{
  const TemporaryFolder folder;
  const std::string path = madeStore(folder);
  const std::string whole = bytesOf(path);
  const std::size_t second = whole.find('\n') + 1;
  for (const std::string& line :
       {std::string("nonsense"), std::string("{}"), std::string("[1, 2]"),
        std::string(R"({"parameters":{},"sequence":"05","at_depth":{"network":[1],)"
                    R"("fused":[],"refined":[]},"rendered":{"network":[],)"
                    R"("fused":[],"refined":[]}})"),
        std::string(R"({"parameters":{},"sequence":"05","at_depth":{"network":[9,1,5],)"
                    R"("fused":[],"refined":[]},"rendered":{"network":[],)"
                    R"("fused":[],"refined":[]}})")}) {
    folder.write("runs.jsonl",
                 whole.substr(0, second) + line + "\n" + whole.substr(second));
    EXPECT_EQ(
        thrownMessage<BadInputException>([&] { TuningStore(path, data, classes); }),
        path + " line 2: is no run of a search");
  }
  folder.write("runs.jsonl", "a text\n");
  EXPECT_EQ(thrownMessage<BadInputException>([&] { TuningStore(path, data, classes); }),
            path + " line 1: is no run of a search");
}

TEST(TuningStore, AFolderThatCannotBeWritten)
{
  thrownMessage<OutputException>(
      [] { TuningStore("/no/such/folder/runs.jsonl", data, classes); });
}

} // namespace pcl_semantic
