// SPDX-License-Identifier: BSD-3-Clause
#include "lbfgs.h"

#include <deque>

namespace pcl_semantic {

namespace {

constexpr std::size_t memory = 10; // number of stored steps

struct Step {
  Eigen::VectorXd move, change; // difference of positions, of gradients
};

// Approximate inverse Hessian of the last steps, times the gradient.
Eigen::VectorXd
directionOf(const std::deque<Step>& steps, const Eigen::VectorXd& gradient)
{
  Eigen::VectorXd direction = gradient;
  std::vector<double> fractions(steps.size());
  for (std::size_t i = steps.size(); i-- > 0;) {
    fractions[i] = steps[i].move.dot(direction) / steps[i].move.dot(steps[i].change);
    direction -= fractions[i] * steps[i].change;
  }
  if (!steps.empty())
    direction *=
        steps.back().move.dot(steps.back().change) / steps.back().change.squaredNorm();
  for (std::size_t i = 0; i < steps.size(); ++i)
    direction +=
        steps[i].move * (fractions[i] - steps[i].change.dot(direction) /
                                            steps[i].move.dot(steps[i].change));
  return direction;
}

} // namespace

Eigen::VectorXd
minimizeConvex(
    const std::function<double(const Eigen::VectorXd&, Eigen::VectorXd&)>& function,
    Eigen::VectorXd position, int iterations, double tolerance)
{
  constexpr double decrease = 1e-4; // fraction of the decrease predicted by the slope
  Eigen::VectorXd gradient(position.size()), next_gradient(position.size());
  double value = function(position, gradient);
  std::deque<Step> steps;
  for (int i = 0; i < iterations; ++i) {
    if (!(gradient.cwiseAbs().maxCoeff() > tolerance))
      break;
    const Eigen::VectorXd direction = directionOf(steps, gradient);
    const double slope = direction.dot(gradient);
    double length = steps.empty() ? 1.0 / gradient.norm() : 1.0;
    Eigen::VectorXd next = position - length * direction;
    double next_value = function(next, next_gradient);
    while (!(next_value <= value - decrease * length * slope) && length > 1e-12) {
      length *= 0.5;
      next = position - length * direction;
      next_value = function(next, next_gradient);
    }
    if (!(next_value < value))
      break; // at rounding precision
    Step step{next - position, next_gradient - gradient};
    if (step.move.dot(step.change) > 0.0)
      steps.push_back(std::move(step));
    if (steps.size() > memory)
      steps.pop_front();
    position = std::move(next);
    gradient = next_gradient;
    value = next_value;
  }
  return position;
}

} // namespace pcl_semantic
