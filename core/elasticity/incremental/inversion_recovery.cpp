#include "core/elasticity/incremental/inversion_recovery.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate::elasticity {
namespace {

// Consecutive checks with a suspect shape before an alternative is tried; a single check with a
// tenth of the body inverted suffices.
constexpr int kPatience = 12;
constexpr int kHopelessShare = 10;
// Below this strain the shape is certainly valid. A shape is at rest if its energy changes by less
// than this fraction between two checks, and another one is better if its energy is lower by more.
constexpr double kSmallStrain = 0.1, kStill = 1e-3;

}  // namespace

RigidBlend::RigidBlend(const Body& body)
    : rest_(body.mesh.nodes),
      distance2_(Eigen::Matrix3Xd::Constant(3, rest_.cols(), std::numeric_limits<double>::max())) {
  const auto measure = [&](int row, const std::vector<int>& nodes) {
    for (int i = 0; i < rest_.cols(); ++i) {
      for (int node : nodes) {
        const double d = (rest_.col(i) - rest_.col(node)).squaredNorm();
        distance2_(row, i) = std::min(distance2_(row, i), d);
      }
    }
  };
  for (std::size_t g = 0; g < body.grasps.size(); ++g) {
    measure(static_cast<int>(g), body.grasps[g].nodes);
  }
  measure(2, body.fixed_nodes);
}

Eigen::Vector3d RigidBlend::position(int node, const std::array<bool, 2>& held,
                                     const std::array<math::Pose, 2>& motions) const noexcept {
  const Eigen::Vector3d at_rest = rest_.col(node);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double weights = 0;
  for (int k = 0; k < 3; ++k) {
    const bool present = k == 2 || held[k];
    if (!present || distance2_(k, node) == std::numeric_limits<double>::max()) continue;
    const double weight = 1 / std::max(distance2_(k, node), 1e-18);
    sum += weight * (k == 2 ? at_rest : Eigen::Vector3d(motions[k] * at_rest));
    weights += weight;
  }
  return weights > 0 ? Eigen::Vector3d(sum / weights) : at_rest;
}

InversionRecovery::InversionRecovery(const NumberedBody& body, const BoundaryConditions& boundary,
                                     StepPotential& potential)
    : body_(body),
      boundary_(boundary),
      potential_(potential),
      blend_(body.body),
      x_kept_(NodalField::Zero(4, body.node_count())) {}

InversionRecovery::Outcome InversionRecovery::check(NodalField& x) noexcept {
  const ElementDoubts found = potential_.elements().doubts(x, kSmallStrain);
  const double elastic = potential_.elastic_energy();
  const bool still = std::abs(elastic - elastic_at_check_) <= kStill * elastic;
  elastic_at_check_ = elastic;
  inverted_ = found.inverted > 0;
  torn_ = inverted_ || (torn_ && found.strained > 0);
  suspect_count_ = inverted_ || (torn_ && still) ? suspect_count_ + 1 : 0;
  const bool hopeless = found.inverted * kHopelessShare > body_.elements.element_count();
  if (suspect_count_ < kPatience && !hopeless) return Outcome::kKept;
  suspect_count_ = 0;
  const double present = potential_.evaluate_static(x);
  std::array<math::Pose, 2> motions{math::Pose::Identity(), math::Pose::Identity()};
  for (int g = 0; g < body_.grasp_count(); ++g) {
    if (boundary_.held()[g]) motions[g] = boundary_.motion_from_rest(g);
  }
  x_kept_ = x;
  for (int node = 0; node < body_.node_count(); ++node) {
    x.col(body_.numbering[node]).head<3>() = blend_.position(node, boundary_.held(), motions);
  }
  if (!(potential_.evaluate_static(x) < present - kStill * elastic)) {
    x = x_kept_;
    return Outcome::kCompared;
  }
  inverted_ = false;
  return Outcome::kReplaced;
}

void InversionRecovery::detect(const NodalField& x) noexcept {
  if (!torn_) torn_ = potential_.elements().doubts(x, kSmallStrain).inverted > 0;
}

void InversionRecovery::forget() noexcept {
  suspect_count_ = 0;
  inverted_ = torn_ = false;
}

}  // namespace palpate::elasticity
