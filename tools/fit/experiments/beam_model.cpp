#include "tools/fit/experiments/beam_model.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/mesh/grid_mesh.hpp"
#include "core/solid/solid_motion.hpp"

namespace palpate::fit {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

using Slope3 = Eigen::Matrix<double, 3, kBeamParameters>;

constexpr double kBeamModelGravity = 9.81;  // m/s^2
constexpr solid::SolidOptions kExact{60, 1e-12, 32};
// Variables by which the finite elements are differentiated: material, inertia and damping,
// gravity's direction by tilt, and the initial shape.
constexpr int kSolved[] = {kYoung,    kPoisson,  kDensity,  kMassDamping, kStiffnessDamping,
                           kTilt + 0, kTilt + 1, kTilt + 2, kHeldSag};

mesh::GridPlanes planes(const BeamShape& shape) {
  if (!(shape.size.minCoeff() > 0) || *std::min_element(shape.cells.begin(), shape.cells.end()) < 1)
    throw std::invalid_argument("a beam needs a positive size and at least one cell each way");
  return mesh::even_planes(shape.corner, shape.size, shape.cells);
}

/// Nodal shares of a load distributed uniformly along the upper edge of the free end.
Eigen::VectorXd edge_shares(const BeamShape& shape, const mesh::ElementMesh& mesh,
                            const mesh::PointLocator& locator) {
  constexpr int kPoints = 64;
  Eigen::VectorXd shares = Eigen::VectorXd::Zero(mesh.node_count());
  for (int k = 0; k < kPoints; ++k) {
    const Vector3d along(1, (k + 0.5) / kPoints, 1);
    const mesh::PointWeights w = locator.locate(shape.corner + shape.size.cwiseProduct(along));
    for (int i = 0; i < w.count; ++i) shares[w.nodes[i]] += w.weights[i] / kPoints;
  }
  return shares;
}

/// Lagrange's cubic through four values at steps -1, 0, 1, 2, at `s` in [0, 1]; or its derivative.
Eigen::Vector4d cubic(double s, bool derivative) {
  Eigen::Vector4d w;
  if (derivative) {
    w << -(3 * s * s - 6 * s + 2) / 6, (3 * s * s - 4 * s - 1) / 2, -(3 * s * s - 2 * s - 2) / 2,
        (3 * s * s - 1) / 6;
  } else {
    w << -s * (s - 1) * (s - 2) / 6, (s + 1) * (s - 1) * (s - 2) / 2, -(s + 1) * s * (s - 2) / 2,
        (s + 1) * s * (s - 1) / 6;
  }
  return w;
}

}  // namespace

SurfaceMarker::SurfaceMarker(const mesh::PointLocator& locator, const Vector3d& corner,
                             const Vector3d& size, const Vector3d& place) {
  const Vector3d far = corner + size;
  const Vector3d foot = place.cwiseMax(corner).cwiseMin(far);
  int normal = 0;
  (place - foot).cwiseAbs().maxCoeff(&normal);
  stand_ = place[normal] - foot[normal];
  foot_ = locator.locate(foot);
  const auto span = [&](int axis) {
    const Vector3d step = 1e-3 * size[axis] * Vector3d::Unit(axis);
    return Span{locator.locate((foot + step).cwiseMin(far)),
                locator.locate((foot - step).cwiseMax(corner))};
  };
  first_ = span((normal + 1) % 3);
  second_ = span((normal + 2) % 3);
}

Vector3d SurfaceMarker::position(const Matrix3Xd& x) const {
  return foot_.interpolate(x) + stand_ * first_.of(x).cross(second_.of(x)).normalized();
}

Vector3d SurfaceMarker::slope(const Matrix3Xd& x, const Matrix3Xd& dx) const {
  const Vector3d a = first_.of(x), b = second_.of(x), area = a.cross(b);
  const Vector3d turned = first_.of(dx).cross(b) + a.cross(second_.of(dx));
  const Vector3d n = area.normalized();
  return foot_.interpolate(dx) + stand_ / area.norm() * (turned - n * n.dot(turned));
}

