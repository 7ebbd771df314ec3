#include "core/solid/solid_motion.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace palpate::solid {
namespace {

using Eigen::Matrix3Xd;

constexpr int kIterations = 40;       // maximum number of Newton steps
constexpr double kTolerance = 1e-11;  // unbalanced forces relative to the largest force
constexpr double kSlow = 0.2;         // contraction above which a new factor is computed

}  // namespace

SolidMotion::SolidMotion(SolidSolver& solver, SolidMotionProblem problem, const Matrix3Xd& x,
                         double step, std::vector<SolidSlope> slopes)
    : solver_(solver),
      problem_(std::move(problem)),
      h_(step),
      now_(0.5 + problem_.damping.stiffness_factor / step),
      before_(0.5 - problem_.damping.stiffness_factor / step),
      slopes_(std::move(slopes)),
      volume_(solver.body().pattern()),
      mass_(solver.body().pattern()),
      stiffness_(solver.body().pattern()),
      x_(x),
      v_(Matrix3Xd::Zero(3, x.cols())),
      dx_(slopes_.size(), v_),
      dv_(slopes_.size(), v_) {
  if (!(step > 0)) throw std::invalid_argument("a motion needs a positive time step");
  for (std::size_t p = 0; p < slopes_.size(); ++p) {
    if (slopes_[p].start.size() > 0) dx_[p] = slopes_[p].start;
  }
  volume_.add_scalar(1, solver.body().volume_blocks());
  mass_.add(problem_.density, volume_);
  if (problem_.nodal_mass.size() > 0) {
    const factor::BlockPattern& pattern = solver.body().pattern();
    for (int k = 0; k < pattern.size(); ++k) {
      mass_.block(pattern.column_start()[k]).diagonal().array() +=
          problem_.nodal_mass(pattern.node(k));
    }
  }
  if (!std::isfinite(solver_.body().elements().forces(x_, problem_.coefficients, forces_))) {
    throw std::invalid_argument("a motion must not start inside out");
  }
  stiffness_ = solver.tangent(x_, problem_.coefficients);
  if (!factorise(stiffness_)) throw std::invalid_argument("a motion starts where it is unstable");
}

Matrix3Xd SolidMotion::times(const factor::BlockMatrix& matrix, const Matrix3Xd& u) {
  Matrix3Xd y(3, u.cols());
  matrix.multiply(u, y);
  return y;
}

double SolidMotion::energy() const {
  Matrix3Xd unused;
  const Matrix3Xd u = x_ - solver_.body().mesh().nodes;
  return solver_.body().elements().forces(x_, problem_.coefficients, unused) +
         0.5 * (v_.array() * times(mass_, v_).array()).sum() -
         (problem_.loads.array() * u.array()).sum();
}

Matrix3Xd SolidMotion::imbalance(const Matrix3Xd& x, const Matrix3Xd& forces) const {
  const double a = problem_.damping.mass_factor;
  const Matrix3Xd weighted = (2 / (h_ * h_) + a / h_) * (x - x_) - 2 / h_ * v_;
  Matrix3Xd r = times(mass_, weighted) + now_ * forces + before_ * forces_ - problem_.loads;
  solver_.clear_fixed(r);
  return r;
}

bool SolidMotion::factorise(const factor::BlockMatrix& stiffness) {
  factor::BlockMatrix matrix(solver_.body().pattern());
  matrix.add(now_, stiffness);
  matrix.add(2 / (h_ * h_) + problem_.damping.mass_factor / h_, mass_);
  return solver_.factorise(matrix);
}

bool SolidMotion::correct(Matrix3Xd& x, Matrix3Xd& forces) {
  const auto evaluate = [&] {
    return std::isfinite(solver_.body().elements().forces(x, problem_.coefficients, forces));
  };
  if (!evaluate()) return false;
  Matrix3Xd r = imbalance(x, forces);
  double scale = 0;
  for (int i = 0; i < kIterations; ++i) {
    scale = std::max({largest_norm(forces), largest_norm(problem_.loads), scale});
    const double size = largest_norm(r), small = kTolerance * scale + solver_.rounding();
    if (size <= small) return true;
    x += solver_.apply_inverse(-r);
    if (!evaluate()) return false;
    r = imbalance(x, forces);
    if (largest_norm(r) > kSlow * size && largest_norm(r) > small &&
        !factorise(solver_.tangent(x, problem_.coefficients))) {
      return false;
    }
  }
  return false;
}

bool SolidMotion::advance() {
  Matrix3Xd x = x_ + h_ * v_, forces;  // prediction with constant velocity
  if (!correct(x, forces)) {
    // the prediction may be inverted or far from the solution
    x = x_;
    if (!factorise(solver_.tangent(x_, problem_.coefficients)) || !correct(x, forces)) return false;
  }
  if (!slopes_.empty()) {
    factor::BlockMatrix stiffness = solver_.tangent(x, problem_.coefficients);
    if (!factorise(stiffness)) return false;
    carry_slopes(x, forces);
    stiffness_ = std::move(stiffness);
  }
  v_ = 2 / h_ * (x - x_) - v_;
  x_ = std::move(x);
  forces_ = std::move(forces);
  return true;
}

void SolidMotion::carry_slopes(const Matrix3Xd& x, const Matrix3Xd& forces) {
  const double a = problem_.damping.mass_factor;
  const Matrix3Xd moved = x - x_;
  const Matrix3Xd inertial = (2 / (h_ * h_) + a / h_) * moved - 2 / h_ * v_;
  Matrix3Xd of_material;
  for (std::size_t p = 0; p < slopes_.size(); ++p) {
    const SolidSlope& slope = slopes_[p];
    const Matrix3Xd carried = (2 / (h_ * h_) + a / h_) * dx_[p] + 2 / h_ * dv_[p];
    Matrix3Xd rhs = times(mass_, carried) - before_ * times(stiffness_, dx_[p]);
    if (slope.load.size() > 0) rhs += slope.load;
    if (!slope.coefficients.is_zero()) {
      solver_.body().elements().forces(x_, slope.coefficients, of_material);
      rhs -= before_ * of_material;
      solver_.body().elements().forces(x, slope.coefficients, of_material);
      rhs -= now_ * of_material;
    }
    if (slope.density != 0) rhs -= slope.density * times(volume_, inertial);
    rhs -= slope.mass_factor / h_ * times(mass_, moved);
    rhs -= slope.stiffness_factor / h_ * (forces - forces_);
    const Matrix3Xd next = solver_.apply_inverse(rhs);
    dv_[p] = 2 / h_ * (next - dx_[p]) - dv_[p];
    dx_[p] = next;
  }
}

}  // namespace palpate::solid
