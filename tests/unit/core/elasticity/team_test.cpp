#include <gtest/gtest.h>

#include "core/elasticity/element_forces.hpp"
#include "core/factor/solve_panels.hpp"
#include "tests/unit/core/elasticity/stepping.hpp"
#include "tests/unit/core/elasticity/turns.hpp"

// Results computed by a team equal those of a single thread up to rounding, and bit-identically for
// a given team size.
namespace palpate::elasticity {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using mesh::ElementOrder;

Body long_bar(ElementOrder order) {
  return order == ElementOrder::kLinear ? make_bar({0.2, 0.05, 0.05}, {13, 3, 3}, order)
                                        : make_bar({0.2, 0.05, 0.05}, {5, 2, 1}, order);
}

struct Pass {
  double energy = 0;
  NodalField forces;
  Eigen::Matrix4Xf rotations;
};

/// Two evaluations of a bent and rotated body, the second with viscosity.
Pass pass_of(const Body& body, Precision precision, math::Team& team) {
  const ElementSet set(body);
  const auto elements =
      make_element_forces(body.mesh, set.materials(), mesh_numbering(body.mesh), precision, team);
  const int n = body.mesh.node_count();
  NodalField x = NodalField::Zero(4, n);
  Pass pass;
  pass.forces = x;
  pass.rotations.setZero(4, n);
  pass.rotations.row(0).setOnes();
  for (int k = 1; k <= 2; ++k) {
    for (int i = 0; i < n; ++i) {
      const Vector3d p = body.mesh.nodes.col(i);
      x.col(i).head<3>() = rotation(0.3 * k + 4 * p.x(), {0, 0.6, 0.8}) * p;
    }
    elements->begin_step();
    pass.energy += elements->add(x, 0.5 * (k - 1), pass.forces);
  }
  elements->node_rotations(pass.rotations);
  return pass;
}

TEST(Team, ElementForcesAreThoseOfOneMember) {
  for (ElementOrder order : {ElementOrder::kLinear, ElementOrder::kQuadratic}) {
    const Body body = long_bar(order);
    for (Precision precision : {Precision::kDouble, Precision::kSingle}) {
      const double rounding = precision == Precision::kDouble ? 1e-13 : 1e-5;
      const Pass alone = pass_of(body, precision, math::solo_team);
      ASSERT_GT(alone.energy, 1e-3);
      for (int size : {2, 3, 4, 8}) {
        Turns forwards(size), backwards(size, true);
        const Pass pass = pass_of(body, precision, forwards);
        EXPECT_NEAR(pass.energy, alone.energy, rounding * alone.energy);
        EXPECT_LT((pass.forces - alone.forces).norm(), rounding * alone.forces.norm());
        EXPECT_LT((pass.rotations - alone.rotations).cwiseAbs().maxCoeff(), 1e-5);
        const Pass again = pass_of(body, precision, backwards);
        EXPECT_EQ(pass.energy, again.energy);
        EXPECT_EQ(pass.forces, again.forces);
        EXPECT_EQ(pass.rotations, again.rotations);
      }
    }
  }
}

TEST(Team, MoreMembersThanBlocksDoNoHarm) {
  const Body body = make_bar({1, 1, 1}, {1, 1, 1}, ElementOrder::kLinear);
  Turns team(30);
  const Pass pass = pass_of(body, Precision::kSingle, team);
  const Pass alone = pass_of(body, Precision::kSingle, math::solo_team);
  EXPECT_LT((pass.forces - alone.forces).norm(), 1e-5 * alone.forces.norm());
}

/// A system large enough for the top panels of the tree to be shared.
struct LargeSystem {
  LargeSystem()
      : body(make_bar({0.2, 0.08, 0.08}, {14, 8, 8}, ElementOrder::kLinear)),
        pattern(body.mesh.elements, body.mesh.node_count(), {},
                {nodes_at(body.mesh, 0, 0), body.grasps[0].nodes}),
        nodes(pattern),
        factor(nodes) {
    const ElementSet set(body);
    factor::BlockMatrix matrix(pattern);
    Eigen::MatrixXd K;
    for (int e = 0; e < set.element_count(); ++e) {
      set.stiffness(e, body.mesh.nodes, Tangent::kExact, 0, K);
      matrix.add(e, K);
      set.mass(e, K);
      matrix.add_scalar(e, 1e6, K);
    }
    EXPECT_TRUE(factor.factorise(matrix));
  }
  Body body;
  factor::BlockPattern pattern;
  factor::Supernodes nodes;
  factor::SupernodalFactor factor;
};

TEST(Team, SolvesAreThoseOfOneMember) {
  const LargeSystem system;
  const auto solution = [&system](factor::PanelPrecision precision, math::Team& team,
                                  factor::Held held) {
    factor::SolvePanels panels(system.nodes, precision, team);
    EXPECT_TRUE(panels.assign(system.factor));
    Eigen::VectorXf b(3 * system.pattern.size());
    for (int i = 0; i < b.size(); ++i) b[i] = static_cast<float>(std::sin(0.37 * i));
    panels.solve(b.data(), held);
    return b;
  };
  for (int size : {2, 3, 4, 8}) {
    const factor::TreeShares shares = factor::share_tree(system.nodes, size);
    ASSERT_TRUE(std::any_of(shares.top.begin(), shares.top.end(),
                            [](const factor::TreeShares::Top& top) { return top.is_shared; }));
    Turns forwards(size), backwards(size, true);
    for (factor::PanelPrecision precision :
         {factor::PanelPrecision::kSingle, factor::PanelPrecision::kHalf}) {
      for (factor::Held held :
           {factor::Held{false, false}, factor::Held{true, false}, factor::Held{false, true}}) {
        const Eigen::VectorXf alone = solution(precision, math::solo_team, held);
        const Eigen::VectorXf x = solution(precision, forwards, held);
        EXPECT_LT((x - alone).norm(), 1e-5F * alone.norm()) << size << " members";
        EXPECT_EQ(x, solution(precision, backwards, held));
      }
    }
  }
}

/// A motion of 150 ms under gravity, with grasp and factorisations updated.
template <class Model>
Matrix3Xd swing(const Body& body, const std::shared_ptr<math::Team>& team) {
  SolverOptions options;
  options.team = team;
  Model model(body, options);
  model.prepare();
  model.set_gravity({0, 0, -9.81});
  model.hold(0, body.grasps[0].X_OG_rest);
  math::Pose X = body.grasps[0].X_OG_rest;
  for (int k = 0; k < 150; ++k) {
    X.translation().z() += 1e-4;
    model.hold(0, X);
    model.step(kDt);
    if (k % 5 == 0) refactor(model);
  }
  return model.positions();
}

TEST(Team, StepsAreThoseOfOneMember) {
  for (ElementOrder order : {ElementOrder::kLinear, ElementOrder::kQuadratic}) {
    const Body body = long_bar(order);
    const Matrix3Xd dynamic = swing<CorotationalDynamic>(body, nullptr);
    const Matrix3Xd quasistatic = swing<CorotationalQuasistatic>(body, nullptr);
    for (int size : {2, 4}) {
      const auto forwards = std::make_shared<Turns>(size);
      const auto backwards = std::make_shared<Turns>(size, true);
      const Matrix3Xd x = swing<CorotationalDynamic>(body, forwards);
      EXPECT_LT((x - dynamic).colwise().norm().maxCoeff(), 1e-6);
      EXPECT_EQ(x, swing<CorotationalDynamic>(body, backwards));
      const Matrix3Xd y = swing<CorotationalQuasistatic>(body, forwards);
      EXPECT_LT((y - quasistatic).colwise().norm().maxCoeff(), 1e-6);
    }
    EXPECT_EQ(dynamic, swing<CorotationalDynamic>(body, std::make_shared<Turns>(1)));
  }
}

}  // namespace
}  // namespace palpate::elasticity