/// Orientation of the clamp, and the resulting gravity in the beam's own frame.
struct BeamModel::Clamp {
  Clamp(const BeamVector& p, const Vector3d& face) : centre(face) {
    const Vector3d tilt = p.segment<3>(kTilt);
    rotation = math::exp_rotation(tilt);
    offset = p.segment<3>(kOffset);
    const Matrix3d jacobian = math::inverse_left_jacobian(tilt).inverse();
    for (int k = 0; k < 3; ++k) by_tilt[k] = math::cross_matrix(jacobian.col(k)) * rotation;
  }
  Vector3d gravity() const { return rotation.transpose() * Vector3d(0, 0, -kBeamModelGravity); }
  Vector3d gravity_by_tilt(int k) const {
    return by_tilt[k].transpose() * Vector3d(0, 0, -kBeamModelGravity);
  }

  Vector3d centre, offset;
  Matrix3d rotation;
  std::array<Matrix3d, 3> by_tilt;
};

BeamModel::BeamModel(BeamShape shape) : shape_(std::move(shape)) {
  const mesh::ElementMesh mesh = mesh::make_element_mesh(
      mesh::make_grid(planes(shape_), mesh::CellCut::kFive), mesh::ElementOrder::kQuadratic);
  std::vector<int> clamped;
  for (int i = 0; i < mesh.node_count(); ++i) {
    if (mesh.nodes(0, i) < shape_.corner.x() + 1e-9) clamped.push_back(i);
  }
  body_ = std::make_unique<solid::SolidBody>(mesh, clamped);
  const mesh::PointLocator locator(body_->mesh());
  nodal_mass_ = shape_.tip_mass * edge_shares(shape_, mesh, locator);
  for (const Vector3d& marker : shape_.markers) {
    markers_.emplace_back(locator, shape_.corner, shape_.size, marker);
  }
}

std::vector<solid::SolidSlope> BeamModel::slopes(const BeamVector& p, const Clamp& clamp) const {
  const solid::SolidMaterial material = solid::make_solid_material(p[kYoung], p[kPoisson]);
  std::vector<solid::SolidSlope> result(kBeamParameters);
  result[kYoung].coefficients = material.by_young;
  result[kPoisson].coefficients = material.by_poisson;
  result[kDensity].density = 1;
  result[kDensity].load = clamp.gravity() * body_->nodal_volume().transpose();
  result[kMassDamping].mass_factor = 1;
  result[kStiffnessDamping].stiffness_factor = 1;
  const Eigen::VectorXd mass = p[kDensity] * body_->nodal_volume() + nodal_mass_;
  for (int k = 0; k < 3; ++k) result[kTilt + k].load = clamp.gravity_by_tilt(k) * mass.transpose();
  return result;
}

void BeamModel::place(const Clamp& clamp, const Vector3d& p, const Slope3& dp, Vector3d& displaced,
                      Slope3& slope) const {
  const Vector3d arm = p - clamp.centre;
  displaced = clamp.rotation * arm + clamp.centre + clamp.offset;
  slope = clamp.rotation * dp;
  for (int k = 0; k < 3; ++k) slope.col(kTilt + k) += clamp.by_tilt[k] * arm;
  slope.block<3, 3>(0, kOffset) += Matrix3d::Identity();
}

bool BeamModel::at_rest(const BeamVector& p, BeamPrediction& prediction) const {
  const Vector3d half(0, shape_.size.y() / 2, shape_.size.z() / 2);
  const Clamp clamp(p, shape_.corner + half);
  const Eigen::VectorXd mass = p[kDensity] * body_->nodal_volume() + nodal_mass_;
  solid::SolidSolver solver(*body_);
  Matrix3Xd x = body_->mesh().nodes;
  const auto material = solid::make_solid_material(p[kYoung], p[kPoisson]).coefficients;
  if (!solver.solve(material, clamp.gravity() * mass.transpose(), x, kExact)) return false;
  std::vector<Matrix3Xd> dx;
  for (const solid::SolidSlope& slope : slopes(p, clamp)) {
    dx.push_back(solver.sensitivity(x, slope));
  }

  const auto count = static_cast<Eigen::Index>(markers_.size() + shape_.clamp_markers.size());
  prediction.values.resize(3 * count);
  prediction.slopes.resize(3 * count, kBeamParameters);
  const auto write = [&](Eigen::Index marker, const Vector3d& rest, const Vector3d& position,
                         const Slope3& slope) {
    Vector3d displaced;
    Slope3 by;
    place(clamp, position, slope, displaced, by);
    prediction.values.segment<3>(3 * marker) = displaced - rest;
    prediction.slopes.middleRows<3>(3 * marker) = by;
  };
  Eigen::Index marker = 0;
  for (const SurfaceMarker& m : markers_) {
    Slope3 slope = Slope3::Zero();
    for (int k : kSolved) slope.col(k) = m.slope(x, dx[k]);
    write(marker++, m.position(body_->mesh().nodes), m.position(x), slope);
  }
  for (const Vector3d& m : shape_.clamp_markers) write(marker++, m, m, Slope3::Zero());
  return true;
}

