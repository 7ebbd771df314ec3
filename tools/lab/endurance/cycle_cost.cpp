#include "tools/lab/endurance/cycle_cost.hpp"

#include <ctime>
#include <nlohmann/json.hpp>
#include <random>

#include "rt/daemon/refactoring.hpp"
#include "rt/loop/allocation_counter.hpp"
#include "rt/pipeline/pipeline.hpp"
#include "tools/common/output_files.hpp"
#include "tools/common/table.hpp"
#include "tools/lab/scores/report.hpp"

namespace palpate::endurance {
namespace {

constexpr double kPeriod = 1e-3;       // s, of a cycle
constexpr int kToAndFro = 1500;        // cycles until the target changes
constexpr int kWarmUp = 500;           // cycles that are not measured
constexpr double kForceNoise = 25e-3;  // N, as of a wrist sensor
constexpr double kTorqueNoise = 1e-3;  // N m
constexpr double kWay = 0.02;          // m, of the feature's first number, between the targets
constexpr const char* kConfiguration = "rt/config/examples/bar_long_soft_limits.yaml";

/// About 150, 300, 500 and 700 nodes of the long bar.
constexpr const char* kMeshes[] = {"[8, 1, 1]", "[16, 1, 1]", "[16, 2, 1]", "[13, 2, 2]"};

/// All available limits, and an obstacle, close enough to be evaluated and mostly not restricting
/// the motion.
constexpr const char* kLimits =
    "control.limits={stress: 6000, stretch: 1.3, force: 20, torque: 5, slip: {pinch: 30, friction: "
    "0.5, lever: 0.02, width: 0.06, normal: [0, 1, 0]}, workspace: {lower: [0, -0.5, -0.5], upper: "
    "[1, 0.5, 0.5]}}";
constexpr const char* kObstacles =
    "obstacles=[{name: ball, shape: sphere, radius: 0.03, pose: {position: [1.04, 0, 0.42]}}]";

std::int64_t processor_time_ns() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return now.tv_sec * std::int64_t{1'000'000'000} + now.tv_nsec;
}

/// The hand, the wrist and the feature's target of a loop around some components.
class Loop {
 public:
  explicit Loop(pipeline::Pipeline& pipeline) : components_(pipeline.components_at_setup()) {
    pipeline.start();
    inputs_.dt = kPeriod;
    inputs_.grasp_count = 1;
    inputs_.contacts = components_.loads.data();
    estimation::GraspInput& hand = inputs_.grasps[0];
    hand.pose_freshness = Freshness::kNew;
    hand.holding = hand.wrench_valid = true;
    hand.X_OG = components_.model->body().grasps.at(0).X_OG_rest;
  }

  void cycle(int number, CycleCost* cost) {
    if (number % kToAndFro == 0) set_target(number / kToAndFro % 2 == 0 ? kWay : 0);
    pipeline::FeatureState& feature = components_.feature_state;
    control::LawInputs law = law_inputs();
    {
      const loop::NoAllocationScope scope;
      const std::int64_t start = processor_time_ns();
      static_cast<void>(
          components_.estimator->update(inputs_, *components_.model, components_.estimate));
      const std::int64_t estimated = processor_time_ns();
      components_.feature->evaluate(components_.model->positions(), feature.value);
      components_.feature->error(feature.value, target_, feature.error);
      const bool known = components_.provider->update(*components_.feature, *components_.model,
                                                      inputs_.grasps[0].X_OG, components_.jacobian);
      const std::int64_t derived = processor_time_ns();
      law.reaction = components_.estimate.reaction;
      law.node_deviation = components_.estimate.node_deviation;
      if (known) components_.law->compute(law, components_.law_output);
      const std::int64_t end = processor_time_ns();
      if (!known) components_.law_output.V_O_G = {};
      if (cost != nullptr) {
        cost->estimator.record(estimated - start);
        cost->jacobian.record(derived - estimated);
        cost->program.record(end - derived);
        cost->together.record(end - start);
        cost->allocations += scope.count();
      }
    }
    move_hand();
  }

 private:
  void set_target(double way) {
    if (rest_.size() == 0) {
      components_.feature->evaluate(components_.model->positions(),
                                    components_.feature_state.value);
      rest_ = components_.feature_state.value;
    }
    target_ = rest_;
    target_[target_.size() - 1] += way;
  }

  control::LawInputs law_inputs() const {
    control::LawInputs law;
    law.dt = kPeriod;
    law.value = &components_.feature_state.value;
    law.target = &target_;
    law.error = &components_.feature_state.error;
    law.jacobian = &components_.jacobian;
    law.model = components_.model.get();
    law.X_OG[0] = inputs_.grasps[0].X_OG;
    return law;
  }

