#include "sim/object/compliant_grasp.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace palpate::object {
namespace {

constexpr double kMostStiffening = 2;  // of the pads per area, relative to the patch

}  // namespace

HandMotion::HandMotion(const math::Pose& X_OG) : X_OG_(X_OG), X_start_(X_OG), X_end_(X_OG) {}

void HandMotion::send(const math::Pose& X_OG, const math::Twist& V_O_G) noexcept {
  X_end_ = X_OG;
  V_end_ = V_O_G;
}

void HandMotion::begin() noexcept {
  X_start_ = X_OG_;
  V_start_ = V_O_G_;
  q_start_ = Eigen::Quaterniond(X_start_.linear());
  q_end_ = Eigen::Quaterniond(X_end_.linear());
}

void HandMotion::advance(double s) noexcept {
  X_OG_.translation() = (1 - s) * X_start_.translation() + s * X_end_.translation();
  X_OG_.linear() = q_start_.slerp(s, q_end_).toRotationMatrix();
  V_O_G_.linear = (1 - s) * V_start_.linear + s * V_end_.linear;
  V_O_G_.angular = (1 - s) * V_start_.angular + s * V_end_.angular;
}

void HandMotion::end() noexcept { V_end_ = math::Twist(); }

void HandMotion::stop() noexcept {
  X_end_ = X_OG_;
  V_O_G_ = V_end_ = math::Twist();
}

std::vector<CompliantGrasp::Spot> CompliantGrasp::spots_in(const HexahedralGrid& grid,
                                                           const Box& box, int pinch_axis) {
  const Eigen::VectorXd areas = grid.patch_areas(box, pinch_axis);
  const Eigen::Matrix3Xd vectors = grid.patch_area_vectors(box, pinch_axis);
  std::vector<Spot> spots;
  for (int n = 0; n < areas.size(); ++n)
    if (areas[n] > 0)
      spots.push_back({n, areas[n], grid.nodes().col(n), vectors.col(n).normalized()});
  return spots;
}

CompliantGrasp::CompliantGrasp(const HexahedralGrid& grid, const GraspOptions& options)
    : jaws_(options.jaws),
      stiffness_(options.stiffness),
      damping_(options.damping),
      grip_(options.grip),
      friction_(options.friction),
      limited_(std::isfinite(options.grip)),
      hand_(options.X_OG_rest) {
  if (!(options.stiffness > 0) || !(options.damping >= 0)) {
    throw std::invalid_argument("plant: the pads need stiffness > 0 and damping >= 0");
  }
  if (!(options.grip >= 0) || !(options.friction >= 0)) {
    throw std::invalid_argument("plant: grip and friction of the pads must not be negative");
  }
  if (options.pinch_axis < -1 || options.pinch_axis > 2) {
    throw std::invalid_argument("plant: the pinch axis is 0, 1, 2 or -1");
  }
  if (!options.X_OG_rest.matrix().allFinite()) {
    throw std::invalid_argument("plant: the rest pose of the hand must be finite");
  }
  if (options.open_at_rest && !options.jaws)
    throw std::invalid_argument("plant: a hand that is open at rest needs jaws");
  const std::vector<Spot> patch = spots_in(grid, options.patch, options.pinch_axis);
  patch_area_ = grid.patch_areas(options.patch, options.pinch_axis).sum();
  if (patch.empty()) throw std::invalid_argument("plant: the grasp box holds no surface node");
  if (jaws_) {
    const Eigen::Vector3d far = Eigen::Vector3d::Constant(std::numeric_limits<double>::max());
    surface_ = spots_in(grid, {-far, far}, options.pinch_axis);
    pads_.reserve(surface_.size());
  }
  if (options.open_at_rest) return;
  for (const Spot& spot : patch) attach(spot, patch_area_, spot.p_O, spot.normal);
  update_pads();
}

void CompliantGrasp::attach(const Spot& spot, double total, const Eigen::Vector3d& position,
                            const Eigen::Vector3d& normal_O) {
  Pad pad;
  pad.node = spot.node;
  pad.area = spot.area;
  pad.stiffness = stiffness_ * spot.area / total;
  pad.damping = damping_ * spot.area / total;
  pad.grip = limited_ ? grip_ * spot.area / total : 0;
  pad.normal_G = hand_.X_OG().linear().transpose() * normal_O;
  pad.p_G = hand_.X_OG().inverse() * position;
  pads_.push_back(pad);
}

void CompliantGrasp::open() noexcept {
  if (jaws_) pads_.clear();
}

void CompliantGrasp::close(const Eigen::Matrix3Xd& positions) noexcept {
  if (!jaws_ || holds()) return;
  const math::Pose X_GO = hand_.X_OG().inverse();
  const auto between = [&](const Spot& spot) {
    return jaws_->contains(X_GO * Eigen::Vector3d(positions.col(spot.node)));
  };
  double area = 0;
  Eigen::Vector3d at_rest = Eigen::Vector3d::Zero(), now = Eigen::Vector3d::Zero();
  for (const Spot& spot : surface_) {
    if (!between(spot)) continue;
    area += spot.area;
    at_rest += spot.area * spot.p_O;
    now += spot.area * positions.col(spot.node);
  }
  if (!(area > 0)) return;
  // Rotation of the held part since the rest state, for the normals (Kabsch 1976).
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Spot& spot : surface_) {
    if (!between(spot)) continue;
    covariance += spot.area * (positions.col(spot.node) - now / area) *
                  (spot.p_O - at_rest / area).transpose();
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance,
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d U = svd.matrixU();
  if (U.determinant() * svd.matrixV().determinant() < 0) U.col(2) *= -1;
  const Eigen::Matrix3d R = U * svd.matrixV().transpose();
  const double total = std::max(area, patch_area_ / kMostStiffening);
  slide_ = {};
  for (const Spot& spot : surface_)
    if (between(spot)) attach(spot, total, positions.col(spot.node), R * spot.normal);
  update_pads();
}

