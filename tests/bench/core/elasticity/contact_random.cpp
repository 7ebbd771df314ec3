#include "tests/bench/core/elasticity/contact_random.hpp"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <map>

#include "core/elasticity/corotational_model.hpp"
#include "core/math/random.hpp"
#include "core/mesh/surface.hpp"
#include "rt/loop/allocation_counter.hpp"
#include "tests/bench/core/elasticity/samples.hpp"
#include "tests/unit/core/elasticity/bodies.hpp"
#include "tools/common/table.hpp"

namespace palpate::bench {
namespace {

using Eigen::Vector3d;

constexpr double kDt = 1e-3;     // s
constexpr double kThick = 0.03;  // m, of the bar
constexpr double kFine = 2e-3;   // of the thickness: accepted depth of a point
// Of the thickness: a point this deep is on its way through. The smallest obstacle is 0.8 thick.
constexpr double kThrough = 0.25;

/// Results of all segments of a model at a modulus.
struct RandomTally {
  long steps = 0, touching = 0, not_finite = 0, failed = 0, allocations = 0, deep = 0, through = 0;
  long overruns = 0;
  double slowest = 0, deepest = 0;  // s, m

  void add(const RandomTally& other) {
    for (long RandomTally::*count :
         {&RandomTally::steps, &RandomTally::touching, &RandomTally::not_finite,
          &RandomTally::failed, &RandomTally::allocations, &RandomTally::deep,
          &RandomTally::through, &RandomTally::overruns}) {
      this->*count += other.*count;
    }
    slowest = std::max(slowest, other.slowest);
    deepest = std::max(deepest, other.deepest);
  }
  bool is_good() const { return not_finite == 0 && allocations <= 0 && through == 0; }
};

struct Kind {
  mesh::ElementOrder order;
  bool dynamic;
  double young_modulus;  // Pa

  std::string name() const {
    return std::string(order == mesh::ElementOrder::kLinear ? "linear" : "quadratic") +
           (dynamic ? " dynamic" : " static");
  }
};

std::vector<Kind> kinds() {
  std::vector<Kind> all;
  for (const double e : {1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9}) {
    for (const bool dynamic : {false, true}) {
      all.push_back({mesh::ElementOrder::kQuadratic, dynamic, e});
      all.push_back({mesh::ElementOrder::kLinear, dynamic, e});
    }
  }
  return all;
}

/// One to three obstacles under the middle of the bar, whose tops are up to 6 mm below it.
std::vector<collision::Obstacle> random_obstacles(math::Random& random) {
  std::vector<collision::Obstacle> all;
  const int count = 1 + static_cast<int>(random.below(3));
  for (int i = 0; i < count; ++i) {
    const double r = random.uniform(0.012, 0.03), friction = random.uniform(0, 1.2);
    const double x = random.uniform(0.05, 0.13), drop = random.uniform(1e-3, 6e-3);
    const Eigen::Matrix3d across =
        elasticity::rotation(M_PI / 2, Vector3d::UnitX()) *
        elasticity::rotation(random.uniform(-0.5, 0.5), Vector3d::UnitY());
    const std::string name = std::to_string(i);
    switch (random.below(4)) {
      case 0:
        all.push_back({name, collision::Box{{0.04, 0.1, 0.05}},
                       math::make_pose(Eigen::Matrix3d::Identity(), {x, kThick / 2, -drop - 0.05}),
                       friction});
        break;
      case 1:
        all.push_back({name, collision::Sphere{r},
                       math::make_pose(Eigen::Matrix3d::Identity(), {x, kThick / 2, -drop - r}),
                       friction});
        break;
      case 2:
        all.push_back({name, collision::Cylinder{r},
                       math::make_pose(across, {x, kThick / 2, -drop - r}), friction});
        break;
      default:
        all.push_back({name, collision::Capsule{r, 0.1},
                       math::make_pose(across, {x, kThick / 2, -drop - r}), friction});
    }
  }
  return all;
}

/// A hand that moves between random poses above the height of the obstacles' tops.
class RandomHand {
 public:
  RandomHand(const math::Pose& rest, math::Random& random)
      : rest_(rest), random_(random), pose_(rest), goal_(rest) {}

  const math::Pose& next() {
    const Vector3d way = goal_.translation() - pose_.translation();
    const Vector3d turn = math::log_rotation(goal_.linear() * pose_.linear().transpose());
    if (way.norm() < 1e-6 && turn.norm() < 1e-6) aim();
    const auto bounded = [](const Vector3d& v, double most) -> Vector3d {
      return v * std::min(1.0, most / std::max(v.norm(), 1e-12));
    };
    pose_.translation() += bounded(way, speed_ * kDt);
    pose_.linear() = math::exp_rotation(bounded(turn, 5 * speed_ * kDt)) * pose_.linear();
    return pose_;
  }

 private:
  void aim() {
    speed_ = random_.uniform(0.005, 0.05);
    goal_ = rest_;
    goal_.translation() += Vector3d(random_.uniform(-0.01, 0), random_.uniform(-0.015, 0.015),
                                    random_.uniform(-0.012, 0.012));
    goal_.linear() = math::exp_rotation(Vector3d(
        random_.uniform(-0.2, 0.2), random_.uniform(-0.3, 0.3), random_.uniform(-0.2, 0.2)));
  }

