// SPDX-License-Identifier: BSD-3-Clause
#include "support_points.h"
#include "core/parallel_guard.h"
#include "kernels/map_disparity.h"

#include <algorithm>
#include <cstdlib>
#include <limits>

namespace pcl_semantic {

namespace {

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

} // namespace

GradientImage::GradientImage(const cv::Mat& grey)
    : width_(grey.cols), height_(grey.rows),
      stride_((grey.cols + 15) / 16 * 16 + 2 * kernels::gradient_margin),
      horizontal_(std::size_t(stride_) * std::size_t(height_), 128),
      vertical_(horizontal_)
{
  const kernels::Descriptors& loops = kernels::descriptors(simdTier());
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
  kernels::descriptors(simdTier()).gather(from, count, row.data());
}

namespace {

constexpr int corner = 2; // four descriptors this far off make one of 9 x 9 pixels [px]
constexpr int neighbourhood = 25; // where others have to be like it [px]
constexpr int none = kernels::no_disparity;

// Costs have 15 bits: signed ones are what every processor finds the least of.
int
leastOf(const std::uint16_t* costs, int count)
{
  std::int16_t least = std::numeric_limits<std::int16_t>::max();
  for (int i = 0; i < count; ++i)
    least = std::min(least, std::int16_t(costs[i]));
  return least;
}

/** \brief Looks for the support points of one row of the grid. */
class RowMatcher {
public:
  RowMatcher(const GradientImage& left, const GradientImage& right,
             const Elas::Parameters& parameters)
      : left_(left), right_(right), parameters_(parameters),
        loops_(kernels::descriptors(simdTier())),
        costs_(std::size_t(parameters.disparities))
  {}

  void
  setRow(int v)
  {
    left_.describeRow(v - corner, rows_[0][0]);
    left_.describeRow(v + corner, rows_[0][1]);
    right_.describeRow(v - corner, rows_[1][0]);
    right_.describeRow(v + corner, rows_[1][1]);
  }

  /** \brief Disparity of a pixel of the left image [1 / disparity_steps px], or none.
   */
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
    const int tolerance = int(parameters_.support_tolerance * kernels::disparity_steps);
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
    return sum >= parameters_.support_texture * 4 * kernels::descriptor_bytes;
  }

  /** \brief Best disparity of a pixel of an image (0 left, 1 right), if it stands out.
   */
  int
  search(int image, int u)
  {
    const int reach = image == 0 ? u + 1 : left_.width() - u;
    const int count = std::min(parameters_.disparities, reach);
    const int padded = (count + 7) / 8 * 8;
    std::fill(costs_.begin(), costs_.end(), std::uint16_t(0));
    // In the order of the pixels of the other image.
    const int first = image == 0 ? u - padded + 1 : u;
    for (int row = 0; row < 2; ++row)
      for (const int side : {-corner, corner})
        loops_.addDistances(at(image, row, u + side), at(1 - image, row, first + side),
                            padded, costs_.data());
    // What lies beyond the image is no candidate.
    std::uint16_t* const costs = costs_.data();
    if (image == 0)
      std::fill(costs, costs + (padded - count), kernels::no_energy);
    else
      std::fill(costs + count, costs + padded, kernels::no_energy);
    const int here = leastOf(costs, padded);
    const int index = int(std::find(costs, costs + padded, here) - costs);
    const int best = image == 0 ? padded - 1 - index : index;
    int less = kernels::no_energy, more = kernels::no_energy; // at best - 1 and + 1
    for (const int side : {-1, 1})
      if (index + side >= 0 && index + side < padded) {
        ((image == 0) == (side > 0) ? less : more) = costs[index + side];
        costs[index + side] = kernels::no_energy;
      }
    costs[index] = kernels::no_energy;
    if (here >= parameters_.tau * leastOf(costs, padded))
      return none;
    int fraction = 0;
    if (best > 0 && best + 1 < count && less > here && more > here)
      fraction = kernels::disparity_steps * (less - more) /
                 (2 * (std::max(less, more) - here));
    return best * kernels::disparity_steps + fraction;
  }

  const GradientImage &left_, &right_;
  const Elas::Parameters& parameters_;
  const kernels::Descriptors& loops_;
  std::vector<std::uint8_t> rows_[2][2]; // of image, above and below
  std::vector<std::uint16_t> costs_;
};

/** \brief What was matched at the pixels of the grid. */
struct SupportGrid {
  int columns, rows;
  std::vector<int> disparities;

  int
  at(int column, int row) const
  {
    return disparities[std::size_t(row * columns + column)];
  }
};

SupportGrid
matchGrid(const GradientImage& left, const GradientImage& right,
          const Elas::Parameters& parameters)
{
  const int step = parameters.support_step;
  SupportGrid grid{
      (left.width() + step - 1) / step, (left.height() + step - 1) / step, {}};
  grid.disparities.assign(std::size_t(grid.columns * grid.rows), none);
  ParallelGuard guard;
#pragma omp parallel
  guard.run([&] {
    RowMatcher matcher(left, right, parameters);
#pragma omp for schedule(dynamic)
    for (int row = 1; row < grid.rows; ++row)
      guard.run([&] {
        matcher.setRow(row * step);
        for (int column = 1; column < grid.columns; ++column)
          grid.disparities[std::size_t(row * grid.columns + column)] =
              matcher.match(column * step);
      });
  });
  guard.rethrow();
  return grid;
}

/** \brief Without points that too few of those around them are like. */
SupportGrid
plausible(const SupportGrid& grid, const Elas::Parameters& parameters)
{
  const int reach = neighbourhood / parameters.support_step;
  constexpr int alike = 5 * kernels::disparity_steps;
  SupportGrid result = grid;
  for (int row = 0; row < grid.rows; ++row)
    for (int column = 0; column < grid.columns; ++column) {
      const int disparity = grid.at(column, row);
      if (disparity == none)
        continue;
      int count = -1; // itself
      for (int y = std::max(row - reach, 0); y <= std::min(row + reach, grid.rows - 1);
           ++y)
        for (int x = std::max(column - reach, 0);
             x <= std::min(column + reach, grid.columns - 1); ++x)
          count +=
              grid.at(x, y) != none && std::abs(grid.at(x, y) - disparity) <= alike;
      if (count < parameters.support_neighbours)
        result.disparities[std::size_t(row * grid.columns + column)] = none;
    }
  return result;
}

} // namespace

std::vector<SupportPoint>
findSupportPoints(const GradientImage& left, const GradientImage& right,
                  const Elas::Parameters& parameters)
{
  const SupportGrid grid = plausible(matchGrid(left, right, parameters), parameters);
  std::vector<SupportPoint> points;
  for (int row = 0; row < grid.rows; ++row)
    for (int column = 0; column < grid.columns; ++column)
      if (grid.at(column, row) != none)
        points.push_back({column * parameters.support_step,
                          row * parameters.support_step, grid.at(column, row)});
  return points;
}

void
addCorners(int width, int height, std::vector<SupportPoint>& points)
{
  const std::size_t count = points.size();
  for (const int v : {0, height - 1})
    for (const int u : {0, width - 1}) {
      long best = -1;
      SupportPoint added{u, v, 0};
      for (std::size_t i = 0; i < count; ++i) {
        const long du = points[i].u - u, dv = points[i].v - v;
        if (best < 0 || du * du + dv * dv < best) {
          best = du * du + dv * dv;
          added.disparity = points[i].disparity;
        }
      }
      if (best != 0)
        points.push_back(added);
    }
}

} // namespace pcl_semantic
