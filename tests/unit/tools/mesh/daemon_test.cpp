// The output of each command is accepted by palpated's own loader, and mechanics on it is correct:
// a patch test, and beam theory if the body is a beam.

#include <Eigen/Geometry>
#include <algorithm>

#include "core/elasticity/static_solver.hpp"
#include "core/mesh/report.hpp"
#include "core/mesh/surface.hpp"
#include "rt/config/node.hpp"
#include "rt/registry/frames.hpp"
#include "rt/registry/object.hpp"
#include "tests/unit/tools/mesh/mesh_folder.hpp"

namespace palpate::mesh_tool {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

constexpr double kYoung = 1e5;  // Pa; Poisson's ratio is zero, so that clamps cause no strain

class Daemon : public MeshFolder {
 protected:
  registry::Object load(const std::string& file, const std::string& order,
                        const std::string& more = "") {
    const config::Node node = config::Node::load_file(
        write("object.yaml", "object:\n  mesh: {file: " + file + "}\n  order: " + order +
                                 "\n  material: {young_modulus: 1e5, poisson_ratio: 0, density: "
                                 "100}\n  gravity: false\n" +
                                 more));
    return registry::read_object(node, registry::Frames());
  }

  /// Nodal forces of a traction (by outward normal, Pa) on selected surface triangles.
  template <typename Wanted, typename Traction>
  static Matrix3Xd loads(const registry::Object& object, Wanted wanted, Traction traction) {
    const Matrix3Xd& rest = object.body.mesh.nodes;
    Matrix3Xd result = Matrix3Xd::Zero(3, rest.cols());
    for (const std::vector<int>& nodes : object.surface.triangle_nodes) {
      const Vector3d a = rest.col(nodes[0]), b = rest.col(nodes[1]), c = rest.col(nodes[2]);
      if (!wanted(Vector3d((a + b + c) / 3))) continue;
      const Vector3d force = traction(Vector3d(0.5 * (b - a).cross(c - a)));
      // Of a uniform traction on a planar side the corners carry all at order 1, the midside nodes
      // at order 2.
      const std::size_t first = nodes.size() == 3 ? 0 : 3;
      for (std::size_t i = first; i < first + 3; ++i) result.col(nodes[i]) += force / 3;
    }
    return result;
  }

  /// Uniform tension normal to the plane of three fixed nodes: nodes move in proportion to their
  /// distance from it, on any mesh of any body.
  void expect_patch_test(const std::string& file) {
    for (const std::string order : {"linear", "quadratic"}) {
      registry::Object object = load(file, order);
      elasticity::Body& body = object.body;
      const Matrix3Xd& rest = body.mesh.nodes;
      int first = 0, second = 0, third = 0;
      rest.colwise().sum().minCoeff(&first);
      (rest.colwise() - rest.col(first)).colwise().norm().maxCoeff(&second);
      const Vector3d axis = (rest.col(second) - rest.col(first)).normalized();
      double most = 0;
      for (int n = 0; n < rest.cols(); ++n) {
        const double away = axis.cross(Vector3d(rest.col(n) - rest.col(first))).norm();
        if (away > most) third = n;
        most = std::max(most, away);
      }
      body.fixed_nodes = {first, second, third};
      std::sort(body.fixed_nodes.begin(), body.fixed_nodes.end());
      const Vector3d normal = axis.cross(Vector3d(rest.col(third) - rest.col(first))).normalized();
      constexpr double kStress = 1;  // Pa
      const Matrix3Xd forces = loads(
          object, [](const Vector3d&) { return true; },
          [&](const Vector3d& area) -> Vector3d { return kStress * normal * normal.dot(area); });
      const Matrix3Xd expected =
          normal * (kStress / kYoung * normal.transpose() * (rest.colwise() - rest.col(first)));
      const Matrix3Xd found = elasticity::solve_linear_statics(body, forces);
      EXPECT_LT((found - expected).cwiseAbs().maxCoeff(), 1e-8 * expected.cwiseAbs().maxCoeff())
          << file << ", " << order;
    }
  }