  math::Pose rest_;
  math::Random& random_;
  math::Pose pose_, goal_;
  double speed_ = 0.01;  // m/s
};

RandomTally run_segment(const Kind& kind, const RandomContactOptions& options, long index) {
  math::Random random(options.seed, "segment " + std::to_string(index));
  const std::array<int, 3> cells = kind.order == mesh::ElementOrder::kQuadratic
                                       ? std::array<int, 3>{8, 1, 1}
                                       : std::array<int, 3>{16, 3, 3};
  elasticity::Body body = elasticity::make_bar({0.18, kThick, kThick}, cells, kind.order,
                                               {kind.young_modulus, random.uniform(0, 0.45), 100});
  body.damping = {2, 1e-3};
  // weight in proportion to stiffness, so that the softest bar is not a puddle
  if (random.uniform() < 0.5)
    body.gravity_O = {0, 0, -9.81 * std::min(1.0, kind.young_modulus / 3e4)};
  elasticity::SolverOptions solver;
  solver.tolerance *= std::max(1.0, kind.young_modulus / 1e5);
  solver.contact.obstacles = random_obstacles(random);
  std::unique_ptr<elasticity::CorotationalModel> model;
  if (kind.dynamic) {
    model = std::make_unique<elasticity::CorotationalDynamic>(body, solver);
  } else {
    model = std::make_unique<elasticity::CorotationalQuasistatic>(body, solver);
  }
  model->prepare();
  std::vector<int> watched;  // what a hand moves is the hand's concern
  for (int node : mesh::extract_surface(body.mesh).nodes) {
    const auto& held = body.grasps[0].nodes;
    const auto& fixed = body.fixed_nodes;
    if (std::count(held.begin(), held.end(), node) + std::count(fixed.begin(), fixed.end(), node))
      continue;
    watched.push_back(node);
  }
  RandomHand hand(body.grasps[0].X_OG_rest, random);
  elasticity::Refactorisation* job = nullptr;
  long due = 0;
  RandomTally tally;
  for (long step = 0; step < options.segment_steps; ++step) {
    model->hold(0, hand.next());
    const double begin = thread_time();
    const std::int64_t allocations = loop::allocations_of_this_thread();
    const elasticity::StepReport report = model->step(kDt);
    if (job == nullptr) {
      job = model->wanted_refactorisation();
      due = step + options.delay;
    }
    tally.allocations += loop::allocations_of_this_thread() - allocations;
    const double taken = thread_time() - begin;
    if (job != nullptr && step >= due) {
      job->run();
      model->install(*job);
      job = nullptr;
    }
    ++tally.steps;
    tally.overruns += taken > options.budget;
    tally.slowest = std::max(tally.slowest, taken);
    tally.failed += report.status == elasticity::StepStatus::kFailed;
    tally.not_finite += !model->positions().allFinite() || !model->velocities().allFinite() ||
                        !model->reaction(0).vector().allFinite();
    bool touches = false;
    for (const elasticity::SurfaceContact& contact : model->contacts())
      touches = touches || contact.presses();
    tally.touching += touches;
    double depth = 0;
    for (const collision::Obstacle& obstacle : solver.contact.obstacles) {
      for (int node : watched)
        depth = std::max(depth, -collision::distance(obstacle, model->positions().col(node)));
    }
    tally.deep += depth > kFine * kThick;
    tally.through += depth > kThrough * kThick;
    tally.deepest = std::max(tally.deepest, depth);
  }
  return tally;
}

void print(const std::vector<Kind>& all, const std::vector<RandomTally>& tallies,
           std::ostream& out) {
  common::Table table({"model", "E Pa", "steps", "touching", "nan", "failed", "allocs",
                       "over 0.2 %", "through", "deepest mm", "overrun", "max ms"});
  for (std::size_t i = 0; i < all.size(); ++i) {
    const RandomTally& t = tallies[i];
    if (t.steps == 0) continue;
    char e[16];
    std::snprintf(e, sizeof e, "%.0e", all[i].young_modulus);
    const auto count = [](long n) { return std::to_string(n); };
    table.add({all[i].name(), e, count(t.steps), count(t.touching), count(t.not_finite),
               count(t.failed), count(t.allocations), count(t.deep), count(t.through),
               common::number(1e3 * t.deepest, 4), count(t.overruns),
               common::number(1e3 * t.slowest, 2)});
  }
  table.print(out);
}

}  // namespace

bool run_random_contact(const RandomContactOptions& options, std::ostream& out) {
  const std::vector<Kind> all = kinds();
  std::vector<RandomTally> tallies(all.size());
  RandomTally total;
  const long length = std::min(options.segment_steps, options.steps);
  RandomContactOptions segment = options;
  segment.segment_steps = std::max(1L, length);
  const double begin = wall_time();
  for (long s = 0; s * segment.segment_steps < options.steps; ++s) {
    const long index = options.first_segment + s;
    const auto which = static_cast<std::size_t>(index % static_cast<long>(all.size()));
    const RandomTally tally = run_segment(all[which], segment, index);
    if (!tally.is_good()) {
      out << "segment " << index << ", " << all[which].name() << ": " << tally.not_finite
          << " steps not finite, " << tally.allocations << " allocations, " << tally.through
          << " steps through an obstacle\n";
    }
    tallies[which].add(tally);
    total.add(tally);
    std::cerr << '\r' << total.steps << " steps, " << common::number(wall_time() - begin, 0)
              << " s   " << std::flush;
  }
  std::cerr << '\n';
  print(all, tallies, out);
  return total.is_good() && total.touching > total.steps / 20;
}

}  // namespace palpate::bench