  void move_hand() {
    estimation::GraspInput& hand = inputs_.grasps[0];
    const math::Twist& V = components_.law_output.V_O_G;
    hand.X_OG.translation() += kPeriod * V.linear;
    hand.X_OG.linear() = math::exp_rotation(kPeriod * V.angular) * hand.X_OG.linear();
    hand.F_G_O = components_.estimate.reaction[0];
    for (int i = 0; i < 3; ++i) {
      hand.F_G_O.force[i] += kForceNoise * noise_(random_);
      hand.F_G_O.torque[i] += kTorqueNoise * noise_(random_);
    }
  }

  pipeline::ComponentSet& components_;
  estimation::EstimationInputs inputs_;
  Eigen::VectorXd rest_, target_;
  std::mt19937 random_{1};
  std::normal_distribution<double> noise_;
};

std::string microseconds(const loop::LatencyHistogram& histogram, double share) {
  return common::number(static_cast<double>(histogram.quantile_ns(share)) * 1e-3, 0);
}

nlohmann::json to_json(const loop::LatencyHistogram& histogram) {
  const auto at = [&histogram](double share) {
    return static_cast<double>(histogram.quantile_ns(share)) * 1e-3;
  };
  return {{"count", histogram.count()},
          {"p50", at(0.5)},
          {"p99", at(0.99)},
          {"p99.9", at(0.999)},
          {"max", static_cast<double>(histogram.max_ns()) * 1e-3}};
}

}  // namespace

CycleCost measure_cycle_cost(const std::filesystem::path& configuration,
                             const std::vector<std::string>& overrides, int cycles) {
  const config::Node root = config::Node::load_file(configuration.string(), overrides);
  pipeline::Pipeline pipeline(root, kPeriod);
  CycleCost cost;
  cost.nodes = pipeline.object().body.mesh.node_count();
  Loop loop(pipeline);
  daemon::Refactoring refactoring(-1);
  const elasticity::DeformationModel& model = pipeline.model();
  double age = model.sensitivity().age;
  for (int i = 0; i < kWarmUp + cycles; ++i) {
    refactoring.service(pipeline.model(), i);
    loop.cycle(i, i < kWarmUp ? nullptr : &cost);
    if (model.sensitivity().age < age) ++cost.factors;
    age = model.sensitivity().age;
  }
  while (!refactoring.idle()) refactoring.service(pipeline.model(), kWarmUp + cycles);
  return cost;
}

int run_cycle_cost(const CycleCostOptions& options, std::ostream& out) {
  common::Table table({"us of the processor", "p50", "p99", "p99.9", "max", "above 1 ms %"});
  nlohmann::json json = nlohmann::json::array();
  std::int64_t allocations = 0;
  for (const char* mesh : kMeshes) {
    std::vector<std::string> overrides{std::string("object.mesh.box.cells=") + mesh,
                                       "estimation={component: pose_wrench_filter}", kLimits,
                                       kObstacles};
    overrides.insert(overrides.end(), options.overrides.begin(), options.overrides.end());
    const CycleCost cost =
        measure_cycle_cost(options.root / kConfiguration, overrides, options.cycles);
    table.section(std::to_string(cost.nodes) + " nodes, " + std::to_string(cost.factors) +
                  " factors in " + std::to_string(cost.together.count()) + " cycles, " +
                  std::to_string(cost.allocations) + " allocations");
    nlohmann::json entry{{"nodes", cost.nodes},
                         {"cells", mesh},
                         {"factors", cost.factors},
                         {"allocations", cost.allocations}};
    const std::pair<const char*, const loop::LatencyHistogram*> parts[] = {
        {"estimator", &cost.estimator},
        {"Jacobian", &cost.jacobian},
        {"quadratic program", &cost.program},
        {"the three together", &cost.together}};
    for (const auto& [name, part] : parts) {
      const double above = static_cast<double>(part->count_above(1'000'000)) /
                           static_cast<double>(std::max<std::int64_t>(1, part->count()));
      table.add({name, microseconds(*part, 0.5), microseconds(*part, 0.99),
                 microseconds(*part, 0.999),
                 common::number(static_cast<double>(part->max_ns()) * 1e-3, 0),
                 common::number(100 * above, 3)});
      entry["us"][name] = to_json(*part);
    }
    json.push_back(std::move(entry));
    allocations += cost.allocations;
  }
  table.print(out);
  if (allocations > 0) out << "THE LOOP ALLOCATES\n";
  if (!options.json.empty()) common::write_json(json, options.json);
  return allocations == 0 ? 0 : 1;
}

}  // namespace palpate::endurance
