#include "tools/fit/held/held_object.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/contact/surface_match.hpp"
#include "core/elasticity/pad_compliance.hpp"

namespace palpate::fit {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using elasticity::Sensitivity;

constexpr double kFinestPoint = 1e-5;  // m, as kFinestForce

constexpr int kFootSteps = 40;  // of the perpendicular on a curved face, exact to rounding

constexpr const char* kAxes[6] = {"x", "y", "z", "rx", "ry", "rz"};

/// Every k-th column, so that at most `most` remain.
Matrix3Xd thinned(const Matrix3Xd& points, int most) {
  const int step = std::max(1, static_cast<int>((points.cols() + most - 1) / most));
  Matrix3Xd few(3, (points.cols() + step - 1) / step);
  for (Eigen::Index i = 0; i < few.cols(); ++i) few.col(i) = points.col(i * step);
  return few;
}

/// Chain rule from derivatives by logarithms of E and density to those by the values.
Vector3d by_parameter(const elasticity::Material& material) {
  return {1 / material.young_modulus, 1, 1 / material.density};
}

}  // namespace

/// Parameters by meaning.
struct HeldObject::State {
  elasticity::Body body;
  math::Pose offset = math::Pose::Identity();  // of the true G in the measured one
  Matrix3d left_jacobian = Matrix3d::Identity();
  sensing::PayloadParameters hand;  // with the bias
  // Compliances in G: of the pads, and what the mesh lacks next to them.
  math::Matrix6d pads = math::Matrix6d::Zero(), patch = math::Matrix6d::Zero();
};

HeldObject::HeldObject(std::string name, HeldCell cell, HeldRecording recording,
                       HeldOptions options)
    : Experiment(std::move(name)),
      cell_(std::move(cell)),
      recording_(std::move(recording)),
      options_(std::move(options)) {
  const mesh::PointLocator locator(cell_.object.body.mesh);
  for (const Vector3d& marker : options_.markers) markers_.push_back(locator.locate(marker));
  const math::Pose X_OW = cell_.frames.X_WO.inverse();
  for (const HeldSample& sample : recording_.samples) {
    const Matrix3Xd points = X_OW * sample.points_W;
    if (!markers_.empty() && points.cols() != 0 &&
        points.cols() != static_cast<Eigen::Index>(markers_.size()))
      throw std::invalid_argument(name_ + ": " + std::to_string(points.cols()) +
                                  " points are seen, but " + std::to_string(markers_.size()) +
                                  " markers are named");
    seen_.push_back(markers_.empty() ? thinned(points, options_.points) : points);
  }
  list_parameters();
  list_series();
  follow_hand();
}

void HeldObject::list_parameters() {
  const elasticity::Material& material = cell_.object.body.material;
  const HeldSought& sought = options_.sought;
  const auto add = [this](Parameter parameter) { parameters_.push_back(std::move(parameter)); };
  const double nu = material.poisson_ratio, density = material.density;
  add({"young_modulus", "Pa", material.young_modulus, 10, 1e9, true});
  add({"poisson_ratio", "", nu, sought.poisson_ratio ? -0.4 : nu, sought.poisson_ratio ? 0.495 : nu,
       false});
  add({"density", "kg/m^3", density, sought.density ? 0.5 : density, sought.density ? 2e4 : density,
       true});
  if (sought.grasp) {
    grasp_ = static_cast<int>(parameters_.size());
    for (int k = 0; k < 6; ++k) {
      const double most = k < 3 ? 0.03 : 0.35;
      add({name_ + ".grasp_" + kAxes[k], k < 3 ? "m" : "rad", 0, -most, most, false});
    }
  }
  if (sought.bias) {
    bias_ = static_cast<int>(parameters_.size());
    const math::Vector6d start = cell_.hand.bias.vector();
    for (int k = 0; k < 6; ++k)
      add({name_ + ".bias_" + kWrench[k], k < 3 ? "N" : "N m", start[k], k < 3 ? -100.0 : -10.0,
           k < 3 ? 100.0 : 10.0, false});
  }
  if (sought.hand) {
    mass_ = static_cast<int>(parameters_.size());
    add({name_ + ".hand_mass", "kg", cell_.hand.mass, 0, 100, false});
    for (int k = 0; k < 3; ++k)
      add({name_ + ".hand_moment_" + kAxes[k], "kg m", cell_.hand.first_moment[k], -50, 50, false});
  }
  if (sought.pads) {
    const elasticity::GraspRegion& grasp = cell_.object.body.grasps[0];
    soft_pads_ = elasticity::pad_compliance(cell_.object.body, grasp, cell_.object.surface, 1);
    const double configured = grasp.compliance(0, 0);
    const double start = configured > 0 ? soft_pads_(0, 0) / configured : kPadStiffness;
    pads_ = static_cast<int>(parameters_.size());
    add({"grasp_stiffness", "N/m", start, 1, 1e9, true});
  }
}

