// SPDX-License-Identifier: BSD-3-Clause
#include "support/stereo_rigs.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/labelling/carried_labels.h>

#include <gtest/gtest.h>

#include <limits>

namespace pcl_semantic {

namespace {

// A distribution of its own for each pixel.
LabelDistributions
distinctPixels(const StereoCamera& camera)
{
  const Eigen::Index pixels = Eigen::Index(camera.width) * camera.height;
  LabelDistributions image(3, pixels);
  for (Eigen::Index j = 0; j < pixels; ++j)
    image.matrix().col(j) =
        Eigen::Vector3f(1.0f, float(j), float(2 * j)) / float(1 + 3 * j);
  return image;
}

} // namespace

TEST(CarryLabels, APointHasTheLabelsOfItsPixel)
{
  const StereoCamera camera = smallCamera();
  const LabelDistributions image = distinctPixels(camera);
  const auto at = [&](int u, int v, double depth) {
    return camera.unproject(u, v, depth);
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const LabelDistributions points = carryLabels(
      image, camera,
      seenPoints({at(5, 7, 3.0), at(20, 11, 35.0), at(5, 7, -3.0), at(-3, 7, 5.0),
                  Eigen::Vector3d(nan, nan, nan), at(20, 11, 45.0), at(5, 7, 30.0)},
                 camera));
  ASSERT_EQ(points.size(), 7);
  EXPECT_EQ(points.matrix().col(0), image.matrix().col(7 * camera.width + 5));
  EXPECT_EQ(points.matrix().col(1), image.matrix().col(11 * camera.width + 20));
  // behind the camera, beside the image, nowhere, too far, hidden by the first
  for (int i = 2; i < 7; ++i)
    EXPECT_TRUE(points.matrix().col(i).isZero()) << i;
}

TEST(CarryLabels, RefusesAnotherImage)
{
  const StereoCamera camera = smallCamera();
  StereoCamera larger = camera;
  ++larger.width;
  const LabelDistributions image = distinctPixels(camera);
  expectBadParameter("pixels for an image of", [&] { carryLabels(image, larger, {}); });
  expectBadParameter("point 0 is seen outside", [&] {
    carryLabels(image, camera, {SeenPoint{0, camera.width, 1.0f}});
  });
  StereoCamera unsized = camera;
  unsized.width = 0;
  thrownMessage<InvalidParameterException>([&] { seenPoints({}, unsized); });
}

} // namespace pcl_semantic
