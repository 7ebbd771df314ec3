#include "tools/lab/baselines/sensing/bar_axis.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace palpate::baselines {

using Eigen::Vector3d;

BarAxis find_bar_axis(const elasticity::Body& body) {
  const Eigen::Matrix3Xd& nodes = body.mesh.nodes;
  const Vector3d lower = nodes.rowwise().minCoeff(), upper = nodes.rowwise().maxCoeff();
  const Vector3d size = upper - lower;
  BarAxis bar;
  bar.length = size.maxCoeff(&bar.axis);
  const double b = size[(bar.axis + 1) % 3], h = size[(bar.axis + 2) % 3];
  if (bar.length < 3 * std::max(b, h))
    throw std::invalid_argument("a model of beams wants a bar, at least thrice as long as wide");
  if (body.fixed_nodes.empty())
    throw std::invalid_argument("a model of beams wants a bar that is clamped at one end");
  bar.root = 0.5 * (lower + upper);
  double farthest_low = 0, farthest_high = 0;  // m, distance of fixed nodes from either end
  for (const int node : body.fixed_nodes) {
    farthest_low = std::max(farthest_low, nodes(bar.axis, node) - lower[bar.axis]);
    farthest_high = std::max(farthest_high, upper[bar.axis] - nodes(bar.axis, node));
  }
  if (std::min(farthest_low, farthest_high) > 0.3 * bar.length)
    throw std::invalid_argument("a model of beams wants a bar that is clamped at one end alone");
  bar.sign = farthest_low < farthest_high ? 1 : -1;
  const double clamp = std::min(farthest_low, farthest_high);
  bar.root[bar.axis] = bar.sign > 0 ? lower[bar.axis] + clamp : upper[bar.axis] - clamp;
  bar.length -= clamp;
  bar.area = b * h;
  bar.second_moment = {h * b * b * b / 12, b * h * h * h / 12};
  bar.s.resize(nodes.cols());
  bar.offset.resize(3, nodes.cols());
  for (Eigen::Index i = 0; i < nodes.cols(); ++i) {
    bar.offset.col(i) = nodes.col(i) - bar.root;
    bar.s[i] = bar.sign * bar.offset(bar.axis, i);
    bar.offset(bar.axis, i) = 0;
  }
  bar.free_length = bar.length;
  for (const elasticity::GraspRegion& grasp : body.grasps)
    for (const int node : grasp.nodes) bar.free_length = std::min(bar.free_length, bar.s[node]);
  if (!(bar.free_length > 0))
    throw std::invalid_argument("a model of beams wants a hand that does not reach the clamp");
  return bar;
}

}  // namespace palpate::baselines
