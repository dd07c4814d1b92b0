// SPDX-License-Identifier: BSD-3-Clause
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/dataset/frame_grabber.h>

#include <gtest/gtest.h>

#include <deque>
#include <stdexcept>

namespace pcl_semantic {

namespace {

constexpr std::chrono::seconds soon(10); // within it everything happens at once

// A camera whose pairs arrive on the test's command.
struct Script {
  std::mutex mutex;
  std::condition_variable changed;
  std::deque<int> coming; // numbers; -1 = the camera breaks
  int grabbed = 0;        // pairs
  int decoded = 0;
  bool is_over = false;
  int damaged = -1; // this pair

  void
  send(const std::vector<int>& numbers)
  {
    std::unique_lock<std::mutex> lock(mutex);
    coming.insert(coming.end(), numbers.begin(), numbers.end());
    changed.wait_for(lock, soon, [&] { return coming.empty(); });
    EXPECT_TRUE(coming.empty());
  }

  void
  end()
  {
    const std::lock_guard<std::mutex> lock(mutex);
    is_over = true;
  }
};

class ScriptedCamera : public LiveCamera {
public:
  explicit ScriptedCamera(Script& script) : script_(script) {}

  int
  grab() override
  {
    const std::lock_guard<std::mutex> lock(script_.mutex);
    if (script_.coming.empty())
      return 0;
    number_ = script_.coming.front();
    script_.coming.pop_front();
    script_.changed.notify_all();
    if (number_ < 0)
      throw std::runtime_error("the camera is gone");
    return 1;
  }

  bool
  hasEnded() const override
  {
    const std::lock_guard<std::mutex> lock(script_.mutex);
    return script_.is_over && script_.coming.empty();
  }

  SensorFrame
  retrieve() override
  {
    ++script_.decoded;
    if (number_ == script_.damaged)
      throw BadInputException("pair " + std::to_string(number_) + " is damaged");
    StereoFrame frame;
    frame.number = number_;
    return frame;
  }

private:
  Script& script_;
  int number_ = 0;
};

class Grabber : public testing::Test {
protected:
  // The number of the newest pair.
  int
  take()
  {
    const auto grabbed = grabber.take(soon);
    return grabbed ? timeOf(grabbed->frame).number : -1;
  }

  Script script;
  FrameGrabber grabber{std::make_unique<ScriptedCamera>(script)};
};

} // namespace

TEST_F(Grabber, GivesTheNewestPairAndCountsTheOthers)
{
  EXPECT_FALSE(grabber.take(std::chrono::milliseconds(1)));
  script.send({7});
  EXPECT_EQ(take(), 7);
  EXPECT_EQ(grabber.dropped(), 0);
  script.send({8, 9, 12, 13});
  EXPECT_EQ(take(), 13);
  EXPECT_EQ(grabber.dropped(), 3);
  EXPECT_EQ(script.decoded, 2); // dropped pairs cost nothing
  EXPECT_FALSE(grabber.take(std::chrono::milliseconds(1)));
  EXPECT_FALSE(grabber.hasEnded());
}

TEST_F(Grabber, TheLastPairIsNotLostAtTheEnd)
{
  script.send({1, 2, 3});
  script.end();
  EXPECT_EQ(take(), 3);
  EXPECT_TRUE(grabber.hasEnded());
  EXPECT_FALSE(grabber.take(soon)); // at once
  EXPECT_EQ(grabber.dropped(), 2);
}

TEST_F(Grabber, ADamagedPairIsToldAndTheNextComes)
{
  script.damaged = 4;
  script.send({4});
  EXPECT_EQ(thrownMessage<BadInputException>([&] { take(); }), "pair 4 is damaged");
  script.send({5});
  EXPECT_EQ(take(), 5);
}

TEST_F(Grabber, ACameraThatBreaksEndsItAndSaysWhy)
{
  script.send({-1});
  EXPECT_EQ(thrownMessage<std::runtime_error>([&] { take(); }), "the camera is gone");
  EXPECT_FALSE(grabber.take(soon));
  EXPECT_TRUE(grabber.hasEnded());
}

} // namespace pcl_semantic