bool BeamModel::swing(const BeamVector& p, const Eigen::VectorXd& times, double step,
                      BeamPrediction& prediction) const {
  const Vector3d half(0, shape_.size.y() / 2, shape_.size.z() / 2);
  const Clamp clamp(p, shape_.corner + half);
  solid::SolidMotionProblem problem;
  problem.coefficients = solid::make_solid_material(p[kYoung], p[kPoisson]).coefficients;
  problem.density = p[kDensity];
  problem.nodal_mass = nodal_mass_;
  problem.loads = clamp.gravity() * (p[kDensity] * body_->nodal_volume() + nodal_mass_).transpose();
  problem.damping = {p[kMassDamping], p[kStiffnessDamping]};
  solid::SolidSolver solver(*body_);
  std::vector<solid::SolidSlope> by = slopes(p, clamp);
  Matrix3Xd held = body_->mesh().nodes;
  if (!solver.solve(problem.coefficients, p[kHeldSag] * problem.loads, held, kExact)) return false;
  for (int k : kSolved) {
    solid::SolidSlope share = by[k];
    share.load = k == kHeldSag ? problem.loads : Matrix3Xd(p[kHeldSag] * share.load);
    by[k].start = solver.sensitivity(held, share);
  }
  solid::SolidMotion motion(solver, problem, held, step, by);

  // Heights and their derivatives step by step; at rest before the release.
  const double last = times.size() > 0 ? times.tail<1>()[0] - p[kRelease] : 0;
  const int steps = std::max(0, static_cast<int>(std::floor(last / step))) + 2;
  Eigen::VectorXd heights(steps + 1);
  Eigen::Matrix<double, Eigen::Dynamic, kBeamParameters> heights_by(steps + 1, kBeamParameters);
  for (int i = 0; i <= steps; ++i) {
    if (i > 0 && !motion.advance()) return false;
    double height = 0;
    Eigen::Matrix<double, 1, kBeamParameters> row = decltype(row)::Zero();
    for (const SurfaceMarker& m : markers_) {
      Slope3 slope = Slope3::Zero(), placed;
      Vector3d displaced;
      for (int k : kSolved) {
        slope.col(k) = m.slope(motion.positions(), motion.position_slope(k));
      }
      place(clamp, m.position(motion.positions()), slope, displaced, placed);
      height += displaced.z() - m.position(body_->mesh().nodes).z();
      row += placed.row(2);
    }
    heights[i] = height / static_cast<double>(markers_.size());
    heights_by.row(i) = row / static_cast<double>(markers_.size());
  }
  prediction.values.resize(times.size());
  prediction.slopes.resize(times.size(), kBeamParameters);
  for (Eigen::Index i = 0; i < times.size(); ++i) {
    const double s = (times[i] - p[kRelease]) / step;
    if (s <= 0) {
      prediction.values[i] = heights[0];
      prediction.slopes.row(i) = heights_by.row(0);
      continue;
    }
    const int cell = static_cast<int>(s);
    const Eigen::Vector4d w = cubic(s - cell, false), d = cubic(s - cell, true);
    prediction.values[i] = 0;
    prediction.slopes.row(i).setZero();
    for (int k = 0; k < 4; ++k) {
      const int at = std::abs(cell + k - 1);  // released at rest, motion is even in time
      prediction.values[i] += w[k] * heights[at];
      prediction.slopes.row(i) += w[k] * heights_by.row(at);
      prediction.slopes(i, kRelease) -= d[k] * heights[at] / step;
    }
  }
  return true;
}

}  // namespace palpate::fit
