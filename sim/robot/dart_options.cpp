#include "sim/robot/dart_options.hpp"

#include <dart/collision/CollisionDetector.hpp>
#include <dart/constraint/BoxedLcpConstraintSolver.hpp>
#include <dart/constraint/BoxedLcpSolver.hpp>
#include <dart/constraint/ContactConstraint.hpp>
#include <dart/constraint/SoftContactConstraint.hpp>
#include <dart/simulation/World.hpp>

#include "sim/robot/number_text.hpp"

namespace palpate::robot {
namespace {

template <class Constraint>
std::string contact_options() {
  return "allowance " + number(Constraint::getErrorAllowance()) + " m, reduction " +
         number(Constraint::getErrorReductionParameter()) + ", at most " +
         number(Constraint::getMaxErrorReductionVelocity()) + " m/s, mixing " +
         number(Constraint::getConstraintForceMixing());
}

}  // namespace

std::string effective_options(const dart::simulation::World& world) {
  const dart::constraint::ConstraintSolver* solver = world.getConstraintSolver();
  const auto* boxed = dynamic_cast<const dart::constraint::BoxedLcpConstraintSolver*>(solver);
  const Eigen::Vector3d gravity = world.getGravity();
  return "step " + number(1e3 * world.getTimeStep()) + " ms, gravity [" + number(gravity.x()) +
         ", " + number(gravity.y()) + ", " + number(gravity.z()) + "] m/s^2, " +
         std::to_string(world.getNumSkeletons()) + " skeletons, collision by " +
         solver->getCollisionDetector()->getType() + " with at most " +
         std::to_string(solver->getCollisionOption().maxNumContacts) + " contacts, solved by " +
         (boxed != nullptr ? boxed->getBoxedLcpSolver()->getType() : "a solver of its own") +
         "; rigid contacts: " + contact_options<dart::constraint::ContactConstraint>() +
         "; soft contacts: " + contact_options<dart::constraint::SoftContactConstraint>();
}

}  // namespace palpate::robot
