#pragma once

#include <vector>

#include "core/estimation/estimator.hpp"
#include "core/estimation/step_watch.hpp"
#include "core/math/update_result.hpp"
#include "core/mesh/point_locator.hpp"
#include "core/mesh/surface.hpp"

namespace palpate::estimation {

/// Estimator driven by fingertip positions. A surface point touched by a finger follows the finger,
/// whose position comes from the kinematics and from the contact location on the skin; the measured
/// force only indicates contact. For compliant objects position is by far the better input: an
/// error of 10 mN moves the end of a soft bar by millimetres, an error of 0.1 mm in the finger
/// position by 0.1 mm.
///
/// Each contact is modelled as a bilateral spring between skin and material, because the sensor
/// already indicates contact. Coulomb friction: where the tangential force exceeds the limit, the
/// contact point slides to the current location of the finger on the surface. Forces are computed
/// by Newton steps, one per tick, with the compliance of the object at its contacts from the
/// model's sensitivity (kContactSlots contacts; a further contact uses the compliance block of
/// another one). A model without a sensitivity leads to status "degraded".
class FingertipDriven : public Estimator {
 public:
  struct Options {
    double skin_stiffness = 4e3;  // N/m, stiffness of a fingertip: 0.25 mm at 1 N
    double friction = 0.8;        // Coulomb friction coefficient
    /// m, lag of a sliding contact behind its finger at which the contact point is moved
    double slide = 1e-3;
    double patience = 0.1;  // s without a contact message until the contact has ended
    /// m/s, maximum speed of the material towards its finger, or away from a finger that has left
    double approach_speed = 0.2;
    StepWatch::Options step;
  };

  /// Throws std::invalid_argument if an option is not positive. Allocates.
  FingertipDriven(const elasticity::Body& body, const mesh::Surface& surface,
                  const Options& options);

  /// Releases every grasp, sets gravity and clears all contacts.
  void activate(elasticity::DeformationModel& model) noexcept override;

  /// Uses accepted contacts of fingers and ignores others. Degraded while a contact waits for the
  /// model's compliance.
  UpdateResult update(const EstimationInputs& inputs, elasticity::DeformationModel& model,
                      Estimate& estimate) noexcept override;
  void reset() noexcept override;

  /// Force of a finger on the object as computed by the model, N, in O; zero without contact.
  const Eigen::Vector3d& force(int finger) const noexcept { return touches_[finger].force; }

 private:
  static constexpr int kFingers = 5;
  using Matrix =
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 3 * kFingers, 3 * kFingers>;
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 3 * kFingers, 1>;

  struct Touch {
    bool touching = false;
    bool ready = false;  // the compliance of this contact is available
    bool sliding = false;
    bool leaving = false;  // the finger has left; the force decays
    int slot = -1;         // contact slot of the model's sensitivity
    int triangle = 0;
    mesh::PointWeights point;  // material point in contact
    /// m, position of the skin at the contact, in O
    Eigen::Vector3d place = Eigen::Vector3d::Zero();
    Eigen::Vector3d force = Eigen::Vector3d::Zero();  // N, force on the object
    double felt = 0;                                  // N, measured by the sensor
    double since = 0;                                 // s since the contact began
    double missing = 0;                               // s since the last contact message
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
  /// Midside nodes of each triangle, on the sides between corners 01, 12, 20.
  std::vector<std::array<int, 3>> midsides_;
  std::array<Touch, kFingers> touches_;
  std::array<int, kFingers> order_{};  // finger of each row of compliance_
  Matrix compliance_;
  StepGuard step_guard_;
  StepWatch step_watch_;
};

}  // namespace palpate::estimation
