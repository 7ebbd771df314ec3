#include "sim/robot/dart_soft_body.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <vector>

#include "sim/robot/reactive_grasp.hpp"

namespace palpate::robot {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kDt = 1e-3;
constexpr double kEdge = 0.08;            // m
constexpr double kScenesModulus = 5.3e3;  // Pa, as stated in its file

SoftBoxOptions small_box() {
  SoftBoxOptions o;
  o.vertices = {4, 4, 4};  // 56
  return o;
}

SoftBoxOptions held_box(double vertex_stiffness = 50) {
  SoftBoxOptions o = small_box();
  o.vertex_stiffness = vertex_stiffness;
  o.gravity_O.setZero();
  return o;
}

void run(DartSoftBody& box, int steps) {
  for (int i = 0; i < steps; ++i) box.step(kDt);
}

/// Vertices of the face whose coordinate `axis` is `value`.
std::vector<int> face(const DartSoftBody& box, int axis, double value) {
  std::vector<int> found;
  for (int i = 0; i < box.vertex_count(); ++i)
    if (std::abs(box.positions()(axis, i) - value) < 1e-9) found.push_back(i);
  return found;
}

double mean(const DartSoftBody& box, const std::vector<int>& vertices, int axis) {
  double sum = 0;
  for (int i : vertices) sum += box.positions()(axis, i);
  return sum / vertices.size();
}

/// Elongation by a pull on both ends: effective Young's modulus, Pa.
double pulled_modulus(const SoftBoxOptions& options) {
  DartSoftBody box(options);
  const std::vector<int> low = face(box, 0, 0), high = face(box, 0, kEdge);
  const double force = 0.4;
  for (int i : low) box.pull(i, {-force / low.size(), 0, 0});
  for (int i : high) box.pull(i, {force / high.size(), 0, 0});
  run(box, 300);
  const double stretch = mean(box, high, 0) - mean(box, low, 0) - kEdge;
  return force / (kEdge * kEdge) / (stretch / kEdge);
}

/// The same from the equilibrium of the skin, (k_v + k_e L) u = f with the graph Laplacian L of its
/// edges (Jain and Liu 2011).
double expected_modulus(const SoftBoxOptions& options) {
  DartSoftBody box(options);
  const int n = box.vertex_count();
  MatrixXd stiffness = options.vertex_stiffness * MatrixXd::Identity(n, n);
  MatrixXd joined = MatrixXd::Zero(n, n);
  for (int t = 0; t < box.surface_triangles().cols(); ++t)
    for (int e = 0; e < 3; ++e) {
      const int a = box.surface_triangles()(e, t), b = box.surface_triangles()((e + 1) % 3, t);
      joined(a, b) = joined(b, a) = 1;
    }
  stiffness += options.edge_stiffness * (MatrixXd(joined.rowwise().sum().asDiagonal()) - joined);
  const std::vector<int> low = face(box, 0, 0), high = face(box, 0, kEdge);
  VectorXd force = VectorXd::Zero(n);
  for (int i : low) force(i) -= 1.0 / low.size();
  for (int i : high) force(i) += 1.0 / high.size();
  const VectorXd u = stiffness.ldlt().solve(force);
  double stretch = 0;
  for (int i : high) stretch += u(i) / high.size();
  for (int i : low) stretch -= u(i) / low.size();
  return 1 / (kEdge * stretch);
}

TEST(DartSoftBody, ModulusUnderAPullIsTheSkinsAndGrowsWithVertexStiffness) {
  double last = 0;
  for (double k : {12.5, 50.0, 200.0, 800.0}) {
    const double modulus = pulled_modulus(held_box(k));
    EXPECT_NEAR(modulus, expected_modulus(held_box(k)), 0.01 * modulus) << k;
    EXPECT_GT(modulus, 1.1 * last) << k;
    last = modulus;
    RecordProperty("E_Pa_at_" + std::to_string(std::lround(k)) + "_N_m", std::to_string(modulus));
  }
}

/// Effective Young's modulus of a cube pressed between plates by 2 mm from each side, Pa.
double pressed_modulus(const SoftBoxOptions& options) {
  DartSoftBody box(options);
  const double edge = options.size.z(), middle = edge / 2;
  const int top = box.add_plate({0.12, 0.12, 0.02}, {middle, middle, edge + 0.0101});
  const int bottom = box.add_plate({0.12, 0.12, 0.02}, {middle, middle, -0.0101});
  box.move(top, {0, 0, -0.01});
  box.move(bottom, {0, 0, 0.01});
  double sum = 0;
  for (int i = 0; i < 300; ++i) {
    if (i == 200) {
      box.move(top, Vector3d::Zero());
      box.move(bottom, Vector3d::Zero());
    }
    box.step(kDt);
    if (i >= 250)
      sum += 0.5 * (box.probe_contact(top).force.z() - box.probe_contact(bottom).force.z()) / 50;
  }
  return sum / (edge * edge) / (2 * (0.002 - 0.0001) / edge);
}

TEST(DartSoftBody, PressBetweenPlatesStiffensWithVertexStiffness) {
  double last = 0;
  for (double k : {25.0, 100.0, 400.0}) {
    const double modulus = pressed_modulus(held_box(k));
    EXPECT_GT(modulus, 1.3 * last) << k;
    last = modulus;
    RecordProperty("E_Pa_at_" + std::to_string(std::lround(k)) + "_N_m", std::to_string(modulus));
  }
}

/// Source of the figure in sim/scenes/cube_dart_soft_tactile.yaml for its cube: both stiffnesses
/// scaled together.
TEST(DartSoftBody, TheScenesCubeIsAsStiffAsItSays) {
  for (double scale : {0.5, 1.0, 2.0}) {
    SoftBoxOptions o = held_box(50 * scale);
    o.size.setConstant(0.06);
    o.vertices = {5, 5, 5};
    o.edge_stiffness = 20 * scale;
    const double modulus = pressed_modulus(o);
    std::printf("springs x %.1f: effective E %.0f Pa\n", scale, modulus);
    if (scale == 1) {
      EXPECT_NEAR(modulus, kScenesModulus, 0.1 * kScenesModulus);
    }
  }
}

TEST(DartSoftBody, DentsUnderAFingertipAndComesBack) {
  DartSoftBody box(held_box());
  const Eigen::Matrix3Xd rest = box.positions();
  const int finger = box.add_sphere(0.009, {0.04, 0.04, kEdge + 0.0092});
  box.move(finger, {0, 0, -0.02});
  double last = 0;
  for (int i = 0; i < 5; ++i) {  // 1 mm each
    run(box, 50);
    EXPECT_GT(box.probe_contact(finger).force.z(), last);
    last = box.probe_contact(finger).force.z();
    EXPECT_LT(box.probe_contact(finger).force.head<2>().norm(), 0.3 * last);
  }
  EXPECT_GT((box.positions() - rest).colwise().norm().maxCoeff(), 5e-4);
  box.move(finger, {0, 0, 0.05});
  run(box, 400);
  EXPECT_EQ(box.probe_contact(finger).force.norm(), 0);
  EXPECT_EQ(box.contact_count(), 0);
  EXPECT_LT((box.positions() - rest).colwise().norm().maxCoeff(), 5e-5);
}

TEST(DartSoftBody, TwoRunsAreEqualToTheBit) {
  const auto run_once = [] {
    DartSoftBody box(small_box());
    const int finger = box.add_sphere(0.008, {0.03, 0.05, kEdge + 0.008});
    box.move(finger, {0.005, 0, -0.02});
    run(box, 150);
    return Eigen::Matrix3Xd(box.positions());
  };
  EXPECT_EQ(run_once(), run_once());
}

/// Two fingertips whose joints rotate levers of 80 mm, closed around the box by the reactive grasp.
TEST(DartSoftBody, ReactiveGraspHoldsItWithinTheForceBand) {
  DartSoftBody box(held_box());
  const double radius = 0.009, lever = 0.08;
  const int left = box.add_sphere(radius, {-radius - 0.004, 0.04, 0.04});
  const int right = box.add_sphere(radius, {kEdge + radius + 0.004, 0.04, 0.04});
  const JointLimits limits{VectorXd::Constant(2, -0.5), VectorXd::Constant(2, 0.5),
                           VectorXd::Constant(2, 4), VectorXd::Constant(2, 1)};
  ReactiveGrasp grasp({{{0}, 0.05}, {{1}, 0.05}}, limits);
  grasp.reset(VectorXd::Zero(2));
  grasp.close();
  VectorXd q = VectorXd::Zero(2), force = VectorXd::Zero(2), target = q;
  for (int i = 0; i < 1500; ++i) {
    if (i % 10 == 0) target = grasp.step(q, force);
    const VectorXd rate = (40 * (target - q)).cwiseMax(-4).cwiseMin(4);
    q += kDt * rate;
    box.move(left, {lever * rate(0), 0, 0});
    box.move(right, {-lever * rate(1), 0, 0});
    box.step(kDt);
    force << box.probe_contact(left).force.norm(), box.probe_contact(right).force.norm();
  }
  EXPECT_EQ(grasp.in_band(), 2);
  EXPECT_GE(force.minCoeff(), 0.1);
  EXPECT_LE(force.maxCoeff(), 1.0);
}

TEST(DartSoftBody, FiveFingertipsTouchTheLargestBox) {
  SoftBoxOptions o = held_box();
  o.vertices = {7, 7, 7};
  DartSoftBody box(o);
  EXPECT_EQ(box.vertex_count(), 218);
  const auto timed = [&box](int steps) {
    const auto begin = std::chrono::steady_clock::now();
    run(box, steps);
    return 1e6 * std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() /
           steps;
  };
  RecordProperty("free_us", std::to_string(timed(100)));
  for (int i = 0; i < 5; ++i)
    box.move(box.add_sphere(0.007, {0.01 + 0.015 * i, 0.04, kEdge + 0.0069}), {0, 0, -0.02});
  run(box, 150);
  for (int i = 0; i < 5; ++i) box.move(i, Vector3d::Zero());
  RecordProperty("five_fingertips_us", std::to_string(timed(50)));
  RecordProperty("contacts", box.contact_count());
  for (int i = 0; i < 5; ++i) EXPECT_GT(box.probe_contact(i).force.z(), 0.03) << i;
}

TEST(DartSoftBody, RefusesWhatDartCannotDo) {
  const auto with = [](auto change) {
    SoftBoxOptions o;
    change(o);
    return o;
  };
  using O = SoftBoxOptions;
  EXPECT_THROW(DartSoftBody(with([](O& o) { o.vertices = {2, 5, 5}; })), std::invalid_argument);
  EXPECT_THROW(DartSoftBody(with([](O& o) { o.vertices = {9, 9, 9}; })), std::invalid_argument);
  EXPECT_THROW(DartSoftBody(with([](O& o) { o.mass = 0; })), std::invalid_argument);
  EXPECT_THROW(DartSoftBody(with([](O& o) { o.vertex_stiffness = 0; })), std::invalid_argument);
  EXPECT_THROW(DartSoftBody(with([](O& o) { o.size.x() = -1; })), std::invalid_argument);
  DartSoftBody box{SoftBoxOptions()};
  EXPECT_THROW(box.probe_contact(0), std::out_of_range);
  EXPECT_THROW(box.pull(98, Vector3d::Zero()), std::out_of_range);
}

}  // namespace
}  // namespace palpate::robot
