#include "tools/lab/baselines/components.hpp"
#include "tools/lab/baselines/learning/learned_shape.hpp"
#include "tools/lab/baselines/sensing/cloud_driven_fem.hpp"
#include "tools/lab/baselines/sensing/compliance_map.hpp"
#include "tools/lab/baselines/sensing/deformation_graph_fit.hpp"
#include "tools/lab/baselines/sensing/euler_bernoulli_fit.hpp"
#include "tools/lab/baselines/sensing/evolved_mass_spring.hpp"
#include "tools/lab/baselines/sensing/mass_spring_em.hpp"
#include "tools/lab/baselines/sensing/probe_and_fit.hpp"
#include "tools/lab/baselines/sensing/probed_cloud_fem.hpp"
#include "tools/lab/baselines/sensing/shape_matching_fit.hpp"
#include "tools/lab/baselines/sensing/spline_fit.hpp"
#include "tools/lab/baselines/sensing/voxel_mass_spring.hpp"

namespace palpate::baselines {
namespace {

using plugin::PluginCell;
using Estimator = std::unique_ptr<estimation::Estimator>;

/// Keys of every method that takes clouds of points.
template <class Options>
config::OptionTable<Options> cloud_table() {
  return config::OptionTable<Options>()
      .flag("hand", "whether the pose of the hand is taken as well", &Options::hand)
      .number("observation_reach", "m", "beyond which a point is no part of the object", {1e-4, 1},
              &Options::reach)
      .integer("observation_points_per_tick", "points that are worked on in a cycle", {1, 256},
               &Options::points_per_tick)
      .number("observation_timeout_ms", "ms", "after which a cloud is old", {1, 1e5},
              &Options::patience, 1e-3)
      .number(
          "pose_timeout_ms", "ms", "after which the pose of the hand is old", {1, 1e4},
          [](auto& o) -> auto& { return o.follower.pose_timeout; }, 1e-3)
      .number(
          "approach_speed", "m/s", "with which the grasp goes to where the hand is at the start",
          {1e-3, 10}, [](auto& o) -> auto& { return o.follower.approach_speed; });
}

/// Keys of methods with springs between cloud and shape.
template <class Options>
config::OptionTable<Options> spring_table() {
  return cloud_table<Options>()
      .number("spring_stiffness", "N/m", "of the springs", {1e-3, 1e6}, &Options::stiffness)
      .number("spring_damping", "N s/m", "of the springs", {0, 1e4}, &Options::damping);
}

template <class Options>
config::OptionTable<Options> curve_table() {
  return cloud_table<Options>()
      .number("observation_deviation", "m", "standard deviation of a point", {1e-6, 1},
              &Options::deviation)
      .number("memory", "", "share of the last estimate that is kept", {0, 1e9}, &Options::memory);
}

/// Adds a method that is made from body, surface and options.
template <class Method>
void add(plugin::PluginRegistrar& registrar, const std::string& name,
         const config::OptionTable<typename Method::Options>& table) {
  registrar.estimators.add(
      name, table,
      [](const typename Method::Options& options, const PluginCell& cell) -> Estimator {
        return std::make_unique<Method>(*cell.body, *cell.surface, options);
      });
}

void add_fem_methods(plugin::PluginRegistrar& registrar) {
  using Probed = ProbedCloudFem::Options;
  add<CloudDrivenFem>(registrar, "cloud_driven_fem", spring_table<CloudDrivenFem::Options>());
  add<ProbedCloudFem>(registrar, "probed_cloud_fem",
                      spring_table<Probed>()
                          .number("probing_s", "s", "of probing before an estimate is given",
                                  {0.1, 1e4}, &Probed::probing)
                          .number("force_deviation", "N", "standard deviation of a measured force",
                                  {1e-5, 10}, &Probed::force));
  using Fit = ProbeAndFit::Options;
  add<ProbeAndFit>(
      registrar, "probe_and_fit",
      cloud_table<Fit>()
          .number("probing_s", "s", "of probing before an estimate is given", {0.1, 1e4},
                  &Fit::probing)
          .number("round_s", "s", "between two rounds of the fit", {0.01, 1e4}, &Fit::rounds)
          .number("force_deviation", "N", "standard deviation of a measured force", {1e-5, 10},
                  &Fit::force)
          .number("torque_deviation", "N m", "standard deviation of a measured torque", {1e-6, 1},
                  &Fit::torque)
          .number("wrench_period_ms", "ms", "between two wrenches that are taken", {0.1, 1e4},
                  &Fit::period, 1e-3)
          .number("observation_deviation", "m", "standard deviation of a point", {1e-6, 1},
                  &Fit::deviation)
          .number("log_young_modulus_deviation", "", "prior of the logarithm of E", {1e-3, 10},
                  &Fit::log_young_prior)
          .number("poisson_ratio_deviation", "", "prior of the ratio of Poisson", {1e-3, 1},
                  &Fit::poisson_prior));
}

void add_spring_methods(plugin::PluginRegistrar& registrar) {
  using Mixture = MassSpringEm::Options;
  add<MassSpringEm>(registrar, "mass_spring_em",
                    spring_table<Mixture>()
                        .number("width", "m", "deviation of the points about the shape", {1e-4, 1},
                                &Mixture::width)
                        .number("noise_share", "", "of points that belong to nothing",
                                {1e-6, 0.999}, &Mixture::noise));
  using Voxels = VoxelMassSpring::Options;
  add<VoxelMassSpring>(
      registrar, "voxel_mass_spring",
      cloud_table<Voxels>()
          .number("voxel", "m", "edge of a voxel", {1e-3, 1}, &Voxels::voxel)
          .number("spring_stiffness", "N/m", "of the springs", {1e-6, 10}, &Voxels::stiffness)
          .number("damping_share", "", "of the critical damping", {1e-4, 0.99}, &Voxels::damping));
  using Evolved = EvolvedMassSpring::Options;
  add<EvolvedMassSpring>(
      registrar, "evolved_mass_spring",
      cloud_table<Evolved>()
          .number("voxel", "m", "edge of a voxel", {1e-3, 1}, &Evolved::voxel)
          .integer("population", "candidates of a generation", {3, 50}, &Evolved::population)
          .number("generation_s", "s", "of one generation", {1e-2, 1e4}, &Evolved::generation)
          .number("mutation", "", "deviation of a mutation, of the logarithm", {1e-3, 10},
                  &Evolved::mutation)
          .number("damping_share", "", "of the critical damping", {1e-4, 0.99}, &Evolved::damping));
}

void add_geometric_methods(plugin::PluginRegistrar& registrar) {
  using Graph = DeformationGraphFit::Options;
  add<DeformationGraphFit>(
      registrar, "deformation_graph_fit",
      cloud_table<Graph>()
          .integer("nodes", "of the deformation graph", {4, DeformationGraphFit::kMostNodes},
                   &Graph::nodes)
          .number("observation_deviation", "m", "standard deviation of a point", {1e-6, 1},
                  &Graph::deviation)
          .number("rigidity_deviation", "m", "by which the end of an edge may be missed", {1e-6, 1},
                  &Graph::rigidity)
          .number("memory", "", "share of the last estimate that is kept", {0, 1e9},
                  &Graph::memory));
  using Regions = ShapeMatchingFit::Options;
  add<ShapeMatchingFit>(
      registrar, "shape_matching_fit",
      cloud_table<Regions>()
          .integer("regions", "clusters of the shape that are matched", {1, 50}, &Regions::regions)
          .integer("candidates", "points that a node may belong to", {1, 20}, &Regions::candidates)
          .integer("iterations", "in a cycle", {1, 50}, &Regions::iterations)
          .number("rigidity", "", "how soon influence fades with distance, or how stiff a match is",
                  {1e-3, 1}, &Regions::rigidity)
          .number("memory_s", "s", "after which what was seen is forgotten", {1e-3, 1e4},
                  &Regions::memory));
  using Bar = EulerBernoulliFit::Options;
  add<EulerBernoulliFit>(
      registrar, "euler_bernoulli_fit",
      curve_table<Bar>().number("log_young_modulus_deviation", "", "prior of the logarithm of E",
                                {1e-6, 10}, &Bar::log_young_deviation));
  using Spline = SplineFit::Options;
  add<SplineFit>(
      registrar, "spline_fit",
      curve_table<Spline>()
          .integer("controls", "control points of the spline", {3, 12}, &Spline::controls)
          .number("stretch_deviation", "", "prior of the stretch", {1e-6, 10}, &Spline::stretch)
          .number("bend_deviation", "1/m", "prior of the curvature", {1e-3, 1e9}, &Spline::bend));
}

void add_compliance_map(plugin::PluginRegistrar& registrar) {
  using Map = ComplianceMap::Options;
  add<ComplianceMap>(
      registrar, "compliance_map",
      config::OptionTable<Map>()
          .number(
              "length", "m", "over which compliances are alike", {1e-4, 1},
              [](auto& o) -> auto& { return o.process.length; })
          .number(
              "log_compliance_deviation", "", "prior of the logarithm of the compliance",
              {1e-3, 10}, [](auto& o) -> auto& { return o.process.deviation; })
          .number(
              "log_compliance_noise", "", "of a touch", {1e-3, 10},
              [](auto& o) -> auto& { return o.process.noise; })
          .number(
              "compliance", "m/N", "expected before any touch", {1e-9, 10},
              [](auto& o) -> auto& { return o.process.mean; })
          .number("footprint", "m", "that a touch presses in", {1e-4, 1}, &Map::footprint)
          .number("least_force", "N", "of a touch that is used", {1e-3, 100}, &Map::least_force)
          .number("every_ms", "ms", "between two updates", {1, 1e5}, &Map::every, 1e-3));
}

struct LearnedOptions {
  std::string model;
  double average = 0.03;  // s
};

}  // namespace

void add_estimators(plugin::PluginRegistrar& registrar) {
  add_fem_methods(registrar);
  add_spring_methods(registrar);
  add_geometric_methods(registrar);
  add_compliance_map(registrar);
  registrar.estimators.add(
      "learned_shape",
      config::OptionTable<LearnedOptions>()
          .file("model", "file that palpate-evaluate train-sensing writes", &LearnedOptions::model)
          .required()
          .number("average_ms", "ms", "over which the wrench is averaged", {0.1, 1e4},
                  &LearnedOptions::average, 1e-3),
      [](const LearnedOptions& options, const PluginCell& cell) -> Estimator {
        return std::make_unique<LearnedShape>(*cell.body, read_learned_shape(options.model),
                                              options.average);
      });
}

}  // namespace palpate::baselines
