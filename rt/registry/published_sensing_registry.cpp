#include "rt/registry/published_sensing_registry.hpp"

#include "core/published_sensing/cloud_driven_fem.hpp"
#include "core/published_sensing/compliance_map.hpp"
#include "core/published_sensing/deformation_graph_fit.hpp"
#include "core/published_sensing/euler_bernoulli_fit.hpp"
#include "core/published_sensing/evolved_mass_spring.hpp"
#include "core/published_sensing/mass_spring_em.hpp"
#include "core/published_sensing/probe_and_fit.hpp"
#include "core/published_sensing/probed_cloud_fem.hpp"
#include "core/published_sensing/shape_matching_fit.hpp"
#include "core/published_sensing/spline_fit.hpp"
#include "core/published_sensing/voxel_mass_spring.hpp"
#include "rt/registry/learned_shape_file.hpp"

namespace palpate::registry {
namespace {

using namespace published_sensing;

/// Common keys.
void read_cloud(const config::Node& node, CloudEstimator::Options& options) {
  options.hand =
      node.flag({"hand", "", "whether the pose of the hand is taken as well"}, options.hand);
  options.reach =
      node.number({"observation_reach", "m", "beyond which a point is no part of the object"},
                  {1e-4, 1}, options.reach);
  options.points_per_tick =
      node.integer({"observation_points_per_tick", "", "points that are worked on in a cycle"},
                   {1, 256}, options.points_per_tick);
  options.patience = node.number({"observation_timeout_ms", "ms", "after which a cloud is old"},
                                 {1, 1e5}, options.patience * 1e3) *
                     1e-3;
  options.follower.pose_timeout =
      node.number({"pose_timeout_ms", "ms", "after which the pose of the hand is old"}, {1, 1e4},
                  options.follower.pose_timeout * 1e3) *
      1e-3;
  options.follower.approach_speed = node.number(
      {"approach_speed", "m/s", "with which the grasp goes to where the hand is at the start"},
      {1e-3, 10}, options.follower.approach_speed);
}

template <class Method>
std::unique_ptr<estimation::Estimator> make(const typename Method::Options& options,
                                            const Context& context) {
  return std::make_unique<Method>(context.object->body, context.object->surface, options);
}

/// Keys of methods with springs between cloud and shape.
template <class Options>
void read_springs(const config::Node& node, Options& options) {
  read_cloud(node, options);
  options.stiffness =
      node.number({"spring_stiffness", "N/m", "of the springs"}, {1e-3, 1e6}, options.stiffness);
  options.damping =
      node.number({"spring_damping", "N s/m", "of the springs"}, {0, 1e4}, options.damping);
}

CloudDrivenFem::Options read_cloud_driven_fem(const config::Node& node) {
  CloudDrivenFem::Options options;
  read_springs(node, options);
  return options;
}

ProbedCloudFem::Options read_probed_cloud_fem(const config::Node& node) {
  ProbedCloudFem::Options options;
  read_springs(node, options);
  options.probing = node.number({"probing_s", "s", "of probing before anything is told"},
                                {0.1, 1e4}, options.probing);
  options.force = node.number({"force_deviation", "N", "standard deviation of a measured force"},
                              {1e-5, 10}, options.force);
  return options;
}

DeformationGraphFit::Options read_deformation_graph_fit(const config::Node& node) {
  DeformationGraphFit::Options options;
  read_cloud(node, options);
  options.nodes = node.integer({"nodes", "", "of the deformation graph"},
                               {4, DeformationGraphFit::kMostNodes}, options.nodes);
  options.deviation = node.number({"observation_deviation", "m", "standard deviation of a point"},
                                  {1e-6, 1}, options.deviation);
  options.rigidity =
      node.number({"rigidity_deviation", "m", "by which the end of an edge may be missed"},
                  {1e-6, 1}, options.rigidity);
  options.memory = node.number({"memory", "", "share of the last estimate that is kept"}, {0, 1e9},
                               options.memory);
  return options;
}

MassSpringEm::Options read_mass_spring_em(const config::Node& node) {
  MassSpringEm::Options options;
  read_springs(node, options);
  options.width = node.number({"width", "m", "deviation of the points about the shape"}, {1e-4, 1},
                              options.width);
  options.noise = node.number({"noise_share", "", "of points that belong to nothing"},
                              {1e-6, 0.999}, options.noise);
  return options;
}

VoxelMassSpring::Options read_voxel_mass_spring(const config::Node& node) {
  VoxelMassSpring::Options options;
  read_cloud(node, options);
  options.voxel = node.number({"voxel", "m", "edge of a voxel"}, {1e-3, 1}, options.voxel);
  options.stiffness =
      node.number({"spring_stiffness", "N/m", "of the springs"}, {1e-6, 10}, options.stiffness);
  options.damping =
      node.number({"damping_share", "", "of the critical damping"}, {1e-4, 0.99}, options.damping);
  return options;
}

ShapeMatchingFit::Options read_shape_matching_fit(const config::Node& node) {
  ShapeMatchingFit::Options options;
  read_cloud(node, options);
  options.regions = node.integer({"regions", "", "clusters of the shape that are matched"}, {1, 50},
                                 options.regions);
  options.candidates = node.integer({"candidates", "", "points that a node may belong to"}, {1, 20},
                                    options.candidates);
  options.iterations = node.integer({"iterations", "", "in a cycle"}, {1, 50}, options.iterations);
  options.rigidity = node.number(
      {"rigidity", "", "how soon influence fades with distance, or how stiff a match is"},
      {1e-3, 1}, options.rigidity);
  options.memory = node.number({"memory_s", "s", "after which what was seen is forgotten"},
                               {1e-3, 1e4}, options.memory);
  return options;
}

EvolvedMassSpring::Options read_evolved_mass_spring(const config::Node& node) {
  EvolvedMassSpring::Options options;
  read_cloud(node, options);
  options.voxel = node.number({"voxel", "m", "edge of a voxel"}, {1e-3, 1}, options.voxel);
  options.population =
      node.integer({"population", "", "candidates of a generation"}, {3, 50}, options.population);
  options.generation =
      node.number({"generation_s", "s", "of one generation"}, {1e-2, 1e4}, options.generation);
  options.mutation = node.number({"mutation", "", "deviation of a mutation, of the logarithm"},
                                 {1e-3, 10}, options.mutation);
  options.damping =
      node.number({"damping_share", "", "of the critical damping"}, {1e-4, 0.99}, options.damping);
  return options;
}

std::unique_ptr<estimation::Estimator> make_learned_shape(const config::Node& node,
                                                          const Context& context) {
  const LearnedShape::Model model = read_learned_shape(
      node.path({"model", "", "file that palpate-evaluate train-sensing writes"}));
  const double average =
      node.number({"average_ms", "ms", "over which the wrench is averaged"}, {0.1, 1e4}, 30) * 1e-3;
  return std::make_unique<LearnedShape>(context.object->body, model, average);
}

ComplianceMap::Options read_compliance_map(const config::Node& node) {
  ComplianceMap::Options options;
  options.process.length = node.number({"length", "m", "over which compliances are alike"},
                                       {1e-4, 1}, options.process.length);
  options.process.deviation =
      node.number({"log_compliance_deviation", "", "prior of the logarithm of the compliance"},
                  {1e-3, 10}, options.process.deviation);
  options.process.noise =
      node.number({"log_compliance_noise", "", "of a touch"}, {1e-3, 10}, options.process.noise);
  options.process.mean = node.number({"compliance", "m/N", "expected before any touch"}, {1e-9, 10},
                                     options.process.mean);
  options.footprint =
      node.number({"footprint", "m", "that a touch presses in"}, {1e-4, 1}, options.footprint);
  options.least_force =
      node.number({"least_force", "N", "of a touch that tells"}, {1e-3, 100}, options.least_force);
  options.every =
      node.number({"every_ms", "ms", "between two updates"}, {1, 1e5}, options.every * 1e3) * 1e-3;
  return options;
}

void read_curve(const config::Node& node, CurveFit::Options& options) {
  read_cloud(node, options);
  options.deviation = node.number({"observation_deviation", "m", "standard deviation of a point"},
                                  {1e-6, 1}, options.deviation);
  options.memory = node.number({"memory", "", "share of the last estimate that is kept"}, {0, 1e9},
                               options.memory);
}

EulerBernoulliFit::Options read_euler_bernoulli_fit(const config::Node& node) {
  EulerBernoulliFit::Options options;
  read_curve(node, options);
  options.log_young_deviation =
      node.number({"log_young_modulus_deviation", "", "prior of the logarithm of E"}, {1e-6, 10},
                  options.log_young_deviation);
  return options;
}

SplineFit::Options read_spline_fit(const config::Node& node) {
  SplineFit::Options options;
  read_curve(node, options);
  options.controls =
      node.integer({"controls", "", "control points of the spline"}, {3, 12}, options.controls);
  options.stretch =
      node.number({"stretch_deviation", "", "prior of the stretch"}, {1e-6, 10}, options.stretch);
  options.bend =
      node.number({"bend_deviation", "1/m", "prior of the curvature"}, {1e-3, 1e9}, options.bend);
  return options;
}

ProbeAndFit::Options read_probe_and_fit(const config::Node& node) {
  ProbeAndFit::Options options;
  read_cloud(node, options);
  options.probing = node.number({"probing_s", "s", "of probing before anything is told"},
                                {0.1, 1e4}, options.probing);
  options.rounds =
      node.number({"round_s", "s", "between two rounds of the fit"}, {0.01, 1e4}, options.rounds);
  options.force = node.number({"force_deviation", "N", "standard deviation of a measured force"},
                              {1e-5, 10}, options.force);
  options.torque =
      node.number({"torque_deviation", "N m", "standard deviation of a measured torque"}, {1e-6, 1},
                  options.torque);
  options.period = node.number({"wrench_period_ms", "ms", "between two wrenches that are taken"},
                               {0.1, 1e4}, options.period * 1e3) *
                   1e-3;
  options.deviation = node.number({"observation_deviation", "m", "standard deviation of a point"},
                                  {1e-6, 1}, options.deviation);
  options.log_young_prior =
      node.number({"log_young_modulus_deviation", "", "prior of the logarithm of E"}, {1e-3, 10},
                  options.log_young_prior);
  options.poisson_prior =
      node.number({"poisson_ratio_deviation", "", "prior of the ratio of Poisson"}, {1e-3, 1},
                  options.poisson_prior);
  return options;
}

}  // namespace

const std::vector<std::string>& published_sensing_names() {
  static const std::vector<std::string> names{
      "cloud_driven_fem",    "voxel_mass_spring", "shape_matching_fit", "mass_spring_em",
      "euler_bernoulli_fit", "spline_fit",        "probe_and_fit",      "evolved_mass_spring",
      "learned_shape",       "compliance_map",    "probed_cloud_fem",   "deformation_graph_fit"};
  return names;
}

std::unique_ptr<estimation::Estimator> make_published_sensing(const std::string& name,
                                                              const config::Node& node,
                                                              const Context& context) {
  if (name == "cloud_driven_fem") return make<CloudDrivenFem>(read_cloud_driven_fem(node), context);
  if (name == "voxel_mass_spring")
    return make<VoxelMassSpring>(read_voxel_mass_spring(node), context);
  if (name == "shape_matching_fit")
    return make<ShapeMatchingFit>(read_shape_matching_fit(node), context);
  if (name == "mass_spring_em") return make<MassSpringEm>(read_mass_spring_em(node), context);
  if (name == "euler_bernoulli_fit")
    return make<EulerBernoulliFit>(read_euler_bernoulli_fit(node), context);
  if (name == "evolved_mass_spring")
    return make<EvolvedMassSpring>(read_evolved_mass_spring(node), context);
  if (name == "compliance_map") return make<ComplianceMap>(read_compliance_map(node), context);
  if (name == "learned_shape") return make_learned_shape(node, context);
  if (name == "spline_fit") return make<SplineFit>(read_spline_fit(node), context);
  if (name == "probed_cloud_fem") return make<ProbedCloudFem>(read_probed_cloud_fem(node), context);
  if (name == "deformation_graph_fit")
    return make<DeformationGraphFit>(read_deformation_graph_fit(node), context);
  return make<ProbeAndFit>(read_probe_and_fit(node), context);
}

}  // namespace palpate::registry
