#include "tests/support/quadratic_programs/certificate.hpp"

#include <Eigen/Cholesky>
#include <cmath>

namespace palpate::support {
namespace {

using math::QuadraticProgram;
using math::QuadraticProgramSolver;
using Real = long double;
using Vector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;
using Matrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;

Matrix symmetric(const QuadraticProgram& program) {
  return Matrix(program.H.cast<Real>().selfadjointView<Eigen::Lower>());
}
Matrix normals(const QuadraticProgram& program) {
  return program.A.leftCols(program.rows()).cast<Real>();
}

}  // namespace

Scales::Scales(const QuadraticProgram& qp) {
  const Eigen::LLT<Matrix> cholesky(symmetric(qp));
  const Vector free_optimum = -cholesky.solve(qp.g.cast<Real>().eval());
  const Matrix A = normals(qp);
  norm = A.cwiseProduct(cholesky.solve(A)).colwise().sum().cwiseSqrt().transpose().cast<double>();
  double worst = 0;
  for (int i = 0; i < qp.rows(); ++i) {
    if (norm[i] == 0) continue;
    const double value = static_cast<double>(A.col(i).dot(free_optimum));
    const double low = std::min(qp.bounds[i].lower, qp.bounds[i].upper);
    const double high = std::max(qp.bounds[i].lower, qp.bounds[i].upper);
    worst = std::max({worst, (value - high) / norm[i], (low - value) / norm[i]});
  }
  const Vector y = cholesky.matrixU() * free_optimum;
  program = static_cast<double>(y.norm()) + worst;
  price.setConstant(qp.rows(), QuadraticProgram::kNoBound);
  for (int i = 0; i < qp.rows(); ++i) {
    const math::RowPriority& priority = qp.bounds[i].priority;
    if (priority.level == 0 || norm[i] == 0) continue;
    price[i] = std::pow(100, 4 - priority.level) * priority.weight * program / norm[i];
  }
}

OptimalityError optimality_error(const QuadraticProgram& program,
                                 const QuadraticProgramSolver& solver) {
  const Scales scales(program);
  const Matrix H = symmetric(program);
  const Matrix A = normals(program);
  const Vector u = solver.u().cast<Real>();
  const Vector lambda = solver.multipliers().cast<Real>();
  const Vector g = program.g.cast<Real>();

  OptimalityError error;
  const Vector rest = H * u + g + A * lambda;
  const Vector size = H.cwiseAbs() * u.cwiseAbs() + g.cwiseAbs() + A.cwiseAbs() * lambda.cwiseAbs();
  for (int k = 0; k < rest.size(); ++k) {
    if (size[k] == 0) continue;
    error.stationarity =
        std::max(error.stationarity, static_cast<double>(std::abs(rest[k]) / size[k]));
  }
  const double length = static_cast<double>(std::sqrt(u.dot(H * u)));
  for (int i = 0; i < program.rows(); ++i) {
    const auto& [lower, upper, priority] = program.bounds[i];
    const double value = static_cast<double>(A.col(i).dot(u));
    const double unit = scales.norm[i] * (scales.program + length);
    if (unit == 0) continue;
    const double low = std::min(lower, upper) - value;
    const double high = value - std::max(lower, upper);
    if (priority.level == 0)
      error.feasibility = std::max({error.feasibility, low / unit, high / unit});

    const double multiplier = solver.multipliers()[i];
    const double price = scales.price[i];
    // The bound is violated, or has a multiplier without being active.
    const double beyond = multiplier > 0 ? high : low;
    const bool pays_all = std::abs(multiplier) > price * (1 - 1e-9);
    double wrong = 0;
    if (std::abs(multiplier) > price * (1 + 1e-9)) wrong = 1;
    if (multiplier != 0 && beyond < 0) wrong = std::max(wrong, -beyond / unit);
    if (!pays_all) wrong = std::max({wrong, low / unit, high / unit});
    error.complementarity = std::max(error.complementarity, wrong);
  }
  return error;
}

bool proves_infeasibility(const QuadraticProgram& program, const QuadraticProgramSolver& solver) {
  const Vector lambda = solver.multipliers().cast<Real>();
  const Matrix A = normals(program);
  const Vector sum = A * lambda;
  const Vector size = A.cwiseAbs() * lambda.cwiseAbs();
  Real bound = 0;
  for (int i = 0; i < program.rows(); ++i) {
    const auto& [lower, upper, priority] = program.bounds[i];
    if (priority.level == 0 && lower > upper) return true;
    if (lambda[i] == 0) continue;
    if (priority.level != 0) return false;
    bound += lambda[i] * (lambda[i] > 0 ? upper : lower);
  }
  for (int k = 0; k < sum.size(); ++k) {
    if (std::abs(sum[k]) > 1e-9L * size[k]) return false;
  }
  return bound < 0;
}

}  // namespace palpate::support
