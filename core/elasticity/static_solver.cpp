#include "core/elasticity/static_solver.hpp"

#include <stdexcept>

#include "core/elasticity/body_system.hpp"
#include "core/elasticity/element_tangents.hpp"
#include "core/elasticity/static_response.hpp"

namespace palpate::elasticity {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

/// Newton's method on one body.
class StaticSolver::Newton {
 public:
  explicit Newton(const Body& body)
      : body_(checked(body)),
        system_(body_),
        tangents_(make_element_tangents(system_.elements, system_.pattern)),
        loads_(Matrix3Xd::Zero(3, body_.mesh.node_count())),
        weight_(body_.gravity_O * system_.elements.nodal_mass().transpose()),
        x_(body_.mesh.nodes),
        rhs_(3 * system_.pattern.size(), 1) {
    set_load(1);
  }

  const Body& body() const { return body_; }
  void hold(const HeldPoses& poses) {
    poses_ = poses;
    held_ = {poses[0].has_value(), poses[1].has_value()};
  }
  void take_loads(const Matrix3Xd& loads) {
    loads_ = loads;
    set_load(1);
  }
  void set_load(double share) { external_ = share * (loads_ + weight_); }
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

  Sensitivity response() {
    Sensitivity response;
    if (!factorise(Tangent::kExact)) return response;
    Snapshot at;
    at.positions = x_;
    at.held = held_;
    for (int g = 0; g < 2; ++g)
      if (poses_[g]) at.grasps[g] = *poses_[g];
    at.loads = loads_;
    at.gravity_O = body_.gravity_O;
    StaticResponse(body_, system_.elements, system_.pattern)
        .compute(at, system_.matrix, system_.factor, response);
    return response;
  }

 private:
  static const Body& checked(const Body& body) {
    body.check();
    return body;
  }

  Body body_;
  BodySystem system_;
  std::unique_ptr<ElementTangents> tangents_;
  HeldPoses poses_;
  factor::Held held_{false, false};
  Matrix3Xd loads_, weight_, external_, x_, forces_;
  Eigen::MatrixXd rhs_;
};

namespace {

/// Pose interpolated between two others.
math::Pose between(const math::Pose& from, const math::Pose& to, double share) {
  const Vector3d turn = math::log_rotation(to.linear() * from.linear().transpose());
  return math::make_pose(math::exp_rotation(share * turn) * from.linear(),
                         from.translation() + share * (to.translation() - from.translation()));
}

}  // namespace

StaticSolver::StaticSolver(const Body& body) : newton_(std::make_unique<Newton>(body)) {}
StaticSolver::~StaticSolver() = default;

StaticSolution StaticSolver::solve(const Matrix3Xd& loads, const HeldPoses& held,
                                   const StaticOptions& options, const Matrix3Xd* start) {
  Newton& newton = *newton_;
  const Body& body = newton.body();
  newton.take_loads(loads);
  newton.hold(held);
  const Matrix3Xd begin = start ? *start : body.mesh.nodes;
  StaticSolution solution;
  for (int steps = 1; steps <= options.load_steps && !solution.converged; steps *= 2) {
    solution.load_steps = steps;
    newton.positions() = begin;
    solution.converged = true;
    for (int s = 1; s <= steps && solution.converged; ++s) {
      const double share = static_cast<double>(s) / steps;
      newton.set_load(share);
      for (std::size_t g = 0; g < body.grasps.size(); ++g) {
        if (!held[g]) continue;
        const GraspRegion& grasp = body.grasps[g];
        const math::Pose moved =
            between(grasp.X_OG_rest, *held[g], share) * grasp.X_OG_rest.inverse();
        for (int node : grasp.nodes) {
          newton.positions().col(node) = moved * body.mesh.nodes.col(node);
        }
      }
      solution.converged = newton.solve(options, solution.iterations);
    }
  }
  solution.positions = newton.positions();
  solution.residual = newton.residual();
  solution.reactions = Matrix3Xd::Zero(3, body.mesh.node_count());
  for (int node : body.fixed_nodes) solution.reactions.col(node) = newton.forces().col(node);
  for (std::size_t g = 0; g < body.grasps.size(); ++g) {
    if (!held[g]) continue;
    for (int node : body.grasps[g].nodes) solution.reactions.col(node) = newton.forces().col(node);
  }
  return solution;
}

Sensitivity StaticSolver::response() { return newton_->response(); }

Matrix3Xd StaticSolver::solve_linear(const Matrix3Xd& loads) {
  newton_->take_loads(loads);
  newton_->hold({});
  newton_->positions() = newton_->body().mesh.nodes;
  newton_->evaluate();
  if (!newton_->factorise(Tangent::kExact)) {
    throw std::runtime_error("linear statics: the stiffness matrix is not positive definite");
  }
  return newton_->correction();
}

Matrix3Xd solve_linear_statics(const Body& body, const Matrix3Xd& loads) {
  return StaticSolver(body).solve_linear(loads);
}

StaticSolution solve_static(const Body& body, const Matrix3Xd& loads, const HeldPoses& held,
                            const StaticOptions& options, const Matrix3Xd* start) {
  return StaticSolver(body).solve(loads, held, options, start);
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
