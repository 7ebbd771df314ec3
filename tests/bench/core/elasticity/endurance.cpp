#include "tests/bench/core/elasticity/endurance.hpp"

#include <malloc.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iostream>

#include "core/math/random.hpp"
#include "rt/loop/allocation_counter.hpp"
#include "tests/bench/core/elasticity/baseline_system.hpp"
#include "tests/bench/core/elasticity/random_handling.hpp"
#include "tests/bench/core/elasticity/recovery.hpp"
#include "tools/common/table.hpp"

namespace palpate::bench {
namespace {

using common::number;
using elasticity::StepStatus;

constexpr double kDt = 1e-3;  // s
// Typical duration in steps of a background factorisation, in addition to a requested delay.
constexpr long kWaiting = 20;

struct Configuration {
  BarMesh mesh;
  Mechanics mechanics;
  double young_modulus;

  std::string text() const {
    return mesh.text() + (mechanics == Mechanics::kDynamic ? " dynamic" : " static");
  }
};

/// Totals over all segments of one configuration.
struct Tally {
  long segments = 0, steps = 0;
  long not_finite = 0;  // steps with such a position, velocity or reaction
  long waiting = 0;     // failed until the factorisation for a new or released grasp was available
  long failed = 0;      // failed otherwise
  long not_converged = 0;
  long overruns = 0;
  long allocations = 0;   // within steps
  double slowest = 0;     // s, thread time
  int inverted = 0;       // points, after release
  double rest_error = 0;  // m, after release
  long restless = 0;      // segments that did not come to rest

  void add(const Tally& other) {
    for (long Tally::*count :
         {&Tally::segments, &Tally::steps, &Tally::not_finite, &Tally::waiting, &Tally::failed,
          &Tally::not_converged, &Tally::overruns, &Tally::allocations, &Tally::restless}) {
      this->*count += other.*count;
    }
    inverted += other.inverted;
    slowest = std::max(slowest, other.slowest);
    rest_error = std::max(rest_error, other.rest_error);
  }
};

std::vector<Configuration> configurations() {
  std::vector<Configuration> all;
  for (const double e : {1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9}) {
    for (const auto mechanics : {Mechanics::kDynamic, Mechanics::kQuasistatic}) {
      all.push_back({bar_of(mesh::ElementOrder::kLinear, 304), mechanics, e});
      all.push_back({bar_of(mesh::ElementOrder::kQuadratic, 225), mechanics, e});
    }
  }
  return all;
}

bool is_finite(const elasticity::DeformationModel& model) {
  bool finite = model.positions().allFinite() && model.velocities().allFinite();
  for (std::size_t g = 0; g < model.body().grasps.size(); ++g) {
    finite = finite && model.reaction(static_cast<int>(g)).vector().allFinite();
  }
  return finite;
}

class Segment {
 public:
  Segment(const Configuration& c, const EnduranceOptions& options, long index)
      : options_(options),
        body_(make_handled_bar(
            mesh::make_element_mesh(mesh::make_box({0.2, 0.05, 0.05}, c.mesh.cells), c.mesh.order),
            c.young_modulus)),
        random_(options.seed, "segment " + std::to_string(index)),
        handling_(body_, options.most_load, random_.split("handling")),
        model_(make_free(c.mechanics)),
        service_(options.refactor) {
    if (random_.uniform() < 0.5) model_->set_gravity({0, 0, -9.81});
  }

  Tally run() {
    for (long k = 0; k < options_.segment_steps; ++k) {
      handling_.apply(kDt, *model_);
      step(true);
    }
    handling_.let_go(*model_);
    settle();
    tally_.segments = 1;
    return tally_;
  }

 private:
  std::unique_ptr<elasticity::CorotationalModel> make_free(Mechanics mechanics) const {
    elasticity::SolverOptions solver = options_.solver;
    solver.tolerance *= body_.material.young_modulus / 1e5;  // as the loads
    std::unique_ptr<elasticity::CorotationalModel> model;
    if (mechanics == Mechanics::kDynamic) {
      model = std::make_unique<elasticity::CorotationalDynamic>(body_, solver);
    } else {
      model = std::make_unique<elasticity::CorotationalQuasistatic>(body_, solver);
    }
    model->prepare();
    return model;
  }

