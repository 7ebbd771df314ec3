#include "tools/fit/solver.hpp"

#include <ceres/ceres.h>
#include <glog/logging.h>

#include <cmath>
#include <limits>
#include <mutex>
#include <stdexcept>

#include "core/math/random.hpp"

namespace palpate::fit {
namespace {

/// Residuals of one member as a function of the coordinates that are not held.
class MemberCost final : public ceres::CostFunction {
 public:
  MemberCost(const Problem& problem, const Loss& loss, int member, const Eigen::VectorXd& base,
             const std::vector<Eigen::Index>& moving)
      : problem_(problem), loss_(loss), member_(member), base_(base), moving_(moving) {
    set_num_residuals(static_cast<int>(problem.residual_count(member)));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(moving.size()));
  }

  bool Evaluate(const double* const* parameters, double* residuals,
                double** jacobians) const override {
    Eigen::VectorXd x = base_;
    for (std::size_t k = 0; k < moving_.size(); ++k) x[moving_[k]] = parameters[0][k];
    const bool wants_jacobian = jacobians != nullptr && jacobians[0] != nullptr;
    Eigen::VectorXd r;
    Eigen::MatrixXd J;
    if (!problem_.residuals(member_, x, r, wants_jacobian ? &J : nullptr)) return false;
    const auto columns = static_cast<Eigen::Index>(moving_.size());
    for (Eigen::Index i = 0; i < r.size(); ++i) {
      const double slope = loss_.apply(r[i]);
      residuals[i] = r[i];
      if (!wants_jacobian) continue;
      for (Eigen::Index k = 0; k < columns; ++k)
        jacobians[0][i * columns + k] = slope * J(i, moving_[k]);
    }
    return true;
  }

 private:
  const Problem& problem_;
  Loss loss_;
  int member_;
  Eigen::VectorXd base_;
  std::vector<Eigen::Index> moving_;
};

class Reporter final : public ceres::IterationCallback {
 public:
  explicit Reporter(std::function<bool(int, double)> report) : report_(std::move(report)) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    return report_(summary.iteration, summary.cost) ? ceres::SOLVER_CONTINUE
                                                    : ceres::SOLVER_TERMINATE_SUCCESSFULLY;
  }

 private:
  std::function<bool(int, double)> report_;
};

ceres::Solver::Options ceres_options(const SolverOptions& options) {
  ceres::Solver::Options result;
  result.linear_solver_type = ceres::DENSE_QR;
  result.max_num_iterations = options.iterations;
  result.num_threads = options.threads;
  result.function_tolerance = options.tolerance;
  result.parameter_tolerance = options.tolerance;
  result.gradient_tolerance = 1e-14;
  result.logging_type = ceres::SILENT;
  result.update_state_every_iteration = true;
  return result;
}

}  // namespace

double cost_at(const Problem& problem, const Loss& loss, const Eigen::VectorXd& coordinates) {
  double sum = 0;
  Eigen::VectorXd r;
  for (std::size_t m = 0; m < problem.members().size(); ++m) {
    if (!problem.residuals(static_cast<int>(m), coordinates, r, nullptr))
      return std::numeric_limits<double>::infinity();
    for (double value : r) {
      loss.apply(value);
      sum += value * value;
    }
  }
  return sum / 2;
}

Solution solve(const Problem& problem, const SolverOptions& options, const Eigen::VectorXd& start,
               const std::vector<bool>& held) {
  // A start without equilibrium is reported by an exception, not on standard error. Fits run in
  // parallel.
  static std::once_flag silenced;
  std::call_once(silenced, [] { FLAGS_minloglevel = google::GLOG_FATAL; });
  const Eigen::VectorXd lower = problem.lower(), upper = problem.upper();
  std::vector<Eigen::Index> moving;
  for (Eigen::Index i = 0; i < start.size(); ++i)
    if (held.empty() || !held[i]) moving.push_back(i);
  Solution solution;
  solution.coordinates = start.cwiseMax(lower).cwiseMin(upper);
  if (moving.empty()) {
    solution.cost = cost_at(problem, options.loss, solution.coordinates);
    solution.is_converged = std::isfinite(solution.cost);
    return solution;
  }
  std::vector<double> block;
  for (const Eigen::Index i : moving) block.push_back(solution.coordinates[i]);

  ceres::Problem ceres_problem;
  for (std::size_t m = 0; m < problem.members().size(); ++m) {
    if (problem.residual_count(static_cast<int>(m)) == 0) continue;
    ceres_problem.AddResidualBlock(
        new MemberCost(problem, options.loss, static_cast<int>(m), solution.coordinates, moving),
        nullptr, block.data());
  }
  for (std::size_t k = 0; k < moving.size(); ++k) {
    ceres_problem.SetParameterLowerBound(block.data(), static_cast<int>(k), lower[moving[k]]);
    ceres_problem.SetParameterUpperBound(block.data(), static_cast<int>(k), upper[moving[k]]);
  }
  const auto store = [&] {
    for (std::size_t k = 0; k < moving.size(); ++k) solution.coordinates[moving[k]] = block[k];
  };
  ceres::Solver::Options settings = ceres_options(options);
  Reporter reporter([&](int iteration, double cost) {
    store();
    return !options.progress || options.progress(iteration, cost, solution.coordinates);
  });
  settings.callbacks.push_back(&reporter);
  ceres::Solver::Summary summary;
  ceres::Solve(settings, &ceres_problem, &summary);
  store();
  if (summary.termination_type == ceres::FAILURE)
    throw std::runtime_error(
        "no equilibrium with the parameters that the search starts from; give "
        "other `parameters: {NAME: {start: ...}}`");
  solution.cost = summary.final_cost;
  solution.iterations = summary.num_successful_steps + summary.num_unsuccessful_steps;
  solution.is_converged = summary.termination_type == ceres::CONVERGENCE;
  solution.message = summary.message;
  return solution;
}

Solution solve_from_many(const Problem& problem, const SolverOptions& options,
                         const Eigen::VectorXd& start) {
  constexpr double kReach = 3;  // of a logarithm: a factor of 20
  Solution best = solve(problem, options, start);
  math::Random random(static_cast<std::uint64_t>(options.seed), "starts");
  const Eigen::VectorXd lower = problem.lower(), upper = problem.upper();
  for (int k = 1; k < options.starts; ++k) {
    Eigen::VectorXd x = start;
    for (Eigen::Index i = 0; i < x.size(); ++i)
      x[i] = random.uniform(std::max(lower[i], start[i] - kReach),
                            std::min(upper[i], start[i] + kReach));
    try {
      Solution other = solve(problem, options, x);
      other.iterations += best.iterations;
      if (other.cost < best.cost)
        best = other;
      else
        best.iterations = other.iterations;
    } catch (const std::runtime_error&) {  // a start without equilibrium
    }
  }
  return best;
}

}  // namespace palpate::fit
