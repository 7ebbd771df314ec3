#include "tests/bench/core/elasticity/correction_cost.hpp"

#include <stdexcept>

#include "core/factor/solve_panels.hpp"
#include "tests/bench/core/elasticity/curved_pass.hpp"
#include "tests/bench/core/elasticity/samples.hpp"

namespace palpate::bench {

double median_time(const std::function<void()>& run) {
  constexpr double kDuration = 0.05;  // s
  constexpr std::size_t kFewest = 20;
  for (int i = 0; i < 3; ++i) run();
  Samples samples;
  const double begin = thread_time();
  while (samples.count() < kFewest || thread_time() - begin < kDuration) {
    const double start = thread_time();
    run();
    samples.add(thread_time() - start);
  }
  return samples.quantile(0.5);
}

double time_element_pass(const elasticity::Body& body, const Eigen::Matrix3Xd& x,
                         elasticity::Precision precision) {
  const auto pass =
      elasticity::make_element_forces(body.mesh, elasticity::ElementSet(body).materials(),
                                      elasticity::mesh_numbering(body.mesh), precision);
  elasticity::NodalField padded = elasticity::NodalField::Zero(4, x.cols()), forces = padded;
  padded.topRows<3>() = x;
  return median_time([&] { pass->add(padded, 0, forces); });
}

double time_curved_pass(const elasticity::Body& body, const Eigen::Matrix3Xd& x) {
  CurvedPass pass(body);
  elasticity::NodalField padded = elasticity::NodalField::Zero(4, x.cols()), forces = padded;
  padded.topRows<3>() = x;
  return median_time([&] {
    forces.setZero();
    pass.add(padded, forces);
  });
}

SolveCost time_solve(const elasticity::Body& body, Volumetric volumetric,
                     factor::PanelPrecision precision) {
  CandidateElements elements(body, volumetric);
  Eigen::Matrix3Xd forces;
  elements.evaluate(body.mesh.nodes, forces);
  const factor::BlockPattern pattern(elements.stencils(), body.mesh.node_count(), body.fixed_nodes,
                                     elasticity::patches(body));
  const factor::Supernodes supernodes(pattern);
  factor::BlockMatrix matrix(pattern);
  elements.add_tangent(true, matrix);
  factor::SupernodalFactor factor(supernodes);
  factor::SolvePanels panels(supernodes, precision);
  constexpr factor::Held kHeld{true, true};
  if (!factor.factorise(matrix) || !panels.assign(factor) || !panels.usable(kHeld)) {
    throw std::runtime_error("the stiffness at rest is not positive definite");
  }
  const Eigen::VectorXf right = Eigen::VectorXf::Random(3 * pattern.size());
  Eigen::VectorXf b = right;
  SolveCost cost{supernodes.entries(), panels.bytes(), 0};
  cost.seconds = median_time([&] {
    b = right;
    panels.solve(b.data(), kHeld);
  });
  return cost;
}

}  // namespace palpate::bench
