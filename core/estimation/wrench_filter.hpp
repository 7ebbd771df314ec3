#pragma once

#include "core/math/rigid.hpp"

namespace palpate::estimation {

/// What a Kalman filter on the wrenches of one or two hands knows: for each grasp its offset from
/// where the kinematics say it is (m, rad, in G) and the bias of its wrench (N, N m, in G); the
/// logarithm of Young's modulus over its nominal value; virtual loads on the object (N, in O),
/// which stand for what the model does not know of its shape, once the shape is seen; and one force
/// on the object that no sensor tells of (N, in O). All but the forces wander about zero within
/// their prior deviations and forget what was learnt in `memory` seconds, so that the filter never
/// becomes surer than its world is steady. Reference: control.md 6.4. Nothing allocates.
class WrenchFilter {
 public:
  struct Options {
    double position = 1e-3;  // m, prior deviation of each axis of a grasp's offset
    double rotation = 9e-3;  // rad; 0.5 degree
    double log_young = 0.5;  // 1; a factor of 1.65
    /// Of a wrench's bias: a hand of 5 kg at 0.2 m whose tilt is told as wrongly as above is
    /// compensated by so much too much, which is several times what a sensor drifts by.
    double bias_force = 0.4;    // N
    double bias_torque = 0.08;  // N m
    double memory = 300;        // s
    double load_memory = 30;    // s, in which virtual loads wander by their prior deviation
  };
  static constexpr int kLoads = 6;
  static constexpr int kMostStates = 34;
  static constexpr int kMostShape = 19;  // of them, that the shape follows
  static constexpr int kMostRows = 12;
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostStates, 1>;
  using Covariance =
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMostStates, kMostStates>;
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMostRows, kMostStates>;
  using Wrenches = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostRows, 1>;
  using Noise = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMostRows, kMostRows>;

  using ShapeState = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostShape, 1>;
  using ShapeMatrix =
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMostShape, kMostShape>;

  /// Throws std::invalid_argument where `grasps` is not 1 or 2 or an option not positive.
  WrenchFilter(int grasps, const Options& options);

  /// Back to the prior, no unknown force.
  void reset() noexcept;
  void predict(double dt) noexcept;

  /// Normalised square of the innovation `y` = measured less predicted wrenches, whose change by
  /// the state is H and whose noise has the covariance R: chi-squared of y.size() degrees of
  /// freedom where the filter is right. Below zero where the numbers are not finite. Nothing is
  /// learnt until correct(), which takes the same y.
  double test(const Rows& H, const Wrenches& y, const Noise& R) noexcept;
  /// While there is an unknown force only that is learnt, and what else is uncertain is borne in
  /// mind (Schmidt's filter): the force may not be quite where it is taken to be.
  void correct() noexcept;

  /// Until then virtual loads are zero; from now on they are estimated, with these prior
  /// deviations, N. They wander without coming back, so that no steady error of the shape remains
  /// (control.md 6.5: an integrating state for each direction that is corrected).
  void begin_loads(const math::Vector6d& deviation) noexcept;
  bool has_loads() const noexcept { return has_loads_; }

  /// Takes what was seen of the shape as information on its leading states x: `matrix` is the sum
  /// of h h^T / s^2 over measurements z = h^T x + noise of deviation s, `vector` that of h z / s^2.
  /// An unknown force is borne in mind but not learnt. False where the numbers are not finite.
  bool take(const ShapeMatrix& matrix, const ShapeState& vector) noexcept;

  /// From now on an unknown force is estimated, at first `force_O`, which may be wrong by
  /// `covariance` (N^2) now, and by a hundredth of it more each second; or no more.
  void begin_contact(const Eigen::Vector3d& force_O, const Eigen::Matrix3d& covariance) noexcept;
  void end_contact() noexcept;
  bool has_contact() const noexcept { return has_contact_; }

  int grasp_count() const noexcept { return grasps_; }
  int size() const noexcept { return contact() + 3; }
  int offset(int grasp) const noexcept { return 6 * grasp; }  // where a part begins
  int log_young() const noexcept { return 6 * grasps_; }
  int load() const noexcept { return log_young() + 1; }
  int shape_size() const noexcept { return load() + kLoads; }  // what the shape follows comes first
  int bias(int grasp) const noexcept { return shape_size() + 6 * grasp; }
  int contact() const noexcept { return shape_size() + 6 * grasps_; }

  const Vector& mean() const noexcept { return mean_; }
  const Covariance& covariance() const noexcept { return P_; }
  double deviation(int state) const noexcept;
  /// Whether the wrenches have told of a state: its variance is below four fifths of the prior's.
  bool is_observed(int state) const noexcept;

 private:
  int grasps_;
  Options options_;
  Vector prior_;  // variances; those of the contact apart
  Vector mean_;
  Covariance P_;
  bool has_loads_ = false;
  bool has_contact_ = false;
  Eigen::Matrix3d contact_prior_ = Eigen::Matrix3d::Zero();
  Rows H_;
  Wrenches y_;
  Noise R_, S_;
};

}  // namespace palpate::estimation
