#include "core/estimation/fingertip_driven.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/estimation/nodal_loads.hpp"
#include "core/math/option_check.hpp"
#include "core/mesh/closest_point.hpp"

namespace palpate::estimation {
namespace {

/// Fraction of a Newton step. The model needs several ticks to converge after a change of force;
/// full steps would oscillate about the solution.
constexpr double kGain = 0.2;
constexpr double kNothing = 1e-3;  // N, below which a decaying force is removed

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Midside nodes between corners 0 and 1, 1 and 2, 2 and 0; empty for linear triangles.
std::vector<std::array<int, 3>> midsides_of(const elasticity::Body& body,
                                            const mesh::Surface& surface) {
  std::vector<std::array<int, 3>> midsides;
  for (const std::vector<int>& nodes : surface.triangle_nodes) {
    if (nodes.size() != 6) return {};
    std::array<int, 3> found{};
    for (int side = 0; side < 3; ++side) {
      const Vector3d middle =
          0.5 * (body.mesh.nodes.col(nodes[side]) + body.mesh.nodes.col(nodes[(side + 1) % 3]));
      found[side] = *std::min_element(nodes.begin() + 3, nodes.end(), [&](int a, int b) {
        return (body.mesh.nodes.col(a) - middle).squaredNorm() <
               (body.mesh.nodes.col(b) - middle).squaredNorm();
      });
    }
    midsides.push_back(found);
  }
  return midsides;
}

/// Component of a vector in the plane with this normal.
Vector3d along(const Vector3d& way, const Vector3d& normal) noexcept {
  return way - normal.dot(way) * normal;
}

Vector3d limited(const Vector3d& way, double farthest) noexcept {
  const double length = way.norm();
  return length > farthest ? Vector3d(farthest / length * way) : way;
}

/// Displacement of the material at `point` per unit force in a contact slot.
Matrix3d response(const mesh::PointWeights& point,
                  const Eigen::Matrix<double, Eigen::Dynamic, 3>& dx_dforce) noexcept {
  Matrix3d motion = Matrix3d::Zero();
  for (int i = 0; i < point.count; ++i)
    motion += point.weights[i] * dx_dforce.middleRows<3>(3 * point.nodes[i]);
  return motion;
}

}  // namespace

FingertipDriven::FingertipDriven(const elasticity::Body& body, const mesh::Surface& surface,
                                 const Options& options)
    : options_(options),
      triangles_(surface.triangles),
      midsides_(midsides_of(body, surface)),
      step_watch_(options.step) {
  math::check_positive(options.skin_stiffness, "skin_stiffness");
  math::check_positive(options.friction, "friction");
  math::check_positive(options.slide, "slide");
  math::check_positive(options.patience, "patience");
  math::check_positive(options.approach_speed, "approach_speed");
  math::check_option(triangles_.cols() > 0, "surface", triangles_.cols(), "at least one triangle");
}

void FingertipDriven::reset() noexcept {
  touches_.fill(Touch());
  step_watch_.reset();
}

void FingertipDriven::activate(elasticity::DeformationModel& model) noexcept {
  reset();
  for (int i = 0; i < static_cast<int>(model.body().grasps.size()); ++i) model.release(i);
  for (int slot = 0; slot < elasticity::kContactSlots; ++slot) model.watch_contact(slot, {});
  model.set_gravity(model.body().gravity_O);
}

UpdateResult FingertipDriven::update(const EstimationInputs& inputs,
                                     elasticity::DeformationModel& model,
                                     Estimate& estimate) noexcept {
  UpdateResult result;
  if (!step_guard_.accepts(inputs.dt))
    result = {Status::kDegraded, "time step is not positive and finite"};
  const double dt = step_guard_.step();
  gather(inputs, dt, model);
  follow(dt, model);
  model.loads().setZero();
  for (const Touch& touch : touches_) {
    if (!touch.touching) continue;
    if (!touch.ready) result = {Status::kDegraded, "the compliance at a touch is not known yet"};
    for (int i = 0; i < touch.point.count; ++i)
      model.loads().col(touch.point.nodes[i]) += touch.point.weights[i] * touch.force;
  }

  estimate.step = model.step(dt);
  estimate.log_young_modulus = std::log(model.body().material.young_modulus);
  estimate.poisson_ratio = model.body().material.poisson_ratio;
  const UpdateResult step = step_watch_.judge(estimate.step, dt);
  return step.is_ok() ? result : step;
}

/// Reads the contact locations of this tick; begins and ends contacts.
void FingertipDriven::gather(const EstimationInputs& inputs, double dt,
                             elasticity::DeformationModel& model) noexcept {
  for (Touch& known : touches_) {
    known.missing += dt;
    known.since += dt;
  }
  for (int i = 0; i < inputs.contact_count; ++i) {
    const contact::ContactLoads& contact = inputs.contacts[i];
    const int finger =
        static_cast<int>(contact.source) - static_cast<int>(sensing::Source::kFinger0);
    if (!contact.accepted || finger < 0 || finger >= kFingers || !contact.location.allFinite())
      continue;
    Touch& known = touches_[finger];
    known.missing = 0;
    known.place = contact.location;
    Vector3d felt = Vector3d::Zero();
    for (const contact::NodalLoad& load : contact.loads) felt += load.force;
    known.felt = felt.norm();
    if (!known.touching || known.leaving) touch(known, model);
  }
  for (Touch& known : touches_)
    if (known.touching && known.missing > options_.patience) let_go(known, dt, model);
}

/// Moves a contact to the material point nearest to its location; its force is kept.
void FingertipDriven::touch(Touch& touch, elasticity::DeformationModel& model) noexcept {
  const mesh::SurfacePoint found =
      mesh::closest_point_on_surface(touch.place, triangles_, model.positions());
  touch.triangle = found.triangle;
  const Vector3d& w = found.weights;
  mesh::PointWeights& point = touch.point;
  point.count = midsides_.empty() ? 3 : 6;
  for (int i = 0; i < 3; ++i) {
    point.nodes[i] = triangles_(i, found.triangle);
    point.weights[i] = w[i];
    if (midsides_.empty()) continue;
    point.weights[i] = w[i] * (2 * w[i] - 1);
    point.nodes[3 + i] = midsides_[found.triangle][i];
    point.weights[3 + i] = 4 * w[i] * w[(i + 1) % 3];
  }
  if (!touch.touching) {
    touch.slot = free_slot();
    touch.ready = false;
    touch.since = 0;
  }
  touch.touching = true;
  touch.leaving = false;
  if (touch.slot >= 0) model.watch_contact(touch.slot, point);
}

/// The force of a finger that leaves decays; the speed of the material is bounded as during
/// contact.
void FingertipDriven::let_go(Touch& touch, double dt,
                             elasticity::DeformationModel& model) noexcept {
  touch.leaving = true;
  double share = dt / options_.patience;
  if (touch.ready && touch.slot >= 0) {
    const Matrix3d compliance = response(touch.point, model.sensitivity().dx_dforce[touch.slot]);
    share = options_.approach_speed * dt / (compliance * touch.force).norm();
  }
  touch.force *= std::max(0.0, 1 - share);
  if (!(share < 1) || touch.force.norm() < kNothing) end(touch, model);
}

void FingertipDriven::end(Touch& touch, elasticity::DeformationModel& model) noexcept {
  if (touch.slot >= 0) model.watch_contact(touch.slot, {});
  touch = Touch();
}

int FingertipDriven::free_slot() const noexcept {
  for (int slot = 0; slot < elasticity::kContactSlots; ++slot)
    if (std::none_of(touches_.begin(), touches_.end(),
                     [slot](const Touch& t) { return t.touching && t.slot == slot; }))
      return slot;
  return -1;
}

/// A slot may still hold the compliance of a previous contact: only a snapshot taken after this
/// contact began is valid.
bool FingertipDriven::has_compliance(const Touch& touch,
                                     const elasticity::Sensitivity& known) const noexcept {
  if (!touch.touching || touch.slot < 0 || !known.valid) return false;
  return (touch.ready || known.age < touch.since) &&
         response(touch.point, known.dx_dforce[touch.slot]).squaredNorm() > 0;
}

/// Fills compliance_ and order_ for the contacts that are ready and returns their number.
int FingertipDriven::gather_compliance(const elasticity::DeformationModel& model) noexcept {
  const elasticity::Sensitivity& known = model.sensitivity();
  int count = 0;
  for (int finger = 0; finger < kFingers; ++finger) {
    touches_[finger].ready = has_compliance(touches_[finger], known);
    if (touches_[finger].ready && !touches_[finger].leaving) order_[count++] = finger;
  }
  const int watched = count;
  if (watched == 0) return 0;
  for (int finger = 0; finger < kFingers; ++finger) {
    Touch& touch = touches_[finger];
    if (!touch.touching || touch.leaving || touch.slot >= 0) continue;
    touch.ready = true;
    order_[count++] = finger;
  }
  compliance_.setZero(3 * count, 3 * count);
  Matrix3d own = Matrix3d::Zero();
  for (int j = 0; j < watched; ++j) {
    const auto& motion = known.dx_dforce[touches_[order_[j]].slot];
    for (int i = 0; i < count; ++i) {
      const Matrix3d block = response(touches_[order_[i]].point, motion);
      compliance_.block<3, 3>(3 * i, 3 * j) = block;
      if (i >= watched) compliance_.block<3, 3>(3 * j, 3 * i) = block.transpose();
    }
    own += compliance_.block<3, 3>(3 * j, 3 * j) / watched;
  }
  for (int i = watched; i < count; ++i) compliance_.block<3, 3>(3 * i, 3 * i) = own;
  return count;
}

/// One Newton step of the forces towards  place - force / stiffness = material.  The step computed
/// with all contacts sticking decides which contacts slide. Sliding contacts then receive the
/// friction limit, and their normal forces are solved for under that condition. Truncating the
/// tangential force after the solution would leave the normal forces wrong and make contacts
/// chatter between sticking and sliding.
void FingertipDriven::follow(double dt, elasticity::DeformationModel& model) noexcept {
  const int count = gather_compliance(model);
  if (count == 0) return;
  const double farthest = options_.approach_speed * dt;
  Vector gap(3 * count);
  for (int i = 0; i < count; ++i)
    gap.segment<3>(3 * i) = limited(gap_of(touches_[order_[i]], model.positions()), farthest);
  const Matrix turned = compliance_.transpose();
  compliance_ = 0.5 * (compliance_ + turned);  // the transformed columns are not exactly symmetric
  compliance_.diagonal().array() += 1 / options_.skin_stiffness;
  Vector change = solve(gap);
  if (!change.allFinite()) return;

  // Frames of sliding contacts: normal, tangential, tangential.
  Matrix frames = Matrix::Identity(3 * count, 3 * count);
  Vector given = Vector::Constant(3 * count, std::numeric_limits<double>::quiet_NaN());
  for (int i = 0; i < count; ++i) {
    Touch& known = touches_[order_[i]];
    const Vector3d out = normal(known, model.positions());
    const Vector3d wanted = along(known.force + change.segment<3>(3 * i), out);
    const double bearable = options_.friction * std::max(-known.force.dot(out), known.felt);
    known.sliding = wanted.norm() > bearable;
    if (!known.sliding) continue;
    const Vector3d one = wanted.normalized(), other = out.cross(one);
    const Vector3d missing = bearable * one - along(known.force, out);
    frames.block<3, 3>(3 * i, 3 * i) << out, one, other;
    const Vector3d way = gap_of(known, model.positions());
    gap.segment<3>(3 * i) = Vector3d(std::clamp(out.dot(way), -farthest, farthest), 0, 0);
    given.segment<2>(3 * i + 1) << one.dot(missing), other.dot(missing);
  }
  if (!given.array().isNaN().all()) {
    compliance_ = (frames.transpose() * compliance_ * frames).eval();
    for (int k = 0; k < 3 * count; ++k) {
      if (std::isnan(given[k])) continue;
      gap -= given[k] * compliance_.col(k);
      compliance_.row(k).setZero();
      compliance_.col(k).setZero();
      compliance_(k, k) = 1;
    }
    for (int k = 0; k < 3 * count; ++k)
      if (!std::isnan(given[k])) gap[k] = given[k];
    change = frames * solve(gap);
    if (!change.allFinite()) return;
  }
  for (int i = 0; i < count; ++i) {
    Touch& known = touches_[order_[i]];
    known.force += kGain * change.segment<3>(3 * i);
    if (!known.sliding) continue;
    const Vector3d out = normal(known, model.positions());
    const Vector3d lag = along(known.place - known.point.interpolate(model.positions()), out);
    if (lag.norm() > options_.slide) touch(known, model);
  }
}

/// Solves with compliance_, N. Near buckling, where the compliance is not positive definite, the
/// steps are smaller.
FingertipDriven::Vector FingertipDriven::solve(const Vector& gap) noexcept {
  Eigen::LDLT<Matrix> solver(compliance_);
  if (!solver.isPositive()) {
    compliance_.diagonal().array() += compliance_.diagonal().cwiseAbs().sum();
    solver.compute(compliance_);
  }
  return solver.solve(gap);
}

/// Distance from the material to where finger and skin hold it, m.
Vector3d FingertipDriven::gap_of(const Touch& touch,
                                 const Eigen::Matrix3Xd& positions) const noexcept {
  return touch.place - touch.force / options_.skin_stiffness - touch.point.interpolate(positions);
}

/// Outward surface normal.
Vector3d FingertipDriven::normal(const Touch& touch,
                                 const Eigen::Matrix3Xd& positions) const noexcept {
  const Vector3d a = positions.col(triangles_(0, touch.triangle));
  const Vector3d b = positions.col(triangles_(1, touch.triangle));
  const Vector3d c = positions.col(triangles_(2, touch.triangle));
  return (b - a).cross(c - a).normalized();
}

}  // namespace palpate::estimation
