#include "tests/bench/core/elasticity/recovery.hpp"

#include <algorithm>
#include <cstdio>

#include "core/math/random.hpp"
#include "tests/bench/core/elasticity/baseline_system.hpp"

namespace palpate::bench {
namespace {

using Eigen::Matrix3Xd;

constexpr long kStay = 200;  // steps at rest before it counts

Matrix3Xd wrecked(const elasticity::Body& body, Start start, std::uint64_t seed) {
  Matrix3Xd x = body.mesh.nodes;
  const Eigen::Vector3d size = x.rowwise().maxCoeff();
  math::Random random(seed, "random start");
  for (int i = 0; i < x.cols(); ++i) {
    if (start == Start::kMirrored) {
      x(0, i) = -x(0, i);
    } else {
      for (int axis = 0; axis < 3; ++axis) x(axis, i) = random.uniform(0, size(axis));
    }
  }
  for (int i : body.grasps[0].nodes) x.col(i) = body.mesh.nodes.col(i);
  return x;
}

}  // namespace

RecoveryResult run_recovery(const RecoveryOptions& options) {
  constexpr double kStepTime = 1e-3;
  RecoveryResult result;
  const Scenario scenario(options.mesh, Motion::kStep, options.young_modulus);
  elasticity::Body body = scenario.body();
  body.damping.mass_factor = options.mass_damping;
  const BaselineSystem elements(body);
  const auto model = make_model(body, options.mechanics, options.solver);
  RefactorService service(options.refactor);
  const double begin = wall_time();
  model->restore(wrecked(body, options.start, options.seed),
                 Matrix3Xd::Zero(3, body.mesh.nodes.cols()));

  const auto limit = static_cast<long>(options.seconds / kStepTime);
  long tangled = 0, restless = 0;  // last such step
  for (long k = 1; k <= limit && k < restless + kStay; ++k) {
    const double cpu = thread_time();
    service.collect(*model, k);
    const elasticity::StepReport report = model->step(kStepTime);
    service.request(*model, k);
    result.slowest_step = std::max(result.slowest_step, thread_time() - cpu);
    service.run_here();
    result.steps = k;
    result.failed += report.status == elasticity::StepStatus::kFailed;
    const Matrix3Xd& x = model->positions();
    if (!x.allFinite()) {
      result.is_finite = false;
      break;
    }
    result.error = (x - body.mesh.nodes).colwise().norm().maxCoeff();
    result.inverted = elements.inverted(x);
    if (result.inverted > 0) tangled = k;
    if (result.error > kRest) restless = k;
  }
  result.total = wall_time() - begin;
  result.refactorisations = service.count();
  if (!result.is_finite) return result;
  if (result.inverted == 0) result.untangled_at = kStepTime * static_cast<double>(tangled);
  if (result.error <= kRest) result.at_rest = kStepTime * static_cast<double>(restless);
  result.is_recovered = result.inverted == 0 && result.error <= kRest;
  return result;
}

int run_recoveries(const RecoveryOptions& common, std::ostream& out) {
  using mesh::ElementOrder;
  int bad = 0;
  char line[200];
  std::snprintf(line, sizeof line, "%-32s %-9s %9s %9s %8s %8s %7s %7s %7s %7s %7s\n", "", "",
                "untangled", "at rest", "inverted", "error", "steps", "failed", "factors", "wall s",
                "max ms");
  out << line;
  for (const auto& [order, nodes] : {std::pair{ElementOrder::kLinear, 304},
                                     {ElementOrder::kLinear, 1008},
                                     {ElementOrder::kQuadratic, 225},
                                     {ElementOrder::kQuadratic, 475},
                                     {ElementOrder::kQuadratic, 1225}}) {
    for (const auto mechanics : {Mechanics::kDynamic, Mechanics::kQuasistatic}) {
      for (const auto start : {Start::kMirrored, Start::kRandom}) {
        RecoveryOptions options = common;
        options.mesh = bar_of(order, nodes);
        options.mechanics = mechanics;
        options.start = start;
        const std::string name = options.mesh.text() +
                                 (mechanics == Mechanics::kDynamic ? " dynamic" : " static") +
                                 (start == Start::kMirrored ? " mirrored" : " random");
        if (name.find(common.only) == std::string::npos) continue;
        const RecoveryResult r = run_recovery(options);
        bad += !r.is_recovered;
        const char* verdict = r.is_recovered ? "recovered" : r.is_finite ? "LOST" : "NAN";
        std::snprintf(line, sizeof line,
                      "%-32s %-9s %9.3f %9.3f %8d %8.1e %7ld %7ld %7ld %7.1f %7.2f\n", name.c_str(),
                      verdict, r.untangled_at, r.at_rest, r.inverted, r.error, r.steps, r.failed,
                      r.refactorisations, r.total, 1e3 * r.slowest_step);
        out << line << std::flush;
      }
    }
  }
  return bad;
}

}  // namespace palpate::bench
