// SPDX-License-Identifier: BSD-3-Clause
#include "support_points.h"
#include "parallel_bands.h"

#include <algorithm>
#include <cstdlib>
#include <limits>

namespace pcl_semantic {

namespace {

// Byte of a descriptor: the vertical or horizontal gradient at an offset from the
// pixel.
struct Element {
  bool vertical;
  int u, v;
};

constexpr Element elements[kernels::descriptor_bytes] = {
    {false, -2, -2}, {false, 0, -2}, {false, 2, -2}, {false, -1, -1},
    {false, 1, -1},  {false, -2, 0}, {false, 0, 0},  {false, 2, 0},
    {false, -1, 1},  {false, 1, 1},  {false, -2, 2}, {false, 0, 2},
    {false, 2, 2},   {false, -1, 0}, {false, 1, 0},  {true, 0, 0},
};

// Offset in u and v [px] of the four descriptors by which a pixel is matched. Together
// they cover 9 x 9 pixels.
constexpr int corner = 2;
constexpr int grid_step = 5;      // between matched pixels [px]
constexpr int min_texture = 1;    // mean absolute gradient [0-127]
constexpr double max_ratio = 0.9; // tau: a match is distinctive if its cost is below
                                  // this fraction of the second-best cost
constexpr int tolerance = kernels::disparity_steps; // left-right check: 1 px
// Largest offset of a similar point in u and v [px].
constexpr int neighbourhood = 25;
constexpr int min_neighbours = 2; // similar points required for a plausible point
constexpr int alike = 5 * kernels::disparity_steps; // similar points: within 5 px
constexpr int none = kernels::no_disparity;

// Costs have 15 bits, so a signed minimum gives the same result as an unsigned one.
// Every processor has an instruction for the signed minimum.
int
leastOf(const std::uint16_t* costs, int count)
{
  std::int16_t least = std::numeric_limits<std::int16_t>::max();
  for (int i = 0; i < count; ++i)
    least = std::min(least, std::int16_t(costs[i]));
  return least;
}

/** \brief Matches the pixels of one row of the grid. */
class RowMatcher {
public:
  RowMatcher(const GradientImage& left, const GradientImage& right, int disparities)
      : images_{&left, &right}, disparities_(disparities),
        costs_(std::size_t(disparities))
  {}

  void
  setRow(int v)
  {
    for (int image = 0; image < 2; ++image) {
      images_[image]->describeRow(v - corner, rows_[image][0]);
      images_[image]->describeRow(v + corner, rows_[image][1]);
    }
  }

  int
  match(int u)
  {
    if (!hasTexture(u))
      return none;
    const int found = search(0, u);
    if (found == none)
      return none;
    const int d = (found + kernels::disparity_steps / 2) / kernels::disparity_steps;
    const int back = search(1, u - d);
    return back != none && std::abs(back - found) <= tolerance ? found : none;
  }

private:
  const std::uint8_t*
  at(int image, int row, int u) const
  {
    return GradientImage::firstPixel(rows_[image][row]) + u * kernels::descriptor_bytes;
  }

  bool
  hasTexture(int u) const
  {
    int sum = 0;
    for (int row = 0; row < 2; ++row)
      for (const int side : {-corner, corner})
        for (int i = 0; i < kernels::descriptor_bytes; ++i)
          sum += std::abs(at(0, row, u + side)[i] - 128);
    return sum >= min_texture * 4 * kernels::descriptor_bytes;
  }

  /** \brief Best disparity of a pixel; none if its cost is not distinctive.
   * \param[in] image image of the pixel: 0 = left, 1 = right
   * \param[in] u column of the pixel [px] */
  int
  search(int image, int u)
  {
    const int reach = image == 0 ? u + 1 : images_[0]->width() - u;
    const int count = std::min(disparities_, reach);
    const int padded = (count + 7) / 8 * 8;
    std::fill(costs_.begin(), costs_.end(), std::uint16_t(0));
    // Costs are in the order of the columns of the other image. For a pixel of the left
    // image, this is the order of descending disparities.
    const int first = image == 0 ? u - padded + 1 : u;
    for (int row = 0; row < 2; ++row)
      for (const int side : {-corner, corner})
        loops_.addDistances(at(image, row, u + side), at(1 - image, row, first + side),
                            padded, costs_.data());
    // Columns outside the image are no candidates.
    std::uint16_t* const costs = costs_.data();
    if (image == 0)
      std::fill(costs, costs + (padded - count), kernels::no_energy);
    else
      std::fill(costs + count, costs + padded, kernels::no_energy);
    const int here = leastOf(costs, padded);
    const int index = int(std::find(costs, costs + padded, here) - costs);
    const int best = image == 0 ? padded - 1 - index : index;
    // Costs at the disparities best - 1 and best + 1.
    int less = kernels::no_energy, more = kernels::no_energy;
    for (const int side : {-1, 1})
      if (index + side >= 0 && index + side < padded) {
        ((image == 0) == (side > 0) ? less : more) = costs[index + side];
        costs[index + side] = kernels::no_energy;
      }
    costs[index] = kernels::no_energy;
    if (here >= max_ratio * leastOf(costs, padded))
      return none;
    int fraction = 0;
    if (best > 0 && best + 1 < count && less > here && more > here)
      fraction = kernels::disparity_steps * (less - more) /
                 (2 * (std::max(less, more) - here));
    return best * kernels::disparity_steps + fraction;
  }

