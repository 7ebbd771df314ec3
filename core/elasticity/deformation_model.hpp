#pragma once

#include <memory>
#include <vector>

#include "core/collision/obstacle.hpp"
#include "core/elasticity/body.hpp"
#include "core/elasticity/contact/surface_contact.hpp"
#include "core/elasticity/sensitivity.hpp"
#include "core/mesh/point_locator.hpp"

namespace palpate::elasticity {

enum class StepStatus {
  kConverged,     // within tolerance or accuracy
  kNotConverged,  // iteration limit reached; the state is the best so far, or the last valid one
  kFailed,        // no usable factor, or non-finite numbers; the state is the last valid one
};

struct StepReport {
  StepStatus status = StepStatus::kFailed;
  int iterations = 0;
  double residual = 0;  // N, largest unbalanced nodal force at the last evaluation
  // The shape was not physical and was replaced by a better one: it is discontinuous.
  bool restarted = false;
};

/// Factorisation that runs outside the loop. The model fills it with a snapshot; any thread calls
/// run(); the model takes the result with install().
class Refactorisation {
 public:
  virtual ~Refactorisation() = default;
  virtual void run() noexcept = 0;
};

/// Mechanical model of the object: boundary conditions and loads in; positions, reaction and
/// sensitivity out. Nodal vectors are 3 x n, in O. After prepare() only run() allocates or throws.
class DeformationModel {
 public:
  virtual ~DeformationModel() = default;

  virtual const Body& body() const noexcept = 0;

  /// Sets the rest shape, zero velocity, no loads and no held grasp, and factors for that state.
  /// Allocates.
  virtual void prepare() = 0;

  /// From the next step on the nodes of `grasp` follow X_OG * inverse(X_OG_rest).
  virtual void hold(int grasp, const math::Pose& X_OG) noexcept = 0;
  virtual void release(int grasp) noexcept = 0;
  virtual bool is_held(int grasp) const noexcept = 0;

  virtual void set_gravity(const Eigen::Vector3d& gravity_O) noexcept = 0;

  /// Nodal loads, N, in addition to gravity; kept until overwritten. Loads on constrained nodes
  /// affect the reaction only.
  virtual Eigen::Matrix3Xd& loads() noexcept = 0;

  /// Advances by dt seconds (dynamic) or computes the new equilibrium (quasi-static).
  virtual StepReport step(double dt) noexcept = 0;

  /// Returns to the rest shape without allocation; loads and grasps are removed.
  virtual void reset() noexcept = 0;

  virtual const Eigen::Matrix3Xd& positions() const noexcept = 0;
  virtual const Eigen::Matrix3Xd& velocities() const noexcept = 0;  // m/s; zero if quasi-static

  /// Wrench of the hand on the object at the origin of G, in O; zero if not held.
  virtual math::Wrench reaction(int grasp) const noexcept = 0;

  virtual const Sensitivity& sensitivity() const noexcept = 0;

  /// From the next factorisation on, slot `slot` of the sensitivity contains the response to a
  /// force at `point`; a point with count 0 clears it. Models without a sensitivity ignore it.
  virtual void watch_contact(int slot, const mesh::PointWeights& point) noexcept {
    static_cast<void>(slot), static_cast<void>(point);
  }

  /// Snapshot to be factored elsewhere if the factor is outdated, else nullptr. No further one is
  /// provided until install() has been called with it.
  virtual Refactorisation* wanted_refactorisation() noexcept = 0;
  virtual void install(Refactorisation& done) noexcept = 0;

  /// Sets positions and velocities, e.g. those of the model replaced by this one. False if sizes
  /// differ or a number is not finite.
  virtual bool restore(const Eigen::Matrix3Xd& positions,
                       const Eigen::Matrix3Xd& velocities) noexcept = 0;

  /// From the next step on obstacle `index` of the configuration is there. Models without contact
  /// ignore it.
  virtual void place_obstacle(int index, const collision::Placement& placement) noexcept {
    static_cast<void>(index), static_cast<void>(placement);
  }
  /// Points of the surface on or near obstacles, after the last step; none without contact.
  virtual const std::vector<SurfaceContact>& contacts() const noexcept { return kNoContacts; }
};

}  // namespace palpate::elasticity
