#pragma once

#include "core/control/control_law.hpp"
#include "tools/lab/baselines/control/inverse_elements.hpp"

namespace palpate::baselines {

/// Plans computed by inverse finite elements before the motion and executed without observation of
/// the shape:
/// - by displacement: Duenser, Bern, Poranne and Coros, "Interactive robotic manipulation of
///   elastic objects", IROS 2018: row [50] of Table 2.2 in Sanchez 2019. Consumes: the model, the
///   pose of the hand. Kept: the pose of the hand for which an elastic model in equilibrium reaches
///   the target, by Gauss-Newton with sensitivity analysis. Left out: their neo-Hookean material
///   (here the co-rotational one), joints instead of poses, collision terms, a second arm.
/// - by force: Ficuciello, Migliozzi, Coevoet, Petit and Duriez, "FEM-based deformation control for
///   dexterous manipulation of 3D soft objects", IROS 2018: row [49]. Consumes: the model, the
///   force at the wrist. Kept: the actuator of the inverse problem is the contact force, here the
///   wrench of the hand, and the hand moves until it exerts this wrench. Left out: several fingers
///   with friction and bounds on each (one rigid grasp), their quadratic program (without bounds
///   its minimum is the equilibrium of the solution by displacement). An admittance with the
///   model's own stiffness converts the wrench error to a motion.
class OpenLoop final : public control::JacobianProvider {
 public:
  struct Options {
    bool by_force = false;
    double gain = 1;             // 1/s, gain on the remaining pose or wrench error
    double linear_speed = 0.08;  // m/s
    double angular_speed = 0.5;  // rad/s
    double filter = 0.2;         // s, time constant of the wrench filter
    /// m (rotations times 0.25 m), error at which the pose counts as reached
    double dead_band = 1e-4;
  };
  /// Throws std::invalid_argument if an option is out of range or the plan has no solution.
  OpenLoop(const Options& options, const InverseSolution& plan);

  void observe(const control::Experience& now) noexcept override;
  bool update(const shape::Feature&, const elasticity::DeformationModel&, const math::Pose&,
              Eigen::Ref<Eigen::MatrixXd>) noexcept override {
    return false;
  }
  bool commands(const control::LawInputs& inputs, math::Twist& V_O_G) noexcept override;
  void reset() noexcept override { felt_any_ = false; }

 private:
  Options options_;
  InverseSolution plan_;
  math::Matrix6d compliance_ = math::Matrix6d::Zero();
  math::Vector6d felt_ = math::Vector6d::Zero();
  bool felt_any_ = false;
  math::Pose X_OG_ = math::Pose::Identity();
};

}  // namespace palpate::baselines