void HeldObject::list_series() {
  const int n = samples();
  Eigen::VectorXd times(n);
  for (int i = 0; i < n; ++i) times[i] = recording_.samples[i].time;
  for (int k = 0; k < 6; ++k) {
    Series series{std::string(k < 3 ? "force " : "torque ") + kAxes[k % 3],
                  k < 3 ? "N" : "N m",
                  "time",
                  "s",
                  times,
                  Eigen::VectorXd(n),
                  std::max(recording_.deviation[k], k < 3 ? kFinestForce : kFinestTorque),
                  options_.is_held_out};
    for (int i = 0; i < n; ++i)
      series.measured[i] = cell_.polarity * recording_.samples[i].F_S.vector()[k];
    series_.push_back(std::move(series));
  }
  const int per_point = markers_.empty() ? 1 : 3;
  int rows = 0;
  for (const Matrix3Xd& points : seen_) {
    first_row_.push_back(6 * n + rows);
    rows += per_point * static_cast<int>(points.cols());
  }
  if (rows == 0) return;
  Series series{markers_.empty() ? "distance from the surface" : "marker position",
                "m",
                "time",
                "s",
                Eigen::VectorXd(rows),
                Eigen::VectorXd::Zero(rows),
                std::max(recording_.point_deviation, kFinestPoint),
                {}};
  for (int i = 0; i < n; ++i) {
    const int first = first_row_[i] - 6 * n, count = per_point * static_cast<int>(seen_[i].cols());
    series.x.segment(first, count).setConstant(times[i]);
    if (!markers_.empty())
      series.measured.segment(first, count) =
          Eigen::Map<const Eigen::VectorXd>(seen_[i].data(), count);
    if (!options_.is_held_out.empty())
      series.is_held_out.insert(series.is_held_out.end(), count, options_.is_held_out[i]);
  }
  series_.push_back(std::move(series));
}

HeldObject::State HeldObject::state(const Eigen::VectorXd& p) const {
  const elasticity::GraspRegion& grasp = cell_.object.body.grasps[0];
  State state{cell_.object.body, {}, {}, cell_.hand, grasp.compliance, {}};
  state.body.material = {p[Sensitivity::kLogYoung], p[Sensitivity::kPoisson],
                         p[Sensitivity::kLogDensity]};
  state.offset.setIdentity();
  state.left_jacobian.setIdentity();
  if (grasp_ >= 0) {
    const Vector3d turn = p.segment<3>(grasp_ + 3);
    state.offset = math::make_pose(math::exp_rotation(turn), p.segment<3>(grasp_));
    state.left_jacobian = math::inverse_left_jacobian(turn).inverse();
  }
  if (bias_ >= 0) state.hand.bias = math::Wrench::from(p.segment<6>(bias_));
  if (mass_ >= 0) {
    state.hand.mass = p[mass_];
    state.hand.first_moment = p.segment<3>(mass_ + 1);
  }
  if (pads_ >= 0) state.pads = soft_pads_ / p[pads_];
  state.patch = grasp.object_compliance * cell_.object.body.material.young_modulus /
                p[Sensitivity::kLogYoung];
  return state;
}

math::Pose HeldObject::grasp(const State& state, const math::Pose& X_WE) const {
  return cell_.frames.X_WO.inverse() * X_WE * cell_.frames.X_EG * state.offset;
}

