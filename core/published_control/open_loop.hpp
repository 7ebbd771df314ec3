#pragma once

#include "core/control/control_law.hpp"
#include "core/published_control/inverse_elements.hpp"

namespace palpate::published_control {

/// Plans found by inverse finite elements before the hand moves, and then carried out without a
/// look at the shape:
/// - by displacement: Duenser, Bern, Poranne and Coros, "Interactive robotic manipulation of
/// elastic
///   objects", IROS 2018: row [50]. Consumes: the model, the hand's pose. Kept: the hand's pose is
///   what an elastic model in equilibrium, differentiated by sensitivity analysis, brings to the
///   target by Gauss-Newton. Left out: their Neo-Hookean material (the model here is palpate's
///   co-rotated one), joints in place of poses, terms against contact, a second arm.
/// - by force: Ficuciello, Migliozzi, Coevoet, Petit and Duriez, "FEM-based deformation control for
///   dexterous manipulation of 3D soft objects", IROS 2018: row [49]. Consumes: the model, the
///   wrist's force. Kept: the actuator of the inverse problem is the force of the contacts, here
///   the hand's wrench, and the hand is moved until it exerts that. Left out: several fingers with
///   friction and bounds on each (one rigid grasp), their quadratic program (without bounds its
///   minimum is the equilibrium of the solution by displacement). An admittance with the model's
///   own stiffness turns what the wrench misses into a motion.
class OpenLoop final : public control::JacobianProvider {
 public:
  struct Options {
    bool by_force = false;
    double gain = 1;             // 1/s, of what is left of the pose or the wrench
    double linear_speed = 0.08;  // m/s
    double angular_speed = 0.5;  // rad/s
    double filter = 0.2;         // s, of the wrench
    double dead_band = 1e-4;     // m (rotations times 0.25 m), where the pose counts as reached
  };
  /// Throws std::invalid_argument where an option is out of range or the plan has no solution.
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

}  // namespace palpate::published_control
