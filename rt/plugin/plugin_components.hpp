#pragma once

#include "core/control/control_law.hpp"
#include "core/estimation/estimator.hpp"
#include "core/mesh/surface.hpp"

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

  // Of Jacobian providers and control laws:
  shape::Feature* feature = nullptr;  // of a provider, evaluated on the rest shape
  int moved_grasp = 0;                // the first one that moves
  int moved_grasps = 1;               // 2: the Jacobian has twelve columns
  bool commands_joints = false;       // velocities of joints, instead of the hand's twist
};

// The interfaces below correspond to those of the built-in components (see their headers), but may
// throw: the host catches exceptions, sets the component to fault and uses its fallback or the safe
// reaction. They run on the loop's thread, where only constructors, configure_for() and prepare()
// may allocate, lock, log, sleep, or routinely throw: HEALTH.allocations counts allocations, the
// latency of the phase reveals slow code, and a crash terminates the daemon. Constructors, these
// functions and the first calls before the loop starts (reset() of a sensor model, a provider and a
// law, evaluate() of a feature, and the steps of estimator and model) must return within 4 s.
// `reason` and `remark` are string literals. References to outputs are valid during the call only.

class PluginSensorModel {
 public:
  using Core = sensing::SensorModel;
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
  using Core = contact::ForceTransformer;
  virtual ~PluginForceTransformer() = default;
  virtual int max_nodes() const = 0;  // at least 1
  virtual void distribute(const sensing::Contact& contact, const Eigen::Matrix3Xd& positions,
                          contact::ContactLoads& out) = 0;
};

class PluginEstimator {
 public:
  using Core = estimation::Estimator;
  virtual ~PluginEstimator() = default;
  virtual void activate(elasticity::DeformationModel& model) = 0;
  virtual UpdateResult update(const estimation::EstimationInputs& inputs,
                              elasticity::DeformationModel& model,
                              estimation::Estimate& estimate) = 0;
  virtual void reset() {}
  virtual void take_over(const estimation::Estimate& last, elasticity::DeformationModel& model) {
    static_cast<void>(last);
    activate(model);
  }
};

/// The host keeps loads, grasps, positions and velocities. Matrices are 3 x n for the n nodes of
/// PluginCell::body, in O.
class PluginDeformationModel {
 public:
  using Core = elasticity::DeformationModel;
  using Nodes = Eigen::Ref<Eigen::Matrix3Xd>;
  virtual ~PluginDeformationModel() = default;
  /// Factors for the rest shape without grasps. May allocate.
  virtual void prepare() = 0;
  /// From the next step on the nodes of `grasp` follow X_OG * inverse(X_OG_rest).
  virtual void hold(int grasp, const math::Pose& X_OG) = 0;
  virtual void release(int grasp) = 0;
  virtual void set_gravity(const Eigen::Vector3d& gravity_O) = 0;
  /// `loads`: N, at the nodes. `positions`, m, and `velocities`, m/s: on entry those of the last
  /// step, of reset() or of the model that this one replaces.
  virtual elasticity::StepReport step(double dt, const Eigen::Matrix3Xd& loads, Nodes positions,
                                      Nodes velocities) = 0;
  /// Rest shape, without grasps.
  virtual void reset() = 0;
  virtual math::Wrench reaction(int grasp) const = 0;
  /// At the last step; nullptr: the model has none, and only providers that need none steer it.
  virtual const elasticity::Sensitivity* sensitivity() const { return nullptr; }
};

/// Kind, sizes, points and support must not change after construction.
class PluginFeature {
 public:
  using Core = shape::Feature;
  virtual ~PluginFeature() = default;
  virtual const char* kind() const = 0;  // a string literal of at most 31 characters
  virtual int dimension() const = 0;     // 1 to 32
  virtual int value_count() const = 0;   // dimension(), or more, up to 32
  virtual shape::Unit unit(int /*row*/) const { return shape::Unit::kMetre; }
  virtual const std::vector<Eigen::Vector3d>& rest_points() const = 0;
  virtual void evaluate(const Eigen::Matrix3Xd& positions, Eigen::Ref<Eigen::VectorXd> value) = 0;
  virtual bool is_defined() const { return true; }
  virtual void error(const Eigen::Ref<const Eigen::VectorXd>& value,
                     const Eigen::Ref<const Eigen::VectorXd>& target,
                     Eigen::Ref<Eigen::VectorXd> error) const = 0;
  virtual const std::vector<int>& support() const = 0;
  virtual const Eigen::SparseMatrix<double>& jacobian() const = 0;
  virtual bool is_valid_target(const double* target, int count) const = 0;
};

class PluginJacobianProvider {
 public:
  using Core = control::JacobianProvider;
  virtual ~PluginJacobianProvider() = default;
  virtual void observe(const control::Experience& /*now*/) {}
  virtual bool update(const shape::Feature& feature, const elasticity::DeformationModel& model,
                      const math::Pose& X_OG, Eigen::Ref<Eigen::MatrixXd> J) = 0;
  virtual bool commands(const control::LawInputs& /*inputs*/, math::Twist& /*V_O_G*/) {
    return false;
  }
  virtual void reset() {}
};

/// As control::LawOutput; everything is zero on entry.
struct PluginLawOutput {
  math::Twist V_O_G;
  math::Twist V_O_G_second;
  kinematics::SerialChain::Joints joint_velocity;
  Eigen::Map<Eigen::VectorXd> unreachable{nullptr, 0};  // length dimension() of the feature
  const char* remark = "";
};

class PluginControlLaw {
 public:
  using Core = control::ControlLaw;
  virtual ~PluginControlLaw() = default;
  virtual void configure_for(const shape::Feature& feature) = 0;
  virtual void compute(const control::LawInputs& inputs, PluginLawOutput& output) = 0;
  virtual void reset() {}
};

}  // namespace palpate::plugin
