#include "blended_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace example {

using palpate::elasticity::Body;
using palpate::elasticity::StepReport;
using palpate::elasticity::StepStatus;

namespace {

double distance_from(const std::vector<int>& nodes, const Eigen::Matrix3Xd& rest, int node) {
  double least = std::numeric_limits<double>::infinity();
  for (const int other : nodes) least = std::min(least, (rest.col(other) - rest.col(node)).norm());
  return least;
}

}  // namespace

palpate::config::OptionTable<BlendedModel::Options> BlendedModel::table() {
  return palpate::config::OptionTable<Options>().number(
      "power", "", "of the share by which a node follows the hand", {0.1, 10}, &Options::power);
}

BlendedModel::BlendedModel(const Options& options, const Body& body)
    : options_(options), body_(body) {
  if (body.fixed_nodes.empty() || body.grasps.empty())
    throw std::invalid_argument("needs an object that is fixed and that a hand holds");
  const Eigen::Matrix3Xd& rest = body.mesh.nodes;
  for (int i = 0; i < rest.cols(); ++i) {
    const double fixed = distance_from(body.fixed_nodes, rest, i);
    const double held = distance_from(body.grasps[0].nodes, rest, i);
    shares_.push_back(std::pow(fixed / (fixed + held), options.power));
  }
}

void BlendedModel::prepare() {
  held_ = false;
  const Eigen::Index rows = body_.mesh.nodes.size();
  palpate::elasticity::Sensitivity& s = sensitivity_;
  s.dx_dparameter.setZero(rows, 3);
  for (auto& by_force : s.dx_dforce) by_force.setZero(rows, 3);
  for (int a = 0; a < 2; ++a) {
    s.dx_dxi[a].setZero(rows, 6);
    s.dw_dparameter[a].setZero();
    for (auto& by_motion : s.dw_dxi[a]) by_motion.setZero();
    for (auto& by_force : s.dw_dforce[a]) by_force.setZero();
  }
}

void BlendedModel::hold(int grasp, const palpate::math::Pose& X_OG) {
  if (grasp != 0) return;
  held_ = true;
  X_OG_ = X_OG;
}

void BlendedModel::release(int grasp) {
  if (grasp == 0) held_ = false;
}

StepReport BlendedModel::step(double dt, const Eigen::Matrix3Xd& /*loads*/, Nodes positions,
                              Nodes velocities) {
  const Eigen::Matrix3Xd& rest = body_.mesh.nodes;
  palpate::math::Pose motion = palpate::math::Pose::Identity();
  if (held_) motion = X_OG_ * body_.grasps[0].X_OG_rest.inverse();
  for (int i = 0; i < rest.cols(); ++i) {
    const Eigen::Vector3d moved = motion * rest.col(i);
    const Eigen::Vector3d to = rest.col(i) + shares_[i] * (moved - rest.col(i));
    velocities.col(i) = (to - positions.col(i)) / dt;
    positions.col(i) = to;
  }
  differentiate(positions);
  StepReport report;
  report.status = StepStatus::kConverged;
  return report;
}

/// d x / d xi = s [1, -[x - p_G]x] for the nodes' shares s.
void BlendedModel::differentiate(const Nodes& positions) {
  sensitivity_.valid = held_;
  const Eigen::Vector3d p_G = X_OG_.translation();
  for (int i = 0; i < positions.cols(); ++i) {
    auto rows = sensitivity_.dx_dxi[0].middleRows<3>(3 * i);
    rows.leftCols<3>() = shares_[i] * Eigen::Matrix3d::Identity();
    rows.rightCols<3>() = -shares_[i] * palpate::math::cross_matrix(positions.col(i) - p_G);
  }
}

}  // namespace example
