// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/fitted_window.h"

#include <gtest/gtest.h>

#include <limits>

namespace pcl_semantic {

namespace {

// A recording whose i-th frame has 2000 points at depth i + 1, the last one farther.
RecordedFrames
recordingOf(std::size_t frames, float last_depth, std::vector<std::size_t>& read)
{
  std::vector<FrameTime> times;
  for (std::size_t i = 0; i < frames; ++i)
    times.push_back({int(i), 0.1 * double(i)});
  FrameSensor sensor;
  sensor.has_depth = true;
  return {sensor, times, [&read, last_depth](std::size_t i) -> SensorFrame {
            read.push_back(i);
            RgbdFrame frame;
            frame.cloud = pcl::make_shared<pcl::PointCloud<pcl::PointXYZRGB>>();
            for (int k = 0; k < 2000; ++k) {
              pcl::PointXYZRGB point;
              point.z = k == 1999 ? last_depth : float(i + 1);
              frame.cloud->push_back(point);
            }
            return frame;
          }};
}

} // namespace

TEST(FittedWindow, ReachesNearlyAllDepthsOfFramesOverTheRecording)
{
  std::vector<std::size_t> read;
  RecordedFrames source = recordingOf(25, 60.0f, read); // an outlier
  EXPECT_EQ(reachOfDepths(source), 23.0);
  EXPECT_EQ(read, (std::vector<std::size_t>{0, 2, 5, 7, 10, 12, 15, 17, 20, 22}));
  source.next();
  EXPECT_EQ(read.back(), 0u);

  read.clear();
  RecordedFrames few = recordingOf(3, std::numeric_limits<float>::quiet_NaN(), read);
  EXPECT_EQ(reachOfDepths(few), 3.0);
  EXPECT_EQ(read, (std::vector<std::size_t>{0, 1, 2}));
}

TEST(FittedWindow, IsNoneWithoutDepths)
{
  RecordedFrames source({}, {{0, 0.0}}, [](std::size_t) -> SensorFrame {
    RgbdFrame frame;
    frame.cloud = pcl::make_shared<pcl::PointCloud<pcl::PointXYZRGB>>();
    return frame;
  });
  EXPECT_EQ(reachOfDepths(source), std::nullopt);
}

TEST(FittedWindow, HasTwoMetresAround)
{
  EXPECT_TRUE(windowOfReach(3.0, 40.0).isApprox(Eigen::Vector3d(10.0, 10.0, 10.0)));
  EXPECT_TRUE(windowOfReach(30.0, 5.0).isApprox(Eigen::Vector3d(14.0, 14.0, 14.0)));
  EXPECT_TRUE(windowOfReach(30.0, 40.0).isApprox(Eigen::Vector3d(64.0, 64.0, 24.0)));
}

} // namespace pcl_semantic