  /// Deflection (m) along z of the far end, clamped at x = 0, under 1 mN distributed over that end.
  double tip_deflection(const std::string& file, double length) {
    registry::Object object =
        load(file, "quadratic", "  fixed_box: {lower: [0, -1, -1], upper: [0, 1, 1]}\n");
    const Matrix3Xd& rest = object.body.mesh.nodes;
    const auto at_end = [&](const Vector3d& p) { return p.x() > length - 1e-9; };
    Matrix3Xd forces = loads(object, at_end, [](const Vector3d& area) -> Vector3d {
      return Vector3d::UnitZ() * area.norm();
    });
    forces *= 1e-3 / forces.row(2).sum();
    const Matrix3Xd moved = elasticity::solve_linear_statics(object.body, forces);
    double sum = 0;
    int count = 0;
    for (int n = 0; n < rest.cols(); ++n) {
      if (!at_end(rest.col(n))) continue;
      sum += moved(2, n);
      ++count;
    }
    return sum / count;
  }

  /// Timoshenko's beam, G = E / 2.
  static double theory(double length, double area, double second_moment, double shear_factor) {
    constexpr double kForce = 1e-3;
    return kForce * std::pow(length, 3) / (3 * kYoung * second_moment) +
           kForce * length / (shear_factor * 0.5 * kYoung * area);
  }
};

TEST_F(Daemon, TakesBoxesInEveryFormat) {
  for (const std::string name : {"bar.msh", "bar.veg", "bar.node"}) {
    ASSERT_EQ(run({"box", path(name), "--size", "0.4", "0.05", "0.05", "--edge", "0.025"}), 0)
        << output();
    expect_patch_test(name);
    const double expected = theory(0.4, 0.0025, std::pow(0.05, 4) / 12, 5.0 / 6);
    EXPECT_NEAR(tip_deflection(name, 0.4), expected, 0.01 * expected) << name;
  }
  ASSERT_EQ(run({"box", path("five.msh"), "--size", "0.1", "0.05", "0.05", "--cells", "4", "2", "2",
                 "--cut", "five", "--binary"}),
            0)
      << output();
  expect_patch_test("five.msh");
}

TEST_F(Daemon, TakesCylindersOfEitherOrder) {
  for (const std::string order : {"1", "2"}) {
    ASSERT_EQ(run({"cylinder", path("rod.msh"), "--radius", "0.025", "--length", "0.4", "--edge",
                   "0.0125", "--order", order}),
              0)
        << output();
    expect_patch_test("rod.msh");
    const double area = EIGEN_PI * 0.025 * 0.025;
    const double expected = theory(0.4, area, area * 0.025 * 0.025 / 4, 0.9);
    EXPECT_NEAR(tip_deflection("rod.msh", 0.4), expected, 0.02 * expected) << order;
  }
}

TEST_F(Daemon, TakesEllipsoidsOfEitherMesher) {
  for (const std::string mesher : {"own", "gmsh"}) {
    ASSERT_EQ(run({"ellipsoid", path("egg.msh"), "--half-axes", "0.05", "0.03", "0.03", "--edge",
                   "0.015", "--mesher", mesher}),
              0)
        << output();
    expect_patch_test("egg.msh");
    const double exact = 4 * EIGEN_PI / 3 * 0.05 * 0.03 * 0.03;
    EXPECT_NEAR(mesh::check(load("egg.msh", "linear").corners).volume, exact, 5e-3 * exact)
        << mesher;
  }
}

TEST_F(Daemon, TakesSurfacesThatGmshFilled) {
  ASSERT_EQ(run({"box", path("bar.stl"), "--size", "400", "50", "50", "--edge", "25"}), 0);
  ASSERT_EQ(run({"surface", path("bar.stl"), path("bar.msh"), "--scale", "mm", "--edge", "0.025"}),
            0)
      << output();
  expect_patch_test("bar.msh");
  const double expected = theory(0.4, 0.0025, std::pow(0.05, 4) / 12, 5.0 / 6);
  EXPECT_NEAR(tip_deflection("bar.msh", 0.4), expected, 0.01 * expected);
  for (const std::string command : {"convert", "repair", "optimise"}) {
    ASSERT_EQ(run({command, path("bar.msh"), path(command + ".veg")}), 0) << output();
    EXPECT_NEAR(tip_deflection(command + ".veg", 0.4), expected, 0.01 * expected) << command;
  }
}

}  // namespace
}  // namespace palpate::mesh_tool