void HeldObject::follow_hand() {
  const State at_start = state(start());
  HeldEquilibrium equilibrium(at_start.body, at_start.pads + at_start.patch);
  elasticity::StaticOptions options;
  options.tolerance = 1e-7;
  Matrix3Xd shape = at_start.body.mesh.nodes;
  math::Vector6d yield = math::Vector6d::Zero();
  double force = 0, torque = 0;
  for (const HeldSample& sample : recording_.samples) {
    std::vector<math::Pose> way = sample.way;
    way.push_back(sample.X_WE);
    bool found = false;
    for (const math::Pose& X_WE : way) {
      found = equilibrium.solve(grasp(at_start, X_WE), shape, yield, options);
      if (!found) continue;
      shape = equilibrium.positions();
      yield = equilibrium.yield();
    }
    if (!found)
      throw std::invalid_argument(
          name_ + ": no equilibrium of the object is found for the hand at " +
          std::to_string(sample.time) +
          " s; check mesh, frames and grasp of the configuration against the recording");
    force = std::max(force, equilibrium.wrench().force.norm());
    torque = std::max(torque, equilibrium.wrench().torque.norm());
    shapes_.push_back(shape);
    yields_.push_back(yield);
  }
  for (int k = 0; k < 6; ++k)
    series_[k].deviation =
        std::hypot(series_[k].deviation, options_.model_error * (k < 3 ? force : torque));
}

/// What the parameters change at a pose of the flange.
HeldEquilibrium::Changes HeldObject::changes(const State& state, const math::Pose& X_WE,
                                             double stiffness) const {
  const auto count = static_cast<Eigen::Index>(parameters_.size());
  HeldEquilibrium::Changes changes;
  changes.hand.setZero(6, count);
  changes.material.setZero(kMaterial, count);
  changes.material.leftCols<kMaterial>() = by_parameter(state.body.material).asDiagonal();
  if (grasp_ >= 0) {
    const Matrix3d R = (cell_.frames.X_WO.inverse() * X_WE * cell_.frames.X_EG).linear();
    changes.hand.block<3, 3>(0, grasp_) = R;
    changes.hand.block<3, 3>(3, grasp_ + 3) = R * state.left_jacobian;
  }
  if (!state.patch.isZero(0))
    changes.pads.emplace_back(Sensitivity::kLogYoung,
                              -state.patch / state.body.material.young_modulus);
  if (pads_ >= 0) changes.pads.emplace_back(pads_, -state.pads / stiffness);
  return changes;
}

bool HeldObject::predict(const Eigen::VectorXd& parameters, Eigen::VectorXd& prediction,
                         Eigen::MatrixXd* jacobian) const {
  const State at = state(parameters);
  prediction.resize(sample_count());
  if (jacobian) jacobian->setZero(sample_count(), static_cast<Eigen::Index>(parameters_.size()));
  HeldEquilibrium found(at.body, at.pads + at.patch);
  for (int i = 0; i < samples(); ++i) {
    const math::Pose X_WE = recording_.samples[i].X_WE;
    if (!found.solve(grasp(at, X_WE), shapes_[i], yields_[i])) return false;
    const double stiffness = pads_ >= 0 ? parameters[pads_] : 1;
    if (jacobian && !found.differentiate(changes(at, X_WE, stiffness))) return false;
    predict_wrench(at, i, found, prediction, jacobian);
    if (seen_[i].cols() == 0) continue;
    if (markers_.empty()) {
      predict_cloud(i, found, prediction, jacobian);
    } else {
      predict_markers(i, found, prediction, jacobian);
    }
  }
  return true;
}

