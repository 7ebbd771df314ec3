#include "core/elasticity/static_solver.hpp"

#include <stdexcept>

#include "core/elasticity/body_system.hpp"
#include "core/elasticity/element_tangents.hpp"

namespace palpate::elasticity {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

/// Newton's method on one body.
class NewtonSolver {
 public:
  NewtonSolver(const Body& body, const Matrix3Xd& loads)
      : system_(body),
        tangents_(make_element_tangents(system_.elements, system_.pattern)),
        full_load_(loads + body.gravity_O * system_.elements.nodal_mass().transpose()),
        x_(body.mesh.nodes),
        rhs_(3 * system_.pattern.size(), 1) {
    set_load(1);
  }

  void hold(Held held) { held_ = held; }
  void set_load(double share) { external_ = share * full_load_; }
  Matrix3Xd& positions() { return x_; }
  const Matrix3Xd& forces() const { return forces_; }

  double evaluate() {
    const double energy = system_.forces.evaluate(x_, forces_);
    forces_ -= external_;
    const Matrix3Xd u = x_ - system_.elements.mesh().nodes;
    return energy - (external_.array() * u.array()).sum();
  }

  double residual() const {
    double largest = 0;
    for (int k = 0; k < system_.pattern.size(); ++k) {
      if (system_.pattern.is_free(k, held_))
        largest = std::max(largest, forces_.col(system_.pattern.node(k)).norm());
    }
    return largest;
  }

  bool factorise(Tangent kind) {
    tangents_->assemble(x_, kind, system_.matrix, nullptr);
    return system_.factor.factorise(system_.matrix) && system_.factor.is_positive(held_);
  }

  /// Solves K dx = -forces over the free nodes.
  Matrix3Xd correction() {
    Matrix3Xd dx = Matrix3Xd::Zero(3, x_.cols());
    for (int k = 0; k < system_.pattern.size(); ++k) {
      rhs_.block<3, 1>(3 * k, 0) = -forces_.col(system_.pattern.node(k));
    }
    system_.factor.solve(rhs_, held_);
    for (int k = 0; k < system_.pattern.size(); ++k) {
      dx.col(system_.pattern.node(k)) = rhs_.block<3, 1>(3 * k, 0);
    }
    return dx;
  }

  bool solve(const StaticOptions& options, int& iterations) {
    double energy = evaluate();
    for (int i = 0; i < options.iterations; ++i) {
      if (!std::isfinite(energy)) return false;
      if (residual() <= options.tolerance) return true;
      if (!factorise(Tangent::kExact) && !factorise(Tangent::kSemidefinite)) return false;
      const Matrix3Xd dx = correction();
      const double slope = (forces_.array() * dx.array()).sum();
      const Matrix3Xd start = x_;
      const double begin = residual();
      ++iterations;
      bool accepted = false;
      for (double alpha = 1; alpha > 1e-6 && !accepted; alpha /= 2) {
        x_ = start + alpha * dx;
        const double next = evaluate();
        const double rounding = 1e-12 * (std::abs(energy) + std::abs(next));
        accepted = next <= energy + 1e-4 * alpha * slope ||
                   (std::abs(next - energy) <= rounding && residual() < begin);
        if (accepted) energy = next;
      }
      if (!accepted) {
        x_ = start;
        evaluate();
        return residual() <= options.tolerance;
      }
    }
    return residual() <= options.tolerance;
  }

 private:
  BodySystem system_;
  std::unique_ptr<ElementTangents> tangents_;
  Held held_{false, false};
  Matrix3Xd full_load_, external_, x_, forces_;
  Eigen::MatrixXd rhs_;
};

/// Pose a share of the way from one to another.
math::Pose between(const math::Pose& from, const math::Pose& to, double share) {
  const Vector3d turn = math::log_rotation(to.linear() * from.linear().transpose());
  return math::make_pose(math::exp_rotation(share * turn) * from.linear(),
                         from.translation() + share * (to.translation() - from.translation()));
}

}  // namespace

Matrix3Xd solve_linear_statics(const Body& body, const Matrix3Xd& loads) {
  body.check();
  NewtonSolver solver(body, loads);
  solver.evaluate();
  if (!solver.factorise(Tangent::kExact)) {
    throw std::runtime_error("linear statics: the stiffness matrix is not positive definite");
  }
  return solver.correction();
}

StaticSolution solve_static(const Body& body, const Matrix3Xd& loads, const HeldPoses& held,
                            const StaticOptions& options, const Matrix3Xd* start) {
  body.check();
  NewtonSolver solver(body, loads);
  solver.hold({held[0].has_value(), held[1].has_value()});
  const Matrix3Xd begin = start ? *start : body.mesh.nodes;
  StaticSolution solution;
  for (int steps = 1; steps <= options.load_steps && !solution.converged; steps *= 2) {
    solution.load_steps = steps;
    solver.positions() = begin;
    solution.converged = true;
    for (int s = 1; s <= steps && solution.converged; ++s) {
      const double share = static_cast<double>(s) / steps;
      solver.set_load(share);
      for (std::size_t g = 0; g < body.grasps.size(); ++g) {
        if (!held[g]) continue;
        const GraspRegion& grasp = body.grasps[g];
        const math::Pose moved =
            between(grasp.X_OG_rest, *held[g], share) * grasp.X_OG_rest.inverse();
        for (int node : grasp.nodes) {
          solver.positions().col(node) = moved * body.mesh.nodes.col(node);
        }
      }
      solution.converged = solver.solve(options, solution.iterations);
    }
  }
  solution.positions = solver.positions();
  solution.residual = solver.residual();
  solution.reactions = Matrix3Xd::Zero(3, body.mesh.node_count());
  for (int node : body.fixed_nodes) solution.reactions.col(node) = solver.forces().col(node);
  for (std::size_t g = 0; g < body.grasps.size(); ++g) {
    if (!held[g]) continue;
    for (int node : body.grasps[g].nodes) solution.reactions.col(node) = solver.forces().col(node);
  }
  return solution;
}

math::Wrench patch_wrench(const GraspRegion& grasp, const math::Pose& X_OG,
                          const Matrix3Xd& positions, const Matrix3Xd& forces) {
  math::Wrench wrench;
  for (int node : grasp.nodes) {
    const Vector3d force = forces.col(node);
    wrench.force += force;
    wrench.torque += (positions.col(node) - X_OG.translation()).cross(force);
  }
  return wrench;
}

}  // namespace palpate::elasticity