void CompliantGrasp::add_stiffness_bound(Eigen::VectorXd& stiffness) const noexcept {
  for (const Spot& spot : surface_)
    stiffness[spot.node] += kMostStiffening * stiffness_ / patch_area_ * spot.area;
  if (surface_.empty())
    for (const Pad& pad : pads_) stiffness[pad.node] += pad.stiffness;
}

void CompliantGrasp::slide(const Eigen::Vector3d& displacement_G,
                           const Eigen::Vector3d& rate_G) noexcept {
  slide_.end = displacement_G;
  slide_.rate = rate_G;
  slide_.ever = true;
}

void CompliantGrasp::begin() noexcept {
  hand_.begin();
  slide_.start = slide_.now;
}

void CompliantGrasp::advance(double s) noexcept {
  hand_.advance(s);
  slide_.now = (1 - s) * slide_.start + s * slide_.end;
  update_pads();
}

void CompliantGrasp::end() noexcept {
  hand_.end();
  slide_.rate.setZero();
  const double distance = (slide_.now - slide_.start).norm();
  for (Pad& pad : pads_) pad.slipped += distance;
}

void CompliantGrasp::stop() noexcept {
  hand_.stop();
  slide_.end = slide_.now;
  slide_.rate.setZero();
  update_pads();
}

void CompliantGrasp::update_pads() noexcept {
  const math::Pose& X_OG = hand_.X_OG();
  const math::Twist& V_O_G = hand_.V_O_G();
  for (Pad& pad : pads_) {
    pad.p_O = X_OG * pad.p_G;
    if (slide_.ever) pad.p_O -= X_OG.linear() * slide_.now;
    pad.velocity_O = V_O_G.linear + V_O_G.angular.cross(pad.p_O - X_OG.translation());
    if (slide_.ever) pad.velocity_O -= X_OG.linear() * slide_.rate;
  }
}

void CompliantGrasp::limit(Pad& pad, const Eigen::Vector3d& spring, const Eigen::Vector3d& trial,
                           const Eigen::Vector3d& position) noexcept {
  const Eigen::Vector3d n = hand_.X_OG().linear() * pad.normal_G;
  const double pull = n.dot(spring);
  const double most = friction_ * std::max(0.0, pad.grip - pull);
  const auto across = [&n](const Eigen::Vector3d& f) -> Eigen::Vector3d {
    return f - n.dot(f) * n;
  };
  // A damper that opposes the spring does not raise the spring's friction limit.
  Eigen::Vector3d held = across(trial);
  if (held.norm() <= most) held = across(spring);
  const double size = held.norm();
  if (pull < pad.grip && size <= most) return;
  pad.slipping = true;
  if (size > most) held *= most / size;
  pad.force_O = std::min(pull, pad.grip) * n + held;
  // Along n the anchor stays fixed, so that a pad that lost contact meets the surface where it left
  // it.
  const Eigen::Vector3d p_O = position + pull / pad.stiffness * n + held / pad.stiffness;
  pad.slipped += (p_O - pad.p_O).norm();
  pad.p_O = p_O;
  pad.p_G = hand_.X_OG().inverse() * p_O;
  if (slide_.ever) pad.p_G += slide_.now;
}

void CompliantGrasp::add_forces(const Eigen::Matrix3Xd& positions,
                                const Eigen::Matrix3Xd& velocities, Eigen::Matrix3Xd& forces,
                                Eigen::VectorXd& damping) noexcept {
  for (Pad& pad : pads_) {
    const Eigen::Vector3d position = positions.col(pad.node);
    const Eigen::Vector3d spring = pad.stiffness * (pad.p_O - position);
    pad.force_O = spring;
    pad.slipping = false;
    if (limited_) {
      const Eigen::Vector3d slide = pad.velocity_O - velocities.col(pad.node);
      limit(pad, spring, spring + pad.damping * slide, position);
    }
    forces.col(pad.node) += pad.force_O;
    if (pad.slipping) continue;
    forces.col(pad.node) += pad.damping * pad.velocity_O;
    damping[pad.node] += pad.damping;
  }
}

math::Wrench CompliantGrasp::wrench(const Eigen::Matrix3Xd& positions,
                                    const Eigen::Matrix3Xd& velocities) const noexcept {
  math::Wrench total;
  for (const Pad& pad : pads_) {
    Eigen::Vector3d force = pad.force_O;
    if (!pad.slipping) force += pad.damping * (pad.velocity_O - velocities.col(pad.node));
    total.force += force;
    total.torque += (positions.col(pad.node) - hand_.X_OG().translation()).cross(force);
  }
  return total;
}

GraspSlip CompliantGrasp::slip() const noexcept {
  GraspSlip slip;
  double total = 0;
  for (const Pad& pad : pads_) {
    total += pad.area;
    if (pad.slipping) slip.share += pad.area;
    slip.distance += pad.area * pad.slipped;
    slip.greatest = std::max(slip.greatest, pad.slipped);
  }
  if (total > 0) {
    slip.share /= total;
    slip.distance /= total;
  }
  return slip;
}

double CompliantGrasp::force_scale() const noexcept {
  double scale = 0;
  for (const Pad& pad : pads_) scale += pad.force_O.norm();
  return scale;
}

}  // namespace palpate::object