  void step(bool is_counted) {
    ++step_;
    const double cpu = thread_time();
    const std::int64_t allocations = loop::allocations_of_this_thread();
    service_.collect(*model_, step_);
    const elasticity::StepReport report = model_->step(kDt);
    service_.request(*model_, step_);
    const std::int64_t allocated = loop::allocations_of_this_thread() - allocations;
    const double taken = thread_time() - cpu;
    service_.run_here();
    tally_.not_finite += !is_finite(*model_);
    if (!is_counted) return;
    ++tally_.steps;
    tally_.allocations += allocated;
    tally_.overruns += taken > options_.budget;
    tally_.slowest = std::max(tally_.slowest, taken);
    if (report.status == StepStatus::kFailed) {
      const bool is_waiting = handling_.since_change() <= kWaiting + 2 * options_.refactor.delay;
      ++(is_waiting ? tally_.waiting : tally_.failed);
    }
    tally_.not_converged += report.status == StepStatus::kNotConverged;
  }

  void settle() {
    const BaselineSystem points(body_);
    constexpr long kMost = 20000, kStaySteps = 200;
    long restless = 0;
    for (long k = 1; k <= kMost && k < restless + kStaySteps; ++k) {
      step(false);
      tally_.rest_error = (model_->positions() - body_.mesh.nodes).colwise().norm().maxCoeff();
      if (!(tally_.rest_error <= kRest)) restless = k;
    }
    tally_.restless = !(tally_.rest_error <= kRest);
    tally_.inverted = points.inverted(model_->positions());
  }

  const EnduranceOptions& options_;
  elasticity::Body body_;
  math::Random random_;
  RandomHandling handling_;
  std::unique_ptr<elasticity::CorotationalModel> model_;
  RefactorService service_;
  Tally tally_;
  long step_ = 0;
};

double heap_bytes() { return static_cast<double>(mallinfo2().uordblks + mallinfo2().hblkhd); }

double resident_bytes() {
  std::ifstream statm("/proc/self/statm");
  double total = 0, resident = 0;
  statm >> total >> resident;
  return 4096 * resident;
}

void print(const std::vector<Configuration>& all, const std::vector<Tally>& tallies,
           std::ostream& out) {
  common::Table table({"model", "E Pa", "steps", "nan", "failed", "waiting", "not conv", "overrun",
                       "allocs", "max ms", "restless", "inverted", "rest m"});
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Tally& t = tallies[i];
    char e[16], rest[16];
    std::snprintf(e, sizeof e, "%.0e", all[i].young_modulus);
    std::snprintf(rest, sizeof rest, "%.1e", t.rest_error);
    const auto count = [](long n) { return std::to_string(n); };
    table.add({all[i].text(), e, count(t.steps), count(t.not_finite), count(t.failed),
               count(t.waiting), count(t.not_converged), count(t.overruns), count(t.allocations),
               number(1e3 * t.slowest, 2), count(t.restless) + "/" + count(t.segments),
               count(t.inverted), rest});
  }
  table.print(out);
}

}  // namespace

bool run_endurance(const EnduranceOptions& options, std::ostream& out) {
  // Freed memory retained by the allocator counts as used, and varies by some kB.
  constexpr double kLeak = 32768;
  const std::vector<Configuration> all = configurations();
  std::vector<Tally> tallies(all.size());
  const long segments = std::max(1L, options.steps / std::max(1L, options.segment_steps));
  const auto cycle = static_cast<long>(all.size());
  double heap_first = 0, resident_first = 0, heap_last = 0;
  const double begin = wall_time();
  long not_finite = 0;
  for (long s = 0; s < segments; ++s) {
    const long index = options.first_segment + s;
    const auto which = static_cast<std::size_t>(index % cycle);
    const Tally tally = Segment(all[which], options, index).run();
    tallies[which].add(tally);
    not_finite += tally.not_finite;
    if (tally.restless > 0 || tally.not_finite > 0) {
      out << "segment " << index << ", " << all[which].text() << ", "
          << (tally.not_finite > 0 ? "is not finite" : "did not come to rest") << '\n';
    }
    std::cerr << '\r' << (s + 1) * options.segment_steps << " steps, " << not_finite
              << " not finite, " << number(wall_time() - begin, 0) << " s   " << std::flush;
    if (s + 1 == cycle) {
      heap_first = heap_bytes();
      resident_first = resident_bytes();
    }
    if ((s + 1) % cycle == 0) heap_last = heap_bytes();
  }
  std::cerr << '\n';
  print(all, tallies, out);
  const bool leaks = segments >= 2 * cycle && heap_last > heap_first + kLeak;
  if (segments >= 2 * cycle) {
    out << "heap after the first and the last round: " << number(heap_first / 1024, 1) << " and "
        << number(heap_last / 1024, 1) << " kB" << (leaks ? "  LEAK" : "") << "; resident "
        << number(resident_first / 1048576, 1) << " and " << number(resident_bytes() / 1048576, 1)
        << " MB\n";
  } else {
    out << "too short for a second round of all models: leaks not looked for\n";
  }
  return not_finite == 0 && !leaks;
}

}  // namespace palpate::bench
