#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <numeric>

#include "core/elasticity/static_solver.hpp"
#include "tests/unit/core/elasticity/bodies.hpp"
#include "tests/unit/core/elasticity/elements.hpp"

namespace palpate::elasticity {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

double number(double lower, double upper) {
  return lower + (upper - lower) * *rc::gen::inRange(0, 1000001) / 1e6;
}

Vector3d vector(double size) {
  return {number(-size, size), number(-size, size), number(-size, size)};
}

Matrix3Xd vectors(int count, double size) {
  Matrix3Xd m(3, count);
  for (int i = 0; i < count; ++i) m.col(i) = vector(size);
  return m;
}

/// A small box of random size, material and element order.
Body random_body() {
  const auto order = *rc::gen::element(mesh::ElementOrder::kLinear, mesh::ElementOrder::kQuadratic);
  const Vector3d size(number(0.05, 0.3), number(0.03, 0.1), number(0.03, 0.1));
  return make_bar(size, {2, 1, 1}, order,
                  {std::pow(10, number(3, 6)), number(-0.3, 0.45), number(20, 1000)});
}

Matrix3d random_rotation() { return math::exp_rotation(vector(3)); }

/// Positions of a strained (up to about 30 %) and rotated body.
Matrix3Xd random_shape(const Body& body) {
  const double size = body.mesh.nodes.row(1).maxCoeff();
  const Matrix3Xd strained = body.mesh.nodes + vectors(body.mesh.node_count(), 0.04 * size) +
                             vector(0.1).replicate(1, body.mesh.node_count());
  return random_rotation() * strained;
}

template <class Property>
void check(const std::string& what, Property&& property) {
  EXPECT_TRUE(rc::check(what, std::forward<Property>(property)));
}

TEST(Elements, RigidMotionGivesNoForce) {
  check("rigid motion gives no force", [] {
    const Body body = random_body();
    Elements elements(body);
    const Matrix3Xd x = (random_rotation() * body.mesh.nodes).colwise() + vector(10);
    const Answer a = elements.evaluate(x);
    const double scale = body.material.young_modulus * 0.01;
    RC_ASSERT(a.forces.cwiseAbs().maxCoeff() < 1e-12 * scale);
    RC_ASSERT(std::abs(a.energy) < 1e-20 * scale);
  });
}

TEST(Elements, ARigidMotionWithinAStepIsNotDamped) {
  check("the viscous potential does not feel rigid motion", [] {
    const Body body = random_body();
    Elements elements(body);
    const Matrix3Xd x = random_shape(body);
    const auto [energy, before] = elements.evaluate(x);
    elements.begin_step();
    const Matrix3d R = math::exp_rotation(vector(0.5));
    const Answer a = elements.evaluate(R * x, 10);
    const double scale = before.norm() + 1e-3 * body.material.young_modulus * 0.01;
    RC_ASSERT((a.forces - R * before).norm() < 1e-9 * scale);
    RC_ASSERT(std::abs(a.energy - energy) < 1e-10 * (energy + 0.01 * scale));
  });
}

TEST(Elements, ForcesAndTorquesSumToZero) {
  check("forces and torques sum to zero", [] {
    const Body body = random_body();
    Elements elements(body);
    Matrix3Xd x = random_shape(body);
    elements.evaluate(x);
    elements.begin_step();
    x += vectors(static_cast<int>(x.cols()), 0.001);
    const Answer a = elements.evaluate(x, *rc::gen::element(0.0, 5.0));
    Vector3d torque = Vector3d::Zero();
    for (int i = 0; i < x.cols(); ++i) torque += x.col(i).cross(Vector3d(a.forces.col(i)));
    const double scale = a.forces.norm();
    RC_ASSERT(a.forces.rowwise().sum().norm() < 1e-11 * scale);
    RC_ASSERT(torque.norm() < 1e-11 * scale);
  });
}

TEST(Elements, ForceIsTheDerivativeOfEnergy) {
  check("force = dEnergy/dx, with and without damping", [] {
    const Body body = random_body();
    Elements elements(body);
    Matrix3Xd x = random_shape(body);
    elements.evaluate(x);
    elements.begin_step();
    const int n = static_cast<int>(x.cols());
    x += vectors(n, 0.002);
    const double viscous = *rc::gen::element(0.0, 5.0);
    const Matrix3Xd direction = vectors(n, 1);
    const double h = 1e-6;
    const double plus = elements.evaluate(x + h * direction, viscous).energy;
    const double minus = elements.evaluate(x - h * direction, viscous).energy;
    const Matrix3Xd forces = elements.evaluate(x, viscous).forces;
    const double slope = (forces.array() * direction.array()).sum();
    RC_ASSERT(std::abs((plus - minus) / (2 * h) - slope) < 1e-6 * forces.norm() * direction.norm());
  });
}

TEST(Elements, StiffnessIsSymmetricAndTheDerivativeOfForce) {
  check("stiffness is symmetric and the derivative of force", [] {
    const Body body = random_body();
    Elements elements(body);
    const Matrix3Xd x = random_shape(body);
    const int n = static_cast<int>(x.cols());
    const Matrix3Xd direction = vectors(n, 1);
    Matrix3Xd product = Matrix3Xd::Zero(3, n);
    Eigen::MatrixXd K;
    double scale = 0;
    for (int e = 0; e < elements.matrices.element_count(); ++e) {
      elements.matrices.stiffness(e, x, Tangent::kExact, 0, K);
      scale = std::max(scale, K.norm());
      RC_ASSERT((K - K.transpose()).norm() <= 1e-12 * K.norm());
      const Eigen::VectorXi nodes = body.mesh.elements.col(e);
      for (int a = 0; a < nodes.size(); ++a) {
        for (int b = 0; b < nodes.size(); ++b) {
          product.col(nodes(a)) += K.block<3, 3>(3 * a, 3 * b) * direction.col(nodes(b));
        }
      }
    }
    const double h = 1e-7;
    const Matrix3Xd difference = (elements.evaluate(x + h * direction).forces -
                                  elements.evaluate(x - h * direction).forces) /
                                 (2 * h);
    RC_ASSERT((difference - product).norm() < 1e-5 * scale * direction.norm());
  });
}

TEST(Elements, RenumberingNodesAndElementsChangesNothing) {
  check("renumbering changes nothing", [] {
    const Body body = random_body();
    const int n = body.mesh.node_count(), m = body.mesh.element_count();
    const auto permutation = [](int count) {
      std::vector<std::pair<int, int>> keyed;
      for (int i = 0; i < count; ++i) keyed.emplace_back(*rc::gen::inRange(0, 1 << 30), i);
      std::sort(keyed.begin(), keyed.end());
      std::vector<int> order;
      for (const auto& [key, i] : keyed) order.push_back(i);
      return order;
    };
    const std::vector<int> node_to_new = permutation(n), element_order = permutation(m);
    Body other = body;
    for (int i = 0; i < n; ++i) other.mesh.nodes.col(node_to_new[i]) = body.mesh.nodes.col(i);
    for (int e = 0; e < m; ++e) {
      for (int a = 0; a < body.mesh.nodes_per_element(); ++a) {
        other.mesh.elements(a, e) = node_to_new[body.mesh.elements(a, element_order[e])];
      }
    }
    for (int& node : other.fixed_nodes) node = node_to_new[node];
    for (int& node : other.grasps[0].nodes) node = node_to_new[node];

    Matrix3Xd load = Matrix3Xd::Zero(3, n), other_load = load;
    const double size = body.material.young_modulus * 1e-5;
    for (int i = 0; i < n; ++i) {
      load.col(i) = vector(size);
      other_load.col(node_to_new[i]) = load.col(i);
    }
    StaticOptions options;
    options.tolerance = 1e-9 * size;
    const StaticSolution a = solve_static(body, load, {}, options);
    const StaticSolution b = solve_static(other, other_load, {}, options);
    RC_ASSERT(a.converged);
    RC_ASSERT(b.converged);
    const double moved = (a.positions - body.mesh.nodes).norm();
    for (int i = 0; i < n; ++i) {
      RC_ASSERT((a.positions.col(i) - b.positions.col(node_to_new[i])).norm() < 1e-6 * moved);
    }
  });
}

}  // namespace
}  // namespace palpate::elasticity
