#pragma once

#include <memory>

#include "core/elasticity/body.hpp"
#include "core/elasticity/sensitivity.hpp"
#include "core/mesh/point_locator.hpp"

namespace palpate::elasticity {

enum class StepStatus {
  kConverged,     // within tolerance or accuracy
  kNotConverged,  // iterations spent; the state is the best so far, or the last good one
  kFailed,        // no usable factor, or numbers not finite; the state is the last good one
};

struct StepReport {
  StepStatus status = StepStatus::kFailed;
  int iterations = 0;
  double residual = 0;  // N, largest nodal force out of balance at the last evaluation
  // The shape was one that the body can hardly have, and was given up for a better one: it jumps.
  bool restarted = false;
};

/// A factorisation that runs outside the loop. The model fills it with a snapshot; somebody calls
/// run() in any thread; the model takes the result with install().
class Refactorisation {
 public:
  virtual ~Refactorisation() = default;
  virtual void run() noexcept = 0;
};

/// The mechanics of the object: boundary and loads in, positions, reaction and sensitivity out.
/// Nodal vectors are 3 x n, in O. After prepare() nothing allocates or throws except run().
class DeformationModel {
 public:
  virtual ~DeformationModel() = default;

  virtual const Body& body() const noexcept = 0;

  /// Rest shape, zero velocity, no loads, no grasp held; factors for that state. Allocates.
  virtual void prepare() = 0;

  /// From the next step on the nodes of `grasp` follow X_OG * inverse(X_OG_rest).
  virtual void hold(int grasp, const math::Pose& X_OG) noexcept = 0;
  virtual void release(int grasp) noexcept = 0;
  virtual bool is_held(int grasp) const noexcept = 0;

  virtual void set_gravity(const Eigen::Vector3d& gravity_O) noexcept = 0;

  /// Nodal loads in N beside gravity; kept until overwritten. Those on constrained nodes enter the
  /// reaction only.
  virtual Eigen::Matrix3Xd& loads() noexcept = 0;

  /// Advances by dt seconds (dynamic) or re-establishes equilibrium (quasi-static).
  virtual StepReport step(double dt) noexcept = 0;

  /// Back to the rest shape, in place; loads and grasps are dropped.
  virtual void reset() noexcept = 0;

  virtual const Eigen::Matrix3Xd& positions() const noexcept = 0;
  virtual const Eigen::Matrix3Xd& velocities() const noexcept = 0;  // m/s; zero if quasi-static

  /// Wrench of the hand on the object at the origin of G, in O; zero where not held.
  virtual math::Wrench reaction(int grasp) const noexcept = 0;

  virtual const Sensitivity& sensitivity() const noexcept = 0;

  /// From the next factorisation on, the response to a force at `point` stands in slot `slot` of
  /// the sensitivity; a point with count 0 takes it out. Models without a sensitivity ignore it.
  virtual void watch_contact(int slot, const mesh::PointWeights& point) noexcept {
    static_cast<void>(slot), static_cast<void>(point);
  }

  /// A snapshot to be run elsewhere when the factor has grown old, else nullptr. Until install()
  /// has been called with it, no other is given.
  virtual Refactorisation* wanted_refactorisation() noexcept = 0;
  virtual void install(Refactorisation& done) noexcept = 0;

  /// Takes positions and velocities, e.g. of the model that this one replaces. False where sizes
  /// differ or a number is not finite.
  virtual bool restore(const Eigen::Matrix3Xd& positions,
                       const Eigen::Matrix3Xd& velocities) noexcept = 0;
};

}  // namespace palpate::elasticity
