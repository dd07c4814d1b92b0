// SPDX-License-Identifier: BSD-3-Clause
#include "delaunay.h"

#include <cstdint>

namespace pcl_semantic {

namespace {

/** \brief The paper's edges without the dual: edge e and its reverse e ^ 1, each in a
 * ring of the edges from the same origin, counterclockwise (if u points right and v
 * up). */
class Subdivision {
public:
  explicit Subdivision(const std::vector<GridPoint>& points) : points_(points)
  {
    edges_.reserve(6 * points.size());
  }

  /** \brief Triangulates points [begin, end), at least two.
   * \return edges of the hull: counterclockwise from the first point, clockwise from
   * the last */
  std::array<int, 2>
  triangulate(int begin, int end)
  {
    if (end - begin == 2) {
      const int edge = makeEdge(begin, begin + 1);
      return {edge, reverse(edge)};
    }
    if (end - begin == 3)
      return triangulateThree(begin);
    const int middle = (begin + end) / 2;
    const auto [outer_left, inner_left] = triangulate(begin, middle);
    const auto [inner_right, outer_right] = triangulate(middle, end);
    return merge(outer_left, inner_left, inner_right, outer_right);
  }

  std::vector<std::array<int, 3>>
  triangles() const
  {
    std::vector<std::array<int, 3>> result;
    result.reserve(2 * points_.size());
    for (int e = 0; e < int(edges_.size()); ++e) {
      if (edges_[std::size_t(e)].next < 0)
        continue;
      const int f = leftNext(e), g = leftNext(f);
      if (e < f && e < g && leftNext(g) == e &&
          side(origin(e), origin(f), origin(g)) > 0)
        result.push_back({origin(e), origin(f), origin(g)});
    }
    return result;
  }

private:
  struct Edge {
    int origin;
    int next, previous; // of the ring; next < 0: deleted
  };

  static int
  reverse(int edge)
  {
    return edge ^ 1;
  }

  int
  origin(int edge) const
  {
    return edges_[std::size_t(edge)].origin;
  }

  int
  target(int edge) const
  {
    return origin(reverse(edge));
  }

  int
  next(int edge) const
  {
    return edges_[std::size_t(edge)].next;
  }

  int
  previous(int edge) const
  {
    return edges_[std::size_t(edge)].previous;
  }

  /** \brief The next edge around the left face. */
  int
  leftNext(int edge) const
  {
    return previous(reverse(edge));
  }

  int
  makeEdge(int from, int to)
  {
    const int edge = int(edges_.size());
    edges_.push_back({from, edge, edge});
    edges_.push_back({to, edge + 1, edge + 1});
    return edge;
  }

  void
  splice(int a, int b)
  {
    const int after_a = next(a), after_b = next(b);
    edges_[std::size_t(a)].next = after_b;
    edges_[std::size_t(b)].next = after_a;
    edges_[std::size_t(after_b)].previous = a;
    edges_[std::size_t(after_a)].previous = b;
  }

  /** \brief Adds an edge from the target of \a a to the origin of \a b, both on the
   * same left face. */
  int
  connect(int a, int b)
  {
    const int edge = makeEdge(target(a), origin(b));
    splice(edge, leftNext(a));
    splice(reverse(edge), b);
    return edge;
  }

  void
  remove(int edge)
  {
    splice(edge, previous(edge));
    splice(reverse(edge), previous(reverse(edge)));
    edges_[std::size_t(edge)].next = -1;
    edges_[std::size_t(reverse(edge))].next = -1;
  }

  /** \brief Positive if a, b, c turn left. */
  std::int64_t
  side(int a, int b, int c) const
  {
    const GridPoint &p = points_[std::size_t(a)], &q = points_[std::size_t(b)],
                    &r = points_[std::size_t(c)];
    return std::int64_t(q.u - p.u) * (r.v - p.v) -
           std::int64_t(q.v - p.v) * (r.u - p.u);
  }

  bool
  isLeft(int point, int edge) const
  {
    return side(point, origin(edge), target(edge)) > 0;
  }

  bool
  isRight(int point, int edge) const
  {
    return side(point, target(edge), origin(edge)) > 0;
  }

  /** \brief Whether d lies inside the circle through a, b, c, which turn left. */
  bool
  inCircle(int a, int b, int c, int d) const
  {
    const GridPoint& s = points_[std::size_t(d)];
    const auto row = [&](int i) {
      const GridPoint& p = points_[std::size_t(i)];
      const std::int64_t u = p.u - s.u, v = p.v - s.v;
      return std::array<std::int64_t, 3>{u, v, u * u + v * v};
    };
    const auto p = row(a), q = row(b), r = row(c);
    return p[2] * (q[0] * r[1] - q[1] * r[0]) - q[2] * (p[0] * r[1] - p[1] * r[0]) +
               r[2] * (p[0] * q[1] - p[1] * q[0]) >
           0;
  }

  std::array<int, 2>
  triangulateThree(int first)
  {
    const int a = makeEdge(first, first + 1);
    const int b = makeEdge(first + 1, first + 2);
    splice(reverse(a), b);
    const std::int64_t turn = side(first, first + 1, first + 2);
    if (turn == 0)
      return {a, reverse(b)};
    const int c = connect(b, a);
    if (turn > 0)
      return {a, reverse(b)};
    return {reverse(c), c};
  }

  std::array<int, 2>
  merge(int outer_left, int inner_left, int inner_right, int outer_right)
  {
    for (;;) // finds the lowest edge between the two halves
      if (isLeft(origin(inner_right), inner_left))
        inner_left = leftNext(inner_left);
      else if (isRight(origin(inner_left), inner_right))
        inner_right = next(reverse(inner_right));
      else
        break;
    int base = connect(reverse(inner_right), inner_left);
    if (origin(inner_left) == origin(outer_left))
      outer_left = reverse(base);
    if (origin(inner_right) == origin(outer_right))
      outer_right = base;
    while (riseBase(base)) {
    }
    return {outer_left, outer_right};
  }

  /** \brief Adds the next triangle on the edge between the halves; false at the top. */
  bool
  riseBase(int& base)
  {
    int left = next(reverse(base));
    if (isRight(target(left), base))
      while (inCircle(target(base), origin(base), target(left), target(next(left)))) {
        const int after = next(left);
        remove(left);
        left = after;
      }
    int right = previous(base);
    if (isRight(target(right), base))
      while (inCircle(target(base), origin(base), target(right),
                      target(previous(right)))) {
        const int after = previous(right);
        remove(right);
        right = after;
      }
    const bool left_above = isRight(target(left), base);
    const bool right_above = isRight(target(right), base);
    if (!left_above && !right_above)
      return false;
    if (!left_above || (right_above && inCircle(target(left), origin(left),
                                                origin(right), target(right))))
      base = connect(right, reverse(base));
    else
      base = connect(reverse(base), reverse(left));
    return true;
  }

  const std::vector<GridPoint>& points_;
  std::vector<Edge> edges_;
};

} // namespace

std::vector<std::array<int, 3>>
triangulate(const std::vector<GridPoint>& points)
{
  if (points.size() < 3)
    return {};
  Subdivision subdivision(points);
  subdivision.triangulate(0, int(points.size()));
  return subdivision.triangles();
}

} // namespace pcl_semantic
