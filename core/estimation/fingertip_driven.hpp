#pragma once

#include <vector>

#include "core/estimation/estimator.hpp"
#include "core/estimation/step_watch.hpp"
#include "core/mesh/point_locator.hpp"
#include "core/mesh/surface.hpp"

namespace palpate::estimation {

/// Where the fingertips are drives the mesh: a point of the surface that a finger has touched stays
/// where the finger holds it, by the robot's kinematics and the place of the touch on the skin; the
/// force felt only says that there is a touch. For a compliant object that is by far the better end
/// (10 mN of force error move the end of a soft bar by millimetres, 0.1 mm of a finger by 0.1 mm).
///
/// Each touch is a spring from the skin to the material, to both sides, since the sensor says that
/// there is a touch. Friction after Coulomb: what it cannot bear lets the touch slide to the place
/// on the surface where the finger is now. Forces are found by Newton steps, one a tick, with the
/// compliance of the object at its touches from the model's sensitivity (kContactSlots of them; a
/// further touch borrows its own block from the others). Models without a sensitivity are refused
/// by degraded status.
class FingertipDriven : public Estimator {
 public:
  struct Options {
    double skin_stiffness = 4e3;  // N/m, of a fingertip: 0.25 mm at 1 N
    double friction = 0.8;        // Coulomb
    double slide = 1e-3;          // m that a sliding touch lags behind before it is moved
    double patience = 0.1;        // s without a contact until the touch is over
    double approach_speed = 0.2;  // m/s, at most, of material towards its finger, or away from
                                  // where one has left
    StepWatch::Options step;
  };

  /// Throws std::invalid_argument where an option is not positive. Allocates.
  FingertipDriven(const elasticity::Body& body, const mesh::Surface& surface,
                  const Options& options);

  /// Releases every grasp, sets gravity, forgets every touch.
  void activate(elasticity::DeformationModel& model) noexcept override;

  /// Takes accepted contacts of fingers; others are passed over. Degraded while a touch waits for
  /// the model's compliance.
  sensing::UpdateResult update(const EstimationInputs& inputs, elasticity::DeformationModel& model,
                               Estimate& estimate) noexcept override;
  void reset() noexcept override;

  /// Force of a finger on the object as the model needs it, N, in O; zero where it does not touch.
  const Eigen::Vector3d& force(int finger) const noexcept { return touches_[finger].force; }

 private:
  static constexpr int kFingers = 5;
  using Matrix =
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 3 * kFingers, 3 * kFingers>;
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 3 * kFingers, 1>;

  struct Touch {
    bool touching = false;
    bool ready = false;  // its compliance is there
    bool sliding = false;
    bool leaving = false;  // the finger is gone, its force goes
    int slot = -1;         // of the model's sensitivity
    int triangle = 0;
    mesh::PointWeights point;                         // material that is touched
    Eigen::Vector3d place = Eigen::Vector3d::Zero();  // m, of the skin there, in O
    Eigen::Vector3d force = Eigen::Vector3d::Zero();  // N, on the object
    double felt = 0;                                  // N, by the sensor
    double since = 0;                                 // s, that it touches
    double missing = 0;                               // s since the last contact
  };

  void gather(const EstimationInputs& inputs, double dt,
              elasticity::DeformationModel& model) noexcept;
  void touch(Touch& touch, elasticity::DeformationModel& model) noexcept;
  void let_go(Touch& touch, double dt, elasticity::DeformationModel& model) noexcept;
  void end(Touch& touch, elasticity::DeformationModel& model) noexcept;
  int free_slot() const noexcept;
  bool has_compliance(const Touch& touch, const elasticity::Sensitivity& known) const noexcept;
  int gather_compliance(const elasticity::DeformationModel& model) noexcept;
  void follow(double dt, elasticity::DeformationModel& model) noexcept;
  Vector solve(const Vector& gap) noexcept;
  Eigen::Vector3d gap_of(const Touch& touch, const Eigen::Matrix3Xd& positions) const noexcept;
  Eigen::Vector3d normal(const Touch& touch, const Eigen::Matrix3Xd& positions) const noexcept;

  Options options_;
  Eigen::Matrix3Xi triangles_;
  std::vector<std::array<int, 3>> midsides_;  // of each triangle, between its corners 01, 12, 20
  std::array<Touch, kFingers> touches_;
  std::array<int, kFingers> order_{};  // fingers of the rows of compliance_
  Matrix compliance_;
  StepGuard step_guard_;
  StepWatch step_watch_;
};

}  // namespace palpate::estimation
