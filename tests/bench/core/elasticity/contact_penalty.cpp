#include "tests/bench/core/elasticity/contact_penalty.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::bench {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using elasticity::NodalField;

namespace {

// Distance, m, beyond which a point is not evaluated until the table of points is renewed.
constexpr double kWatched = 2e-3;
constexpr int kFollowPeriod = 4;  // steps, as the model

elasticity::SolverOptions loop_options() {
  elasticity::SolverOptions options;
  options.halvings = 12;  // a point that closes makes the potential rise steeply
  return options;
}

}  // namespace

ContactPenalty::ContactPenalty(const ContactScene& scene, const PenaltyOptions& options)
    : own_(options),
      parts_(scene, loop_options()),
      gradient_(NodalField::Zero(4, parts_.body.node_count())),
      gradient_before_(gradient_),
      x_before_(parts_.x),
      motion_(parts_.body, false),
      x_snapshot_(parts_.body.body.mesh.nodes),
      correction_(Eigen::VectorXf::Zero(3 * parts_.body.pattern.size())),
      step_taken_(correction_),
      force_change_(correction_) {
  for (int s = 0; s < static_cast<int>(parts_.samples.size()); ++s) {
    for (int o = 0; o < static_cast<int>(scene.obstacles.size()); ++o) {
      Point point;
      point.contact.sample = s;
      point.contact.obstacle = o;
      points_.push_back(point);
    }
  }
  parts_.potential.evaluate(parts_.x);
  snapshot();
  run();
  install();
}

/// Position, gap, force and energy of a point.
void ContactPenalty::evaluate(Point& point) {
  elasticity::SurfaceContact& contact = point.contact;
  const mesh::PointWeights& sample = parts_.samples[contact.sample];
  contact.position.setZero();
  for (int i = 0; i < sample.count; ++i)
    contact.position += sample.weights[i] * parts_.x.col(sample.nodes[i]).head<3>();
  const collision::Obstacle& obstacle = parts_.options.contact.obstacles[contact.obstacle];
  const collision::Proximity near = collision::proximity(obstacle, contact.position);
  contact.gap = near.distance;
  contact.normal = near.normal;
  contact.force.setZero();
  const double depth = std::max(0.0, -contact.gap), normal_force = own_.stiffness * depth;
  if (depth == 0) return;
  contact.force = normal_force * contact.normal;
  energy_ += 0.5 * own_.stiffness * depth * depth;
  Vector3d slip = contact.position - point.begin;
  slip -= contact.normal.dot(slip) * contact.normal;
  const double size = slip.norm(), most = obstacle.friction * point.normal_force;
  contact.slips = size >= own_.slip;
  // energy per limit of friction, and its derivative per slip
  const double ratio = size / own_.slip;
  energy_ +=
      most * own_.slip * (ratio < 1 ? ratio * ratio - ratio * ratio * ratio / 3 : ratio - 1.0 / 3);
  const double per_slip = (ratio < 1 ? 2 - ratio : 1 / ratio) / own_.slip;
  contact.force -= most * per_slip * slip;
}

/// Potential, J, at the present positions; sets gradient_.
double ContactPenalty::evaluate() {
  const double elastic = parts_.potential.evaluate(parts_.x);
  gradient_ = parts_.potential.forces();
  energy_ = 0;
  for (Point& point : points_) {
    if (point.contact.gap > kWatched) continue;
    evaluate(point);
    if (!point.contact.presses()) continue;
    const mesh::PointWeights& sample = parts_.samples[point.contact.sample];
    for (int i = 0; i < sample.count; ++i)
      gradient_.col(sample.nodes[i]).head<3>() -= sample.weights[i] * point.contact.force;
  }
  return elastic + energy_;
}

double ContactPenalty::slope() const {
  double sum = 0;
  for (int k = 0; k < parts_.body.pattern.size(); ++k)
    sum += gradient_.col(k).head<3>().dot(correction_.segment<3>(3 * k).cast<double>());
  return sum;
}

void ContactPenalty::find_correction() {
  for (int k = 0; k < parts_.body.pattern.size(); ++k)
    correction_.segment<3>(3 * k) = -gradient_.col(k).head<3>().cast<float>();
  parts_.factor.solve(correction_, parts_.boundary);
}

