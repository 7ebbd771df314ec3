// Energy of a body that strikes a surface with friction and comes to rest on it.
#include <gtest/gtest.h>

#include "core/elasticity/body_system.hpp"
#include "core/elasticity/inertia.hpp"
#include "tests/unit/core/elasticity/obstacles.hpp"

namespace palpate::elasticity {
namespace {

using Eigen::Vector3d;

/// Energies of a body at positions x and velocities v, in mesh order.
class Energies {
 public:
  explicit Energies(const Body& body)
      : body_(body),
        elements_(body),
        inertia_(elements_, mesh_numbering(body.mesh)),
        forces_(body.mesh, elements_.materials()),
        v_(NodalField::Zero(4, body.mesh.node_count())) {}

  double kinetic(const Eigen::Matrix3Xd& v) {
    v_.topRows<3>() = v;
    return inertia_.energy(v_, 1);
  }
  double elastic(const Eigen::Matrix3Xd& x) {
    Eigen::Matrix3Xd ignored;
    return forces_.evaluate(x, ignored);
  }
  double of_weight(const Eigen::Matrix3Xd& x) {
    return -body_.gravity_O.dot((x - body_.mesh.nodes) * elements_.nodal_mass());
  }

 private:
  const Body& body_;
  ElementSet elements_;
  Inertia inertia_;
  MeshForces forces_;
  NodalField v_;
};

class Impact : public ::testing::TestWithParam<mesh::ElementOrder> {};

/// A cube thrown obliquely at a floor: its kinetic and elastic energy, less the work of gravity,
/// never rises by more than 1e-6 of what it has, from the impact until it rests.
TEST_P(Impact, EnergyLessTheWorkOfGravityNeverRises) {
  const double size = 0.05, height = 0.002;
  Body body;
  body.mesh = mesh::make_element_mesh(mesh::make_box({size, size, size}, {2, 2, 2}), GetParam());
  body.material = {2e4, 0.3, 300};
  body.damping = {0, 1e-3};
  body.gravity_O = {0, 0, -kGravity};
  SolverOptions options = with_obstacles({plane({0, 0, -height}, {0, 0, 1}, 0.4)});
  options.iterations = 40;
  options.tolerance = 1e-9;
  options.accuracy = 0;
  options.contact.sweeps = 400;
  options.contact.tolerance = 1e-9;
  CorotationalDynamic model(body, options);
  model.prepare();
  model.set_gravity(body.gravity_O);
  const Vector3d velocity(0.3, 0.1, -0.5);
  ASSERT_TRUE(model.restore(body.mesh.nodes, velocity.replicate(1, body.mesh.node_count())));
  refactor(model);

  Energies energies(body);
  double before = energies.kinetic(model.velocities()), kinetic = 0;
  const double whole = before + 300 * size * size * size * kGravity * height;
  double highest = 0, most_elastic = 0;
  bool has_left = false;
  for (int i = 0; i < 400; ++i) {
    ASSERT_NE(model.step(kDt).status, StepStatus::kFailed) << i;
    if (i % 10 == 0) refactor(model);
    kinetic = energies.kinetic(model.velocities());
    const double elastic = energies.elastic(model.positions());
    const double now = kinetic + elastic + energies.of_weight(model.positions());
    EXPECT_LT(now - before, 1e-6 * whole) << i;
    before = now;
    most_elastic = std::max(most_elastic, elastic);
    const double force = contact_force(model).norm();
    highest = std::max(highest, force);
    has_left = has_left || (highest > 0 && force == 0);
    EXPECT_LT(deepest(model), 2e-3 * size);
  }
  const double weight = 300 * size * size * size * kGravity;
  EXPECT_GT(most_elastic, 0.2 * whole) << "it is an impact";
  EXPECT_TRUE(has_left) << "from which it rebounds";
  EXPECT_LT(kinetic, 1e-4 * whole) << "and comes to rest";
  EXPECT_NEAR(contact_force(model).z(), weight, 1e-2 * weight);
}

INSTANTIATE_TEST_SUITE_P(BothElements, Impact,
                         ::testing::Values(mesh::ElementOrder::kLinear,
                                           mesh::ElementOrder::kQuadratic));

/// A bar dropped flat on a table, with the few corrections of the loop and with factors that arrive
/// 15 steps after they are requested, gains no energy.
TEST(Drop, WithTheLoopsFewCorrectionsEnergyDoesNotRise) {
  for (double height : {4e-3, 8e-3, 16e-3}) {
    Body body;
    body.mesh = mesh::make_element_mesh(mesh::make_box({0.2, 0.04, 0.04}, {10, 2, 2}),
                                        mesh::ElementOrder::kQuadratic);
    body.material = {3e4, 0.3, 150};
    body.damping = {0, 1e-3};
    body.gravity_O = {0, 0, -kGravity};
    CorotationalDynamic model(body, with_obstacles({plane({0, 0, -height}, {0, 0, 1}, 0.7)}));
    model.prepare();
    model.set_gravity(body.gravity_O);
    Energies energies(body);
    const double weight = 150 * 0.2 * 0.04 * 0.04 * kGravity, whole = weight * height;
    double most = 0, strongest = 0;
    Refactorisation* job = nullptr;
    int age = 0;  // steps since the job was requested
    for (int i = 0; i < 1000; ++i) {
      ASSERT_NE(model.step(kDt).status, StepStatus::kFailed) << i;
      if (job == nullptr) {
        job = model.wanted_refactorisation();
        age = 0;
        if (job != nullptr) job->run();
      } else if (++age == 15) {
        model.install(*job);
        job = nullptr;
      }
      const double energy = energies.kinetic(model.velocities()) +
                            energies.elastic(model.positions()) +
                            energies.of_weight(model.positions());
      most = std::max(most, energy);
      strongest = std::max(strongest, contact_force(model).z());
      EXPECT_LT(deepest(model), 5e-5) << i;
    }
    EXPECT_LT(most, 1e-3 * whole) << "fallen from " << height << " m";
    EXPECT_GT(strongest, 3 * weight) << "it has struck the table";
    EXPECT_NEAR(contact_force(model).z(), weight, 0.02 * weight) << "on which it rests";
  }
}

}  // namespace
}  // namespace palpate::elasticity
