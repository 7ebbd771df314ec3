#include <gtest/gtest.h>

#include <cstdlib>

#include "core/elasticity/comparison/linear_model.hpp"
#include "core/elasticity/comparison/mass_spring_model.hpp"
#include "core/elasticity/comparison/shape_matching_model.hpp"
#include "core/elasticity/comparison/thesis2018.hpp"
#include "core/elasticity/corotational_model.hpp"
#include "core/elasticity/strain_scan.hpp"
#include "core/factor/solve_panels.hpp"
#include "rt/loop/sanitizer.hpp"
#include "tests/unit/core/elasticity/bodies.hpp"
#include "tests/unit/core/elasticity/turns.hpp"
#include "tests/unit/core/factor/block_systems.hpp"

// Sanitizers replace malloc.
#if PALPATE_SANITIZED
#define PALPATE_COUNTS_ALLOCATIONS 0
#else
#define PALPATE_COUNTS_ALLOCATIONS 1

namespace {
thread_local bool counting = false;
thread_local int allocations = 0;
}  // namespace

// operator new and Eigen's allocations both end here.
extern "C" void* __libc_malloc(std::size_t);
extern "C" void* malloc(std::size_t size) {
  if (counting) ++allocations;
  return __libc_malloc(size);
}
#endif

namespace palpate::elasticity {
namespace {

#if PALPATE_COUNTS_ALLOCATIONS
template <class Work>
int count_allocations(Work&& work) {
  allocations = 0;
  counting = true;
  work();
  counting = false;
  return allocations;
}
#else
template <class Work>
int count_allocations(Work&&) {
  return -1;
}
#endif

void expect_no_allocation(DeformationModel& model) {
  if (count_allocations([] {}) < 0) GTEST_SKIP() << "a sanitizer owns malloc";
  ASSERT_GT(count_allocations([] { Eigen::VectorXd::Zero(100).eval(); }), 0) << "counter works";
  model.prepare();
  const Body& body = model.body();
  const math::Pose rest = body.grasps[0].X_OG_rest;
  collision::Placement table;  // where there is one
  table.X_OB.translation().z() = -1e-4;
  Refactorisation* job = nullptr;
  const auto in_loop = [&](auto&& work) { EXPECT_EQ(count_allocations(work), 0); };
  in_loop([&] {
    model.loads().setConstant(1e-3);
    model.set_gravity({0, 0, -9.81});
    for (int i = 0; i < 5; ++i) model.step(1e-3);
    model.hold(0, rest);
    model.step(1e-3);
    job = model.wanted_refactorisation();
  });
  for (int round = 0; round < 3; ++round) {
    if (job) job->run();
    in_loop([&] {
      if (job) model.install(*job);
      math::Pose X = rest;
      for (int i = 0; i < 20; ++i) {
        X.translation().z() += 2e-4;
        model.hold(0, X);
        table.X_OB.translation().z() -= 1e-6;
        model.place_obstacle(0, table);
        model.step(1e-3);
        (void)model.reaction(0);
        (void)model.sensitivity();
      }
      model.loads()(0, 3) = std::nan("");
      model.step(1e-3);
      model.loads()(0, 3) = 0;
      job = model.wanted_refactorisation();
    });
  }
  in_loop([&] {
    model.restore(body.mesh.nodes, model.velocities());
    model.release(0);
    model.reset();
    model.step(1e-3);
  });
}

TEST(Allocation, NoneInTheScanOfStrains) {
  if (count_allocations([] {}) < 0) GTEST_SKIP() << "a sanitizer owns malloc";
  const Body body = make_bar({0.2, 0.05, 0.04}, {8, 2, 2}, mesh::ElementOrder::kQuadratic);
  StrainScan scan(body);
  const Eigen::Matrix3Xd x = 1.2 * body.mesh.nodes;
  EXPECT_EQ(count_allocations([&] { scan.look(x); }), 0);
  EXPECT_NEAR(scan.largest(), 0.2, 1e-9);
}

TEST(Allocation, NoneInFactorsAndTheirSolves) {
  if (count_allocations([] {}) < 0) GTEST_SKIP() << "a sanitizer owns malloc";
  const factor::TwoHandedBar bar(mesh::ElementOrder::kQuadratic);
  factor::BlockSystem system(bar.body.mesh, bar.middle, bar.ends);
  system.add_stiffness(bar.set, bar.body.mesh.nodes);
  const factor::Supernodes nodes(system.pattern);
  factor::SupernodalFactor factor(nodes);
  factor::SolvePanels single(nodes, factor::PanelPrecision::kSingle),
      half(nodes, factor::PanelPrecision::kHalf);
  Eigen::MatrixXd B = Eigen::MatrixXd::Random(3 * system.pattern.size(), 9);
  Eigen::VectorXf b = Eigen::VectorXf::Random(B.rows());
  bool ready = false;
  const int allocated = count_allocations([&] {
    ready = factor.factorise(system.matrix) && single.assign(factor) && half.assign(factor);
    for (factor::Held held : factor::kHeldSets) {
      factor.solve(B, held);
      single.solve(b.data(), held);
      half.solve(b.data(), held);
    }
  });
  EXPECT_TRUE(ready);
  EXPECT_EQ(allocated, 0);
}

TEST(Allocation, NoneInContactWithObstacles) {
  const Body bar = make_bar({0.2, 0.05, 0.05}, {4, 1, 1}, mesh::ElementOrder::kQuadratic);
  SolverOptions options;
  options.contact.obstacles = {
      {"table", collision::HalfSpace{}, math::make_pose(Eigen::Matrix3d::Identity(), {0, 0, -1e-4}),
       0.5},
      {"ball", collision::Sphere{0.03},
       math::make_pose(Eigen::Matrix3d::Identity(), {0.1, 0.025, 0.0805}), 0.5}};
  CorotationalQuasistatic quasistatic(bar, options);
  expect_no_allocation(quasistatic);
  CorotationalDynamic dynamic(bar, options);
  expect_no_allocation(dynamic);
  // it was in contact
  quasistatic.hold(0, bar.grasps[0].X_OG_rest);
  quasistatic.set_gravity({0, 0, -9.81});
  for (int i = 0; i < 20; ++i) quasistatic.step(1e-3);
  EXPECT_FALSE(quasistatic.contacts().empty());
}

TEST(Allocation, NoneInTheLoop) {
  const Body quadratic = make_bar({0.2, 0.05, 0.05}, {4, 1, 1}, mesh::ElementOrder::kQuadratic);
  const Body linear = make_bar({0.2, 0.05, 0.05}, {4, 2, 2}, mesh::ElementOrder::kLinear);
  CorotationalQuasistatic quasistatic(quadratic);
  expect_no_allocation(quasistatic);
  SolverOptions options;
  options.refine = 2;
  options.confirm = false;
  CorotationalQuasistatic refining(quadratic, options);
  expect_no_allocation(refining);
  CorotationalDynamic dynamic(quadratic);
  expect_no_allocation(dynamic);
  CorotationalDynamic linear_dynamic(linear);
  expect_no_allocation(linear_dynamic);
  SolverOptions shared;
  shared.team = std::make_shared<Turns>(3);
  CorotationalDynamic with_team(linear, shared);
  expect_no_allocation(with_team);
  Thesis2018 thesis(linear);
  expect_no_allocation(thesis);
  for (const NamedStretchLaw& named : stretch_laws()) {
    Body body = quadratic;
    std::vector<double> constants;
    for (const auto& constant : named.constants) constants.push_back(constant.start);
    body.law = named.make(constants);
    CorotationalQuasistatic hyperelastic(body, options);
    expect_no_allocation(hyperelastic);
  }
}

/// Mirrored without loads, and again under a load that holds it there: the shape is reset the first
/// time and kept the second.
TEST(Allocation, NoneWhereAShapeIsGivenUp) {
  if (count_allocations([] {}) < 0) GTEST_SKIP() << "a sanitizer owns malloc";
  const Body body = make_bar({0.2, 0.05, 0.05}, {4, 1, 1}, mesh::ElementOrder::kQuadratic);
  CorotationalQuasistatic model(body);
  model.prepare();
  Eigen::Matrix3Xd mirrored = body.mesh.nodes;
  mirrored.row(0) *= -1;
  const Eigen::Matrix3Xd still = Eigen::Matrix3Xd::Zero(3, mirrored.cols());
  for (const double force : {0.0, -1e6}) {
    model.loads().row(0).setConstant(force);
    bool restarted = false;
    const int allocated = count_allocations([&] {
      model.restore(mirrored, still);
      restarted = model.step(1e-3).restarted;
    });
    EXPECT_EQ(allocated, 0);
    EXPECT_EQ(restarted, force == 0);
  }
}

TEST(Allocation, NoneInTheModelsForComparison) {
  for (auto order : {mesh::ElementOrder::kLinear, mesh::ElementOrder::kQuadratic}) {
    const Body body = make_bar({0.2, 0.05, 0.05}, {4, 2, 1}, order);
    LinearModel linear(body);
    expect_no_allocation(linear);
    MassSpringModel mass_spring(body);
    expect_no_allocation(mass_spring);
    ShapeMatchingModel shape_matching(body);
    expect_no_allocation(shape_matching);
  }
}

}  // namespace
}  // namespace palpate::elasticity
