#pragma once

#include "core/contact/force_transformer.hpp"
#include "core/control/control_law.hpp"
#include "core/mesh/surface.hpp"
#include "core/sensing/sensor_model.hpp"

namespace palpate::plugin {

/// Information on the workcell for the construction of a plug-in's component. Pointees outlive the
/// component.
struct PluginCell {
  double period = 1e-3;        // s, of the loop
  bool deterministic = false;  // results must not depend on threads or wall clocks
  /// Arm of a sensor model: 0, or 1 for the second arm, whose frames follow.
  int arm = 0;
  int finger = 0;                            // finger of a sensor model: 0 to 4
  math::Pose X_WO = math::Pose::Identity();  // object's rest frame in the robot base
  math::Pose X_ES = math::Pose::Identity();  // pose of the force-torque sensor in the flange
  math::Pose X_EI = math::Pose::Identity();  // pose of the IMU in the flange
  math::Pose X_EG = math::Pose::Identity();  // pose of the grasp in the flange
  Eigen::Vector3d gravity_W{0, 0, -9.81};    // m/s^2
  const elasticity::Body* body = nullptr;    // the daemon's model of the object
  const mesh::Surface* surface = nullptr;    // its surface
};

// The interfaces below correspond to those of the built-in components (see their headers), but may
// throw: the host catches exceptions, sets the component to fault and uses its fallback or the safe
// reaction. They run on the loop's thread, where only constructors and configure_for() may
// allocate, lock, log, sleep, or routinely throw: HEALTH.allocations counts allocations, the
// latency of the phase reveals slow code, and a crash terminates the daemon. `reason` and `remark`
// are string literals.

class PluginSensorModel {
 public:
  virtual ~PluginSensorModel() = default;
  virtual UpdateResult update(const sensing::Signals& signals, sensing::ContactSet& contacts) = 0;
  virtual void zero() {}
  virtual void reset() {}
  virtual sensing::SensorState save() const { return {}; }
  virtual bool restore(const sensing::SensorState& state) {
    return state.meaning == sensing::SensorState::Offset::kUnknown;
  }
};

class PluginForceTransformer {
 public:
  virtual ~PluginForceTransformer() = default;
  virtual int max_nodes() const = 0;  // at least 1
  virtual void distribute(const sensing::Contact& contact, const Eigen::Matrix3Xd& positions,
                          contact::ContactLoads& out) = 0;
};

class PluginJacobianProvider {
 public:
  virtual ~PluginJacobianProvider() = default;
  virtual bool update(const shape::Feature& feature, const elasticity::DeformationModel& model,
                      const math::Pose& X_OG, Eigen::Ref<Eigen::MatrixXd> J) = 0;
};

class PluginControlLaw {
 public:
  virtual ~PluginControlLaw() = default;
  virtual void configure_for(const shape::Feature& feature) = 0;
  /// `output` is zero on entry; the length of `unreachable` must not change.
  virtual void compute(const control::LawInputs& inputs, control::LawOutput& output) = 0;
  virtual void reset() {}
};

}  // namespace palpate::plugin