void HeldObject::predict_wrench(const State& state, int sample, const HeldEquilibrium& found,
                                Eigen::VectorXd& prediction, Eigen::MatrixXd* jacobian) const {
  const math::Pose X_WS = recording_.samples[sample].X_WE * cell_.frames.X_ES;
  const math::Pose X_SG = cell_.frames.X_ES.inverse() * cell_.frames.X_EG;
  const Matrix3d R_SO = X_WS.linear().transpose() * cell_.frames.X_WO.linear();
  const Vector3d p_SG = X_SG * state.offset.translation();
  math::Matrix6d to_S = math::Matrix6d::Zero();  // of wrenches at the origin of G, in O
  to_S.topLeftCorner<3, 3>() = R_SO;
  to_S.bottomRightCorner<3, 3>() = R_SO;
  to_S.bottomLeftCorner<3, 3>() = math::cross_matrix(p_SG) * R_SO;
  const sensing::PayloadRegressor regressor =
      sensing::load_regressor(sensing::motion_at_rest(X_WS.linear(), cell_.frames.gravity_W));
  const math::Vector6d wrench =
      to_S * found.wrench().vector() + regressor * sensing::to_vector(state.hand);
  const int n = samples();
  for (int k = 0; k < 6; ++k) prediction[k * n + sample] = wrench[k];
  if (!jacobian) return;

  HeldEquilibrium::Columns rows = to_S * found.wrench_columns();
  if (grasp_ >= 0) {
    const Vector3d force = R_SO * found.wrench().force;  // its lever arm follows the offset
    rows.block<3, 3>(3, grasp_) -= math::cross_matrix(force) * X_SG.linear();
  }
  if (bias_ >= 0) rows.middleCols<6>(bias_) = regressor.rightCols<6>();
  if (mass_ >= 0) rows.middleCols<4>(mass_) = regressor.leftCols<4>();
  for (int k = 0; k < 6; ++k) jacobian->row(k * n + sample) = rows.row(k);
}

void HeldObject::predict_markers(int sample, const HeldEquilibrium& found,
                                 Eigen::VectorXd& prediction, Eigen::MatrixXd* jacobian) const {
  int row = first_row_[sample];
  for (const mesh::PointWeights& marker : markers_) {
    prediction.segment<3>(row) = marker.interpolate(found.positions());
    for (int i = 0; jacobian && i < marker.count; ++i)
      jacobian->middleRows<3>(row) += marker.weights[i] * found.node_columns(marker.nodes[i]);
    row += 3;
  }
}

/// Distances change as the closest surface point moves towards the observed one.
void HeldObject::predict_cloud(int sample, const HeldEquilibrium& found,
                               Eigen::VectorXd& prediction, Eigen::MatrixXd* jacobian) const {
  contact::SurfaceMatcher matcher(cell_.object.surface, kFootSteps);
  matcher.take(found.positions());
  int row = first_row_[sample];
  for (Eigen::Index i = 0; i < seen_[sample].cols(); ++i, ++row) {
    const Vector3d p = seen_[sample].col(i);
    const contact::SurfaceMatch match = matcher.find(p);
    const Vector3d gap = p - match.position;
    const double side = gap.dot(match.normal) < 0 ? -1 : 1;
    prediction[row] = side * match.distance;
    if (!jacobian) continue;
    const Vector3d direction =
        match.distance > 1e-9 ? Vector3d(side / match.distance * gap) : match.normal;
    for (int k = 0; k < match.count; ++k)
      jacobian->row(row) -=
          match.weights[k] * direction.transpose() * found.node_columns(match.nodes[k]);
  }
}

std::array<double, 2> HeldObject::strain_range() const {
  const mesh::ElementMesh& mesh = cell_.object.body.mesh;
  std::array<double, 2> range{0, 0};
  for (const Matrix3Xd& shape : shapes_) {
    for (int e = 0; e < mesh.element_count(); ++e) {
      Matrix3d rest, now;
      for (int k = 0; k < 3; ++k) {
        rest.col(k) = mesh.nodes.col(mesh.elements(k + 1, e)) - mesh.nodes.col(mesh.elements(0, e));
        now.col(k) = shape.col(mesh.elements(k + 1, e)) - shape.col(mesh.elements(0, e));
      }
      const Vector3d stretches = Eigen::JacobiSVD<Matrix3d>(now * rest.inverse()).singularValues();
      range[0] = std::min(range[0], stretches[2] - 1);
      range[1] = std::max(range[1], stretches[0] - 1);
    }
  }
  return range;
}

}  // namespace palpate::fit
