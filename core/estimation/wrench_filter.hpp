#pragma once

#include <vector>

#include "core/collision/free_directions.hpp"
#include "core/math/rigid.hpp"

namespace palpate::estimation {

/// Kalman filter on the wrenches of one or two hands. States: for each grasp the offset from its
/// kinematic pose (m, rad, in G) and the bias of its wrench (N, N m, in G); the logarithm of
/// Young's modulus over its nominal value; the motion of obstacles in their free directions from
/// their configured poses (m, rad, in B; collision::free_directions); virtual loads on the object
/// (N, in O), which represent model errors, once the shape is observed; and one unmodelled external
/// force on the object (N, in O). All but the forces follow a stationary process about zero with
/// their prior deviation and forget information within `memory` seconds, so that the filter's
/// confidence is bounded by the stationarity of its environment. Reference: docs/theory.md,
/// section 4. Nothing allocates.
class WrenchFilter {
 public:
  struct Options {
    double position = 1e-3;  // m, prior standard deviation of each axis of a grasp's offset
    double rotation = 9e-3;  // rad; 0.5 degree
    double log_young = 0.5;  // 1; a factor of 1.65
    /// Prior of the wrench's bias: gravity compensation of a hand of 5 kg with a centre of mass at
    /// 0.2 m and a tilt error as above leaves a bias of this size, several times the drift of a
    /// sensor.
    double bias_force = 0.4;    // N
    double bias_torque = 0.08;  // N m
    double memory = 300;        // s
    double load_memory = 30;    // s, in which virtual loads drift by their prior deviation
    std::vector<collision::FreeDirection> obstacles;  // directions in which they may be displaced
  };
  static constexpr int kLoads = 6;
  static constexpr int kMostStates = 34 + collision::kMostFreeDirections;
  /// Maximum number of states that influence the shape.
  static constexpr int kMostShape = 19 + collision::kMostFreeDirections;
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

  /// Throws std::invalid_argument if `grasps` is not 1 or 2 or an option is not positive.
  WrenchFilter(int grasps, const Options& options);

  /// Returns to the prior, without an unknown force.
  void reset() noexcept;
  void predict(double dt) noexcept;

  /// Squared normalised innovation. `y`: measured minus predicted wrenches; `H`: their derivative
  /// with respect to the state; `R`: covariance of their noise. Chi-square distributed with
  /// y.size() degrees of freedom if the filter is consistent. Negative if the numbers are not
  /// finite. The state is unchanged until correct(), which uses the same y.
  double test(const Rows& H, const Wrenches& y, const Noise& R) noexcept;
  /// Corrects the state by the last test(). While an unknown force is estimated, only the force is
  /// corrected and the uncertainty of the other states is considered (Schmidt-Kalman filter),
  /// because the location of the force may be inaccurate.
  void correct() noexcept;

  /// Starts the estimation of the virtual loads, zero until then, with these prior deviations, N.
  /// They follow a random walk without a restoring term, so that no steady-state error of the shape
  /// remains (docs/theory.md, section 5: one integrating state for each corrected direction).
  void begin_loads(const math::Vector6d& deviation) noexcept;
  bool has_loads() const noexcept { return has_loads_; }

  /// Adds observations of the shape in information form on the leading states x: `matrix` is the
  /// sum of h h^T / s^2 over measurements z = h^T x + noise of standard deviation s, `vector` the
  /// sum of h z / s^2. An unknown force is considered but not corrected. False if the numbers are
  /// not finite.
  bool take(const ShapeMatrix& matrix, const ShapeState& vector) noexcept;

  /// Starts the estimation of an unknown force at `force_O` with `covariance` (N^2), which grows by
  /// a hundredth per second; or ends it.
  void begin_contact(const Eigen::Vector3d& force_O, const Eigen::Matrix3d& covariance) noexcept;
  void end_contact() noexcept;
  bool has_contact() const noexcept { return has_contact_; }

  /// Replaces mean and covariance of the states without forces by what is known of them from
  /// elsewhere: offsets of the grasps, logarithm of Young's modulus, motion of obstacles and
  /// biases, in the order of the states. Only without virtual loads and without an unknown force.
  void assume(const Vector& mean, const Covariance& covariance) noexcept;

  int grasp_count() const noexcept { return grasps_; }
  int size() const noexcept { return contact() + 3; }
  int offset(int grasp) const noexcept { return 6 * grasp; }  // index of the first state of a part
  int log_young() const noexcept { return 6 * grasps_; }
  int obstacle() const noexcept { return log_young() + 1; }
  int free_directions() const noexcept { return free_; }
  int load() const noexcept { return obstacle() + free_; }
  // the states that influence the shape come first
  int shape_size() const noexcept { return load() + kLoads; }
  int bias(int grasp) const noexcept { return shape_size() + 6 * grasp; }
  int contact() const noexcept { return shape_size() + 6 * grasps_; }

  const Vector& mean() const noexcept { return mean_; }
  const Covariance& covariance() const noexcept { return P_; }
  double deviation(int state) const noexcept;
  /// Whether the wrenches have provided information on a state: its variance is below four fifths
  /// of the prior's.
  bool is_observed(int state) const noexcept;

 private:
  int grasps_;
  int free_;  // directions of obstacles
  Options options_;
  Vector prior_;  // variances; those of the contact are separate
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
