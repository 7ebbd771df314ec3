#include "tools/fit/held/held_modes.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <stdexcept>

#include "core/elasticity/body_system.hpp"
#include "core/elasticity/element_tangents.hpp"
#include "core/elasticity/static_response.hpp"
#include "core/math/random.hpp"

namespace palpate::fit {
namespace {

using Eigen::MatrixXd;
using factor::BlockMatrix;
using factor::BlockPattern;
using factor::NodalColumns;

constexpr factor::Held kHand{true, false};
constexpr int kGuard =
    4;  // columns in addition to the requested ones: the first mode outside limits the convergence
constexpr int kPasses = 400;

/// Rows of the given degrees of freedom become zero.
void clear_given(const BlockPattern& pattern, NodalColumns& columns) {
  for (int node = 0; node < pattern.node_count(); ++node) {
    const int unknown = pattern.unknown(node);
    if (unknown < 0 || !pattern.is_free(unknown, kHand)) columns.middleRows<3>(3 * node).setZero();
  }
}

NodalColumns solve(const factor::SupernodalFactor& factor, const BlockPattern& pattern,
                   const NodalColumns& loads) {
  MatrixXd rhs(3 * pattern.size(), loads.cols());
  for (int k = 0; k < pattern.size(); ++k)
    rhs.middleRows<3>(3 * k) = loads.middleRows<3>(3 * pattern.node(k));
  factor.solve(rhs, kHand);
  NodalColumns solution = NodalColumns::Zero(loads.rows(), loads.cols());
  for (int k = 0; k < pattern.size(); ++k)
    solution.middleRows<3>(3 * pattern.node(k)) = rhs.middleRows<3>(3 * k);
  clear_given(pattern, solution);
  return solution;
}

/// Leaves modes of unit mass in the columns of `shapes`; returns their omega^2.
Eigen::VectorXd iterate(const BlockMatrix& K, const BlockMatrix& M,
                        const factor::SupernodalFactor& factor, int count, NodalColumns& shapes) {
  NodalColumns product(shapes.rows(), shapes.cols());
  Eigen::VectorXd before = Eigen::VectorXd::Zero(count);
  for (int pass = 0; pass < kPasses; ++pass) {
    M.multiply(shapes, product);
    shapes = solve(factor, K.pattern(), product);
    K.multiply(shapes, product);
    const MatrixXd stiffness = shapes.transpose() * product;
    M.multiply(shapes, product);
    const MatrixXd mass = shapes.transpose() * product;
    const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> solver(stiffness, mass);
    shapes = NodalColumns(shapes * solver.eigenvectors());
    const Eigen::VectorXd squares = solver.eigenvalues().head(count);
    if ((squares - before).cwiseAbs().maxCoeff() < 1e-13 * squares.maxCoeff()) break;
    before = squares;
  }
  return before;
}

}  // namespace

HeldModes find_modes(const elasticity::Body& body, const math::Pose& X_OG,
                     const Eigen::Matrix3Xd& at, int count) {
  elasticity::BodySystem system(body);
  const auto tangents = elasticity::make_element_tangents(system.elements, system.pattern);
  tangents->assemble(at, elasticity::Tangent::kExact, system.matrix, nullptr);
  if (!system.factor.factorise(system.matrix) || !system.factor.is_positive(kHand))
    throw std::invalid_argument("vibrations: the equilibrium is not stable");
  BlockMatrix mass(system.pattern);
  mass.add_scalar(1, elasticity::mass_blocks(system.elements, system.pattern));

  const int rows = 3 * body.mesh.node_count();
  const int columns = (count + kGuard + 3) / 4 * 4;
  NodalColumns shapes(rows, columns);
  math::Random random(1);
  std::generate(shapes.data(), shapes.data() + shapes.size(), [&] { return random.normal(); });
  clear_given(system.pattern, shapes);
  const Eigen::VectorXd squares = iterate(system.matrix, mass, system.factor, count, shapes);

  elasticity::Snapshot snapshot;
  snapshot.positions = at;
  snapshot.held = kHand;
  snapshot.grasps[0] = X_OG;
  snapshot.loads.setZero(3, body.mesh.node_count());
  snapshot.gravity_O = body.gravity_O;
  elasticity::Sensitivity response;
  elasticity::StaticResponse(body, system.elements, system.pattern)
      .compute(snapshot, system.matrix, system.factor, response);

  HeldModes modes;
  modes.frequencies = squares.cwiseSqrt();
  modes.wrenches.setZero(6, count);
  NodalColumns stiff(rows, columns), heavy(rows, columns);
  system.matrix.multiply(shapes, stiff);
  mass.multiply(shapes, heavy);
  modes.stops = heavy.leftCols(count).transpose() * response.dx_dxi[0];
  for (int node : body.grasps[0].nodes) {
    const Eigen::Matrix3d lever = math::cross_matrix(at.col(node) - X_OG.translation());
    for (int i = 0; i < count; ++i) {
      const Eigen::Vector3d force =
          stiff.block<3, 1>(3 * node, i) - squares[i] * heavy.block<3, 1>(3 * node, i);
      modes.wrenches.col(i).head<3>() += force;
      modes.wrenches.col(i).tail<3>() += lever * force;
    }
  }
  return modes;
}

}  // namespace palpate::fit
