// SPDX-License-Identifier: BSD-3-Clause
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/evaluation/trajectory_error.h>

#include <gtest/gtest.h>

#include <cmath>

namespace {

using namespace pcl_semantic;

// A metre a pose along z, turning about y by an angle a pose.
Trajectory
drive(int poses, double metres, double turn)
{
  Eigen::Isometry3d step = Eigen::Isometry3d::Identity();
  step.linear() = Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitY()).toRotationMatrix();
  step.translation().z() = metres;
  Trajectory trajectory(1, Eigen::Isometry3d::Identity());
  while (int(trajectory.size()) < poses)
    trajectory.push_back(trajectory.back() * step);
  return trajectory;
}

TEST(KittiErrors, OfAScaleAreTheScale)
{
  const std::vector<SegmentErrors> errors =
      kittiErrors(drive(51, 1.0, 0.0), drive(51, 1.02, 0.0), {9.5, 19.5, 100.0});
  ASSERT_EQ(errors.size(), 4u);
  EXPECT_EQ(errors[0].length, 9.5);
  EXPECT_EQ(errors[0].segments, 41u); // 10 poses further, from 0 to 40
  EXPECT_NEAR(errors[0].translation, 0.02 * 10 / 9.5, 1e-9);
  EXPECT_NEAR(errors[0].rotation, 0.0, 1e-9);
  EXPECT_EQ(errors[1].segments, 31u);
  EXPECT_EQ(errors[2].segments, 0u);
  EXPECT_TRUE(std::isnan(errors[2].translation));
  EXPECT_EQ(errors[3].segments, 72u);
  EXPECT_NEAR(errors[3].translation,
              (41 * 0.02 * 10 / 9.5 + 31 * 0.02 * 20 / 19.5) / 72, 1e-9);
}

TEST(KittiErrors, OfATurnAreTheAngleByTheWay)
{
  const std::vector<SegmentErrors> errors =
      kittiErrors(drive(30, 1.0, 0.0), drive(30, 1.0, 1e-4), {9.5});
  EXPECT_NEAR(errors[0].rotation, 10 * 1e-4 / 9.5, 1e-9);
}

TEST(KittiErrors, DoNotSeeWhereAPathBegins)
{
  Trajectory moved = drive(30, 1.0, 0.01);
  Eigen::Isometry3d elsewhere(Eigen::AngleAxisd(1.0, Eigen::Vector3d::UnitX()));
  elsewhere.translation() << 5, 6, 7;
  for (Eigen::Isometry3d& pose : moved)
    pose = elsewhere * pose;
  const SegmentErrors all = kittiErrors(drive(30, 1.0, 0.01), moved, {5, 10}).back();
  EXPECT_LT(all.translation, 1e-9);
  EXPECT_LT(all.rotation, 1e-7);
}

TEST(KittiErrors, BeginAtEveryStep)
{
  const Trajectory path = drive(51, 1.0, 0.0);
  EXPECT_EQ(kittiErrors(path, path, {9.5}, 10).back().segments, 5u);
}

TEST(KittiErrors, RefuseWhatCannotBeCompared)
{
  const Trajectory path = drive(5, 1.0, 0.0);
  const auto refused = [](auto call) {
    thrownMessage<InvalidParameterException>(call);
  };
  refused([&] { kittiErrors(path, drive(4, 1.0, 0.0), {1.0}); });
  refused([&] { kittiErrors(path, path, {0.0}); });
  refused([&] { kittiErrors(path, path, {NAN}); });
  refused([&] { kittiErrors(path, path, {1.0}, 0); });
  refused([] { errorsFromStart({}, {}); });
}

TEST(AbsoluteErrors, FromTheStartGrowAndAlignedAreLess)
{
  const Trajectory truth = drive(11, 1.0, 0.0), longer = drive(11, 1.1, 0.0);
  const AbsoluteErrors start = errorsFromStart(truth, longer);
  EXPECT_NEAR(start.last, 1.0, 1e-9);
  EXPECT_NEAR(start.largest, 1.0, 1e-9);
  EXPECT_NEAR(start.mean, 0.5, 1e-9);
  EXPECT_NEAR(start.rms, std::sqrt(0.35), 1e-9);
  const AbsoluteErrors aligned = errorsAligned(truth, longer);
  EXPECT_NEAR(aligned.largest, 0.5, 1e-9); // the middles are brought together
  EXPECT_NEAR(aligned.mean, 0.1 * 30 / 11, 1e-9);
}

TEST(MatchByTime, LeavesOutWhatHasNoPartner)
{
  const Trajectory poses = drive(5, 1.0, 0.0);
  TimedTrajectory all, some;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    all.push_back({double(i), poses[i]});
    if (i % 2 == 0)
      some.push_back({double(i) + 0.01, poses[i]});
  }
  const MatchedTrajectories matched = matchByTime(all, some, 0.02);
  ASSERT_EQ(matched.first.size(), 3u);
  EXPECT_EQ(matched.first[1].matrix(), poses[2].matrix());
  EXPECT_EQ(matched.second[1].matrix(), poses[2].matrix());
  EXPECT_TRUE(matchByTime(all, some, 0.001).first.empty());
}

TEST(MatchByTime, TakesEveryPoseOnceThoughTheOtherFileIsDenser)
{
  TimedTrajectory dense(50), sparse(3); // 200 Hz and 10 Hz, not in step
  for (std::size_t i = 0; i < dense.size(); ++i) {
    dense[i].time = 0.005 * double(i);
    dense[i].pose.translation().x() = double(i);
  }
  for (std::size_t i = 0; i < sparse.size(); ++i) {
    sparse[i].time = 0.1 * double(i) + 0.002;
    sparse[i].pose.translation().x() = 20.0 * double(i);
  }
  for (const bool dense_first : {true, false}) {
    const MatchedTrajectories matched = dense_first ? matchByTime(dense, sparse, 0.01)
                                                    : matchByTime(sparse, dense, 0.01);
    ASSERT_EQ(matched.first.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i)
      EXPECT_EQ(matched.first[i].matrix(), matched.second[i].matrix());
  }
}

} // namespace
