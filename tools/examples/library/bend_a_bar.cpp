// Uses palpate's solver as a library: a bar of foam, fixed at one end and held by a hand at the
// other, is lifted by 5 cm. Prints the position of its middle, the wrench of the hand, and how both
// would change if the hand moved on.
#include <cstdio>

#include "core/elasticity/corotational_model.hpp"
#include "core/mesh/surface.hpp"

int main() {
  using namespace palpate;

  // 1. The object in its rest frame O: mesh, material, what is fixed, what the hand holds.
  const Eigen::Vector3d size(0.5, 0.06, 0.06);  // m
  elasticity::Body body;
  body.mesh =
      mesh::make_element_mesh(mesh::make_box(size, {20, 3, 3}), mesh::ElementOrder::kQuadratic);
  body.material = {30e3, 0.3, 26};  // Young's modulus in Pa, Poisson's ratio, density in kg/m^3
  body.gravity_O = {0, 0, -9.81};
  body.fixed_nodes = mesh::nodes_in_box(body.mesh, {0, 0, 0}, {0, size.y(), size.z()});
  elasticity::GraspRegion grasp;
  grasp.nodes = mesh::nodes_in_box(body.mesh, {0.45, 0, 0}, size);
  grasp.X_OG_rest.translation() = Eigen::Vector3d(0.475, 0.03, 0.03);
  body.grasps = {grasp};

  // 2. The model. prepare() computes the first factorisation.
  elasticity::CorotationalQuasistatic model(body);
  model.prepare();
  model.set_gravity(body.gravity_O);

  // 3. The hand lifts its end by 5 cm in a second. The loop of palpated calls step() likewise, and
  //    lets another thread compute the factorisations that the model wants.
  constexpr double kStep = 1e-3;  // s
  math::Pose X_OG = grasp.X_OG_rest;
  for (int tick = 0; tick < 1500; ++tick) {
    if (tick < 1000) X_OG.translation().z() += 0.05 * kStep;
    model.hold(0, X_OG);
    const elasticity::StepReport report = model.step(kStep);
    if (report.status == elasticity::StepStatus::kFailed) {
      std::fprintf(stderr, "error: step %d failed\n", tick);
      return 1;
    }
    if (elasticity::Refactorisation* job = model.wanted_refactorisation()) {
      job->run();
      model.install(*job);
    }
  }

  // 4. Results.
  const std::vector<int> middle =
      mesh::nodes_in_box(body.mesh, {0.25, 0.02, 0.02}, {0.25, 0.04, 0.04});
  const Eigen::Vector3d moved =
      model.positions().col(middle.front()) - body.mesh.nodes.col(middle.front());
  const math::Wrench wrench = model.reaction(0);
  std::printf("middle of the bar moved by %.1f, %.1f, %.1f mm\n", 1e3 * moved.x(), 1e3 * moved.y(),
              1e3 * moved.z());
  std::printf("hand applies %.2f, %.2f, %.2f N and %.3f, %.3f, %.3f N m\n", wrench.force.x(),
              wrench.force.y(), wrench.force.z(), wrench.torque.x(), wrench.torque.y(),
              wrench.torque.z());
  const elasticity::Sensitivity& response = model.sensitivity();
  if (response.valid)
    std::printf("stiffness against further lifting: %.1f N/m\n", response.dw_dxi[0][0](2, 2));
  return 0;
}
