#include "tools/fit/runner.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <mutex>
#include <thread>

#include "tools/common/interruption.hpp"
#include "tools/common/table.hpp"
#include "tools/fit/checkpoint.hpp"
#include "tools/fit/kinds.hpp"

namespace palpate::fit {
namespace {

using Eigen::VectorXd;

std::vector<std::string> names_of(const config::Node& node, const std::string& key) {
  return node.has(key) ? node.texts(key) : std::vector<std::string>();
}

/// Both searches; leaves the problem unchanged.
NumericComparison compare_numeric(Problem& problem, const SolverOptions& options,
                                  const VectorXd& start) {
  NumericComparison result;
  const auto search = [&](bool is_numeric, double& seconds, long& evaluations) {
    problem.is_numeric = is_numeric;
    const Problem::Count before = problem.count();
    const auto begin = std::chrono::steady_clock::now();
    const double cost = solve(problem, options, start).cost;
    seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    evaluations = problem.count().predictions + problem.count().jacobians - before.predictions -
                  before.jacobians;
    problem.is_numeric = false;
    return cost;
  };
  const double analytic = search(false, result.seconds, result.evaluations);
  const double numeric = search(true, result.seconds_numeric, result.evaluations_numeric);
  result.difference = std::abs(analytic - numeric) / std::max({analytic, numeric, 1e-300});
  return result;
}

/// Minimum and maximum over all members.
std::array<double, 2> strain_range_of(const Problem& problem) {
  std::array<double, 2> range{};
  for (const Member& member : problem.members()) {
    const std::array<double, 2> one = member.experiment->strain_range();
    range = {std::min(range[0], one[0]), std::max(range[1], one[1])};
  }
  return range;
}

/// Progress of a fit, for the progress line.
std::string note_of(int iteration, double cost) {
  return common::formatted("iteration %d, cost %.5g", iteration, cost);
}

class Run {
 public:
  Run(const Plan& plan, const RunOptions& options)
      : plan_(plan),
        options_(options),
        checkpoint_(options.checkpoint, plan.hash, options.resumes),
        results_(plan.jobs.size()) {}

  std::vector<JobResult> all() {
    const auto count = std::min<std::size_t>(
        plan_.jobs.size(), static_cast<std::size_t>(std::max(1, options_.threads)));
    std::vector<std::thread> threads;
    for (std::size_t k = 1; k < count; ++k) threads.emplace_back([this] { work(); });
    work();
    for (std::thread& thread : threads) thread.join();
    common::throw_if_interrupted();
    if (plan_.jobs.size() == 1 && first_error_) std::rethrow_exception(first_error_);
    if (first_error_ == nullptr) checkpoint_.remove();
    return std::move(results_);
  }

 private:
  void work() {
    while (!common::is_interrupted()) {
      const std::size_t k = next_++;
      if (k >= plan_.jobs.size()) return;
      try {
        results_[k] = one(plan_.jobs[k]);
      } catch (const std::exception& error) {
        results_[k].error = error.what();
        const std::lock_guard<std::mutex> lock(mutex_);
        if (!first_error_) first_error_ = std::current_exception();
      }
      ++done_;
      report(plan_.jobs[k].title());
    }
  }

  JobResult one(const Job& job) {
    JobResult result;
    result.problem = make_problem(job, options_.data);
    Problem& problem = *result.problem;
    const bool is_alone = plan_.jobs.size() == 1;
    FitOptions settings = job.options;
    settings.solver.threads = is_alone ? options_.threads : 1;
    const VectorXd start = checkpoint_.start(job.title(), problem);
    if (options_.checks_gradients) result.gradients = check_gradients(problem, start);
    if (options_.compares_numeric)
      result.numeric = compare_numeric(problem, settings.solver, start);
    settings.solver.progress = [&](int iteration, double cost, const VectorXd& x) {
      checkpoint_.keep(job.title(), problem, x, cost, false);
      if (is_alone) report(note_of(iteration, cost));
      return !common::is_interrupted();
    };
    result.fit = fit_problem(problem, settings, start);
    checkpoint_.keep(job.title(), problem, result.fit.solution.coordinates,
                     result.fit.solution.cost, true);
    if (options_.checks_gradients) {
      const std::vector<GradientCheck> here =
          check_gradients(problem, result.fit.solution.coordinates);
      result.gradients.insert(result.gradients.end(), here.begin(), here.end());
    }
    result.material = problem.members().front().experiment->material();
    result.strain_range = strain_range_of(problem);
    if (job.effective_strain > 0)
      result.strain_range = {std::max(result.strain_range[0], -job.effective_strain),
                             std::min(result.strain_range[1], job.effective_strain)};
    result.effective =
        effective_material(problem, result.fit, result.material, result.strain_range);
    return result;
  }

  void report(const std::string& note) {
    if (!options_.progress) return;
    const std::lock_guard<std::mutex> lock(mutex_);
    options_.progress(static_cast<double>(done_) / static_cast<double>(plan_.jobs.size()), note);
  }

  const Plan& plan_;
  const RunOptions& options_;
  Checkpoint checkpoint_;
  std::vector<JobResult> results_;
  std::atomic<std::size_t> next_{0};
  std::atomic<std::size_t> done_{0};
  std::mutex mutex_;
  std::exception_ptr first_error_;
};

}  // namespace

std::unique_ptr<Problem> make_problem(const Job& job, const std::filesystem::path& data) {
  std::vector<Member> members;
  for (const config::Node& node : job.recordings) {
    Member member;
    member.own = names_of(node, "own");
    member.shared = names_of(node, "shared");
    member.experiment = make_experiment(node, data);
    node.check_all_used();
    for (const Member& other : members)
      if (other.experiment->name() == member.experiment->name())
        node.fail("name", "'" + member.experiment->name() + "' comes twice; give each its own");
    members.push_back(std::move(member));
  }
  return std::make_unique<Problem>(std::move(members), job.parameters);
}

std::vector<JobResult> run(const Plan& plan, const RunOptions& options) {
  return Run(plan, options).all();
}

}  // namespace palpate::fit
