// SPDX-License-Identifier: BSD-3-Clause
#include "support/thrown_message.h"

#include <pcl_semantic/dataset/undistorter.h>

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include <cmath>

namespace pcl_semantic {

namespace {

const PinholeCamera fisheye{
    190, 191, 158, 119, 0, 0, "fisheye.yaml", "", {}, {0.01, -0.005, 0.002, -0.0005},
    true};
const PinholeCamera radial{
    300, 301, 158, 119, 0, 0, "radial.yaml", "", {}, {-0.28, 0.07, 0.0002, 0.00002}};

// Where a lens shows a ray, from the models' formulas.
Eigen::Vector2d
projected(const PinholeCamera& camera, double x, double y)
{
  const std::vector<double>& D = camera.distortion;
  const double r = std::hypot(x, y), r2 = r * r;
  Eigen::Vector2d place;
  if (camera.is_fisheye) { // Kannala and Brandt
    const double a = std::atan(r), a2 = a * a;
    const double distorted =
        a * (1 + a2 * (D[0] + a2 * (D[1] + a2 * (D[2] + a2 * D[3]))));
    place = Eigen::Vector2d(x, y) * (r > 0 ? distorted / r : 1.0);
  }
  else { // Brown
    const double scale = 1 + r2 * (D[0] + r2 * D[1]);
    place << x * scale + 2 * D[2] * x * y + D[3] * (r2 + 2 * x * x),
        y * scale + D[2] * (r2 + 2 * y * y) + 2 * D[3] * x * y;
  }
  return {camera.fx * place.x() + camera.cx, camera.fy * place.y() + camera.cy};
}

} // namespace

// Images whose values are their columns and rows show where each pixel comes from.
TEST(Undistorter, APixelComesFromWhereTheLensShowsItsRay)
{
  const int width = 320, height = 240, unit = 64;
  cv::Mat1w columns(height, width), rows(height, width);
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u) {
      columns(v, u) = std::uint16_t(unit * u);
      rows(v, u) = std::uint16_t(unit * v);
    }
  for (const PinholeCamera& lens : {fisheye, radial}) {
    const Undistorter undistorter(lens, width, height, "0.png");
    EXPECT_TRUE(undistorter.isDistorted());
    const StereoCamera& camera = undistorter.camera();
    EXPECT_EQ(camera.width, width);
    const cv::Mat1w x = undistorter.undistort(columns), y = undistorter.undistort(rows);
    const cv::Mat1w x_nearest = undistorter.undistortNearest(columns),
                    y_nearest = undistorter.undistortNearest(rows);
    int outside = 0;
    for (int v = 1; v + 1 < height; ++v)
      for (int u = 1; u + 1 < width; ++u) {
        const Eigen::Vector2d expected =
            projected(lens, (u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy);
        if (!(expected.x() > 1 && expected.x() < width - 2 && expected.y() > 1 &&
              expected.y() < height - 2)) {
          ++outside;
          continue;
        }
        const auto expectNear = [&](double found, double place, double within) {
          EXPECT_NEAR(found / unit, place, within) << u << " " << v;
        };
        expectNear(x(v, u), expected.x(), 0.05); // fractions are 1/32 px
        expectNear(y(v, u), expected.y(), 0.05);
        expectNear(x_nearest(v, u), expected.x(), 0.54);
        expectNear(y_nearest(v, u), expected.y(), 0.54);
        EXPECT_EQ(x_nearest(v, u) % unit, 0);
      }
    EXPECT_LT(outside, width * height / 50) << "no black borders";
  }
}

TEST(Undistorter, WithoutDistortionImagesStayAsTheyAre)
{
  const Undistorter undistorter({300, 301, 3, 2}, 6, 4, "0.png");
  EXPECT_FALSE(undistorter.isDistorted());
  EXPECT_EQ(undistorter.camera().fy, 301.0);
  const cv::Mat1b image(4, 6, std::uint8_t(7));
  EXPECT_EQ(cv::countNonZero(undistorter.undistort(image) != image), 0);
  expectBadParameter("image has 5 x 4 pixels, expected 6 x 4 as the camera",
                     [&] { undistorter.undistort(cv::Mat1b(4, 5)); });
}

TEST(Undistorter, ALensThatFoldsTheImageIsRefused)
{
  PinholeCamera folded = radial;
  folded.distortion = {5.0, -30.0, 0, 0};
  expectBadInput("radial.yaml: ", [&] { Undistorter(folded, 320, 240, "0.png"); });
  folded.distortion = {0.1, 0.2, 0.3};
  expectBadParameter("has 3 distortion coefficients, expected 0, 4, 5, 8, 12 or 14",
                     [&] { folded.validate(); });
  folded.distortion = {0.1, 0.2, 0.3, std::nan("")};
  expectBadParameter("a distortion coefficient is not finite",
                     [&] { folded.validate(); });
}

} // namespace pcl_semantic
