#include "tests/bench/core/elasticity/contact_newton.hpp"

namespace palpate::bench {
namespace {

constexpr int kMostIterations = 30;

elasticity::SolverOptions with_obstacles_of(const ContactScene& scene,
                                            elasticity::SolverOptions solver) {
  solver.contact.obstacles = scene.obstacles;
  return solver;
}

elasticity::SolverOptions converged() {
  elasticity::SolverOptions options;
  options.iterations = 1;  // per factor
  options.accuracy = 0;
  options.contact.sweeps = 500;
  options.contact.tolerance = 1e-7;
  return options;
}

}  // namespace

ContactParts::ContactParts(const ContactScene& scene, const elasticity::SolverOptions& solver)
    : options(with_obstacles_of(scene, solver)),
      body(scene.body),
      boundary(body),
      samples(elasticity::ObstacleContacts::numbered_samples(body, options.contact)),
      potential(body, options, false),
      factor(body, options, samples),
      fresh(body, options, samples),
      tangents(elasticity::make_element_tangents(body.elements, body.pattern)),
      matrix(body.pattern),
      factorisation(body.supernodes),
      x(body.rest),
      positions_(body.body.mesh.nodes) {
  boundary.set_gravity(body.body.gravity_O);
  potential.set_time_step(kContactStep);
}

const Eigen::Matrix3Xd& ContactParts::positions() {
  for (int node = 0; node < body.node_count(); ++node) {
    positions_.col(node) = x.col(body.numbering[node]).head<3>();
  }
  return positions_;
}

void ContactParts::assemble() {
  tangents->assemble(positions(), elasticity::Tangent::kExact, matrix, nullptr);
}

ContactNewton::ContactNewton(const ContactScene& scene)
    : parts_(scene, converged()),
      contacts_(parts_.body, parts_.boundary, parts_.factor, parts_.options.contact,
                parts_.samples),
      corrections_(parts_.body, parts_.boundary, parts_.potential, parts_.factor, &contacts_,
                   parts_.options) {
  refactor();  // compliances are asked for as soon as a step begins
}

void ContactNewton::restore(const Eigen::Matrix3Xd& positions,
                            const std::vector<elasticity::SurfaceContact>& contacts) {
  for (int node = 0; node < parts_.body.node_count(); ++node) {
    parts_.x.col(parts_.body.numbering[node]).head<3>() = positions.col(node);
  }
  contacts_.restore(contacts);
}

void ContactNewton::refactor() {
  parts_.assemble();
  const factor::Held held = parts_.boundary.held();
  elasticity::LoopFactor& fresh = parts_.fresh;
  fresh.exact =
      parts_.factorisation.factorise(parts_.matrix) && parts_.factorisation.is_positive(held);
  fresh.usable = fresh.exact && fresh.panels.assign(parts_.factorisation);
  fresh.rotations = parts_.factor.measure_rotations(parts_.potential.elements());
  contacts_.describe(wanted_, snapshot_);
  fresh.columns.fill(wanted_, parts_.factorisation, held);
  parts_.factor.install(fresh, 0, parts_.potential.elements());
  contacts_.forget_compliances();
}

bool ContactNewton::step(const math::Pose& hand) {
  parts_.boundary.hold(0, hand, parts_.positions());
  parts_.potential.begin_step(parts_.boundary);
  contacts_.begin_step(parts_.x, parts_.potential);
  parts_.boundary.apply(parts_.x);
  double energy = parts_.potential.evaluate(parts_.x);
  bool converged = false;
  const elasticity::StepBudget budget(parts_.options);
  for (iterations_ = 0; iterations_ < kMostIterations && !converged; ++iterations_) {
    refactor();
    elasticity::StepReport report;
    corrections_.minimise(parts_.x, energy, report, budget, false);
    converged = report.residual <= parts_.options.tolerance &&
                contacts_.violation(parts_.x) <= contacts_.tolerance();
  }
  contacts_.finish_step(parts_.x);
  return converged;
}

}  // namespace palpate::bench