elasticity::StepReport ContactPenalty::step(const math::Pose& hand) {
  NodalField& x = parts_.x;
  parts_.boundary.hold(0, hand, parts_.body.body.mesh.nodes);
  parts_.potential.begin_step(parts_.boundary);
  for (Point& point : points_) {
    evaluate(point);
    point.begin = point.contact.position;
    point.normal_force = own_.stiffness * std::max(0.0, -point.contact.gap);
  }
  motion_.begin_step();
  motion_.complete_prediction(true);
  x = motion_.x();
  parts_.boundary.apply(x);
  double energy = evaluate();
  if (++steps_ % kFollowPeriod == 0) parts_.factor.follow(parts_.potential.elements());
  elasticity::StepReport report;
  report.status = elasticity::StepStatus::kNotConverged;
  const elasticity::SolverOptions& options = parts_.options;
  while (report.iterations < own_.iterations) {
    report.residual = parts_.boundary.largest_at_free_nodes(gradient_);
    if (report.residual <= options.tolerance) {
      report.status = elasticity::StepStatus::kConverged;
      break;
    }
    find_correction();
    ++report.iterations;
    const double slope_begin = slope();
    x_before_ = x;
    gradient_before_ = gradient_;
    double share = 1, next = energy;
    bool accepted = false;
    for (int halving = 0; halving <= options.halvings && !accepted; ++halving, share *= 0.5) {
      for (int k = 0; k < parts_.body.pattern.size(); ++k) {
        x.col(k).head<3>() =
            x_before_.col(k).head<3>() + share * correction_.segment<3>(3 * k).cast<double>();
      }
      next = evaluate();
      const double rounding = 1e-12 * (std::abs(energy) + std::abs(next));
      accepted = next <= energy + 1e-4 * share * slope_begin ||
                 (std::abs(next - energy) <= rounding && slope() < -0.9 * slope_begin);
    }
    if (!accepted) {
      x = x_before_;
      energy = evaluate();
      parts_.factor.secants().clear();
      break;
    }
    for (int k = 0; k < parts_.body.pattern.size(); ++k) {
      step_taken_.segment<3>(3 * k) = (x.col(k) - x_before_.col(k)).head<3>().cast<float>();
      force_change_.segment<3>(3 * k) =
          (gradient_.col(k) - gradient_before_.col(k)).head<3>().cast<float>();
    }
    parts_.boundary.clear_held_nodes(force_change_);
    parts_.factor.secants().add(step_taken_, force_change_);
    energy = next;
  }
  motion_.x() = x;
  motion_.finish_step(kContactStep);
  return report;
}

void ContactPenalty::snapshot() {
  x_snapshot_ = parts_.positions();
  at_snapshot_ = points_;
  parts_.fresh.rotations = parts_.factor.measure_rotations(parts_.potential.elements());
}

/// Derivative of the force that holds a point back, N/m.
Matrix3d ContactPenalty::stiffness(const Point& point) const {
  const Vector3d& n = point.contact.normal;
  const collision::Obstacle& obstacle = parts_.options.contact.obstacles[point.contact.obstacle];
  Vector3d slip = point.contact.position - point.begin;
  slip -= n.dot(slip) * n;
  const double size = std::max(slip.norm(), own_.slip);
  const Matrix3d across = Matrix3d::Identity() - n * n.transpose();
  return own_.stiffness * n * n.transpose() +
         obstacle.friction * point.normal_force / size * across;
}

void ContactPenalty::add_stiffness(const Point& point) {
  const factor::BlockPattern& pattern = parts_.body.pattern;
  const mesh::PointWeights& sample = parts_.samples[point.contact.sample];
  const Matrix3d K = stiffness(point);
  for (int a = 0; a < sample.count; ++a) {
    for (int b = 0; b < sample.count; ++b) {
      const int row = sample.nodes[a], column = sample.nodes[b];
      if (row < column || row >= pattern.size()) continue;
      const auto begin = pattern.row().begin();
      const auto at = std::lower_bound(begin + pattern.column_start()[column],
                                       begin + pattern.column_start()[column + 1], row);
      parts_.matrix.block(static_cast<int>(at - begin)) +=
          sample.weights[a] * sample.weights[b] * K;
    }
  }
}

void ContactPenalty::run() {
  parts_.tangents->assemble(x_snapshot_, elasticity::Tangent::kExact, parts_.matrix, nullptr);
  for (const Point& point : at_snapshot_)
    if (point.contact.presses()) add_stiffness(point);
  elasticity::LoopFactor& fresh = parts_.fresh;
  fresh.exact = parts_.factorisation.factorise(parts_.matrix) &&
                parts_.factorisation.is_positive(parts_.boundary.held());
  fresh.usable = fresh.exact && fresh.panels.assign(parts_.factorisation);
}

void ContactPenalty::install() {
  if (parts_.fresh.usable) parts_.factor.install(parts_.fresh, 0, parts_.potential.elements());
}

std::vector<elasticity::SurfaceContact> ContactPenalty::contacts() const {
  std::vector<elasticity::SurfaceContact> touching;
  for (const Point& point : points_) {
    if (!point.contact.presses()) continue;
    touching.push_back(point.contact);
    const math::Pose& X_OB = parts_.options.contact.obstacles[point.contact.obstacle].X_OB;
    touching.back().anchor_B = X_OB.inverse() * point.contact.position;
  }
  return touching;
}

int ContactPenalty::pressing() const {
  return static_cast<int>(std::count_if(
      points_.begin(), points_.end(), [](const Point& point) { return point.contact.presses(); }));
}

double ContactPenalty::deepest() const {
  double depth = 0;
  for (const Point& point : points_) depth = std::max(depth, -point.contact.gap);
  return depth;
}

}  // namespace palpate::bench