  const GradientImage* images_[2];
  int disparities_;
  const kernels::ElasLoops& loops_ = kernels::elasLoops(simdTier());
  std::vector<std::uint8_t> rows_[2][2]; // by image: the row above and the row below
  std::vector<std::uint16_t> costs_;
};

/** \brief Disparities of the pixels (column, row) * grid_step. */
cv::Mat1i
matchGrid(const GradientImage& left, const GradientImage& right, int disparities)
{
  cv::Mat1i grid((left.height() + grid_step - 1) / grid_step,
                 (left.width() + grid_step - 1) / grid_step, none);
  forBandsOfRows(
      grid.rows, 1, [&] { return RowMatcher(left, right, disparities); },
      [&](RowMatcher& matcher, int row, int) {
        if (row == 0)
          return;
        matcher.setRow(row * grid_step);
        for (int column = 1; column < grid.cols; ++column)
          grid(row, column) = matcher.match(column * grid_step);
      });
  return grid;
}

/** \brief Whether a point has enough similar neighbours. */
bool
isPlausible(const cv::Mat1i& grid, int row, int column)
{
  constexpr int reach = neighbourhood / grid_step;
  int count = -1; // without the point itself
  for (int y = std::max(row - reach, 0); y <= std::min(row + reach, grid.rows - 1); ++y)
    for (int x = std::max(column - reach, 0);
         x <= std::min(column + reach, grid.cols - 1); ++x)
      count += grid(y, x) != none && std::abs(grid(y, x) - grid(row, column)) <= alike;
  return count >= min_neighbours;
}

} // namespace

GradientImage::GradientImage(const cv::Mat& grey)
    : width_(grey.cols), height_(grey.rows),
      stride_((grey.cols + 15) / 16 * 16 + 2 * kernels::gradient_margin),
      horizontal_(std::size_t(stride_) * std::size_t(height_), 128),
      vertical_(horizontal_)
{
  const kernels::ElasLoops& loops = kernels::elasLoops(simdTier());
#pragma omp parallel for schedule(static)
  for (int v = 0; v < height_; ++v) {
    const std::size_t at =
        std::size_t(v) * std::size_t(stride_) + kernels::gradient_margin;
    loops.gradients(grey.ptr(std::max(v - 1, 0)), grey.ptr(v),
                    grey.ptr(std::min(v + 1, height_ - 1)), width_,
                    horizontal_.data() + at, vertical_.data() + at);
  }
}

void
GradientImage::describeRow(int v, std::vector<std::uint8_t>& row) const
{
  constexpr int margin = kernels::descriptor_margin;
  const int count = stride_ - 2 * kernels::gradient_margin + 2 * margin;
  row.resize(std::size_t(count) * kernels::descriptor_bytes);
  const std::uint8_t* from[kernels::descriptor_bytes];
  for (int i = 0; i < kernels::descriptor_bytes; ++i) {
    const Element& element = elements[i];
    const int line = std::clamp(v + element.v, 0, height_ - 1);
    from[i] = (element.vertical ? vertical_ : horizontal_).data() +
              std::size_t(line) * std::size_t(stride_) + kernels::gradient_margin -
              margin + element.u;
  }
  kernels::elasLoops(simdTier()).gather(from, count, row.data());
}

std::vector<SupportPoint>
findSupportPoints(const GradientImage& left, const GradientImage& right,
                  int disparities)
{
  const cv::Mat1i grid = matchGrid(left, right, disparities);
  std::vector<SupportPoint> points;
  for (int row = 0; row < grid.rows; ++row)
    for (int column = 0; column < grid.cols; ++column)
      if (grid(row, column) != none && isPlausible(grid, row, column))
        points.push_back({column * grid_step, row * grid_step, grid(row, column)});
  return points;
}

void
addCorners(int width, int height, std::vector<SupportPoint>& points)
{
  const auto count = std::ptrdiff_t(points.size());
  for (const int v : {0, height - 1})
    for (const int u : {0, width - 1}) {
      const auto squaredDistance = [&](const SupportPoint& point) {
        const long du = point.u - u, dv = point.v - v;
        return du * du + dv * dv;
      };
      const SupportPoint nearest =
          *std::min_element(points.begin(), points.begin() + count,
                            [&](const SupportPoint& a, const SupportPoint& b) {
                              return squaredDistance(a) < squaredDistance(b);
                            });
      if (squaredDistance(nearest) != 0)
        points.push_back({u, v, nearest.disparity});
    }
}

} // namespace pcl_semantic
