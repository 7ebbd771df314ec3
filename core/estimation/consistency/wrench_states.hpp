#pragma once

#include "core/estimation/wrench_innovation.hpp"

namespace palpate::estimation {

/// States on which the predicted wrenches of one or two hands depend: for each hand the offset of
/// its grasp (m, rad, in G) and the bias of its sensor (N, N m, in G); the logarithm of Young's
/// modulus over its nominal value, the error of Poisson's ratio, the logarithm of the density over
/// its nominal value; for each hand an error of the predicted wrench that varies with its pose (N,
/// N m, in O). Causes of a discrepancy may append states of their own.
struct WrenchStates {
  static constexpr int kMostAppended = 12;
  static constexpr int kMost = 39 + kMostAppended;

  int grasps = 1;

  int offset(int grasp) const noexcept { return 6 * grasp; }
  int bias(int grasp) const noexcept { return 6 * grasps + 6 * grasp; }
  int material() const noexcept { return 12 * grasps; }
  int error(int grasp) const noexcept { return material() + 3 + 6 * grasp; }
  int count() const noexcept { return error(grasps); }  // without appended states
};

/// s, correlation time of the errors of a moving hand: records within it carry the information of
/// one.
inline constexpr double kMotionErrors = 0.3;

/// Mean differences between measured and predicted wrenches of one hand over a short time.
struct HandRecord {
  using Rows = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, WrenchStates::kMost>;

  bool valid = false;
  Rows H;                // dependence on WrenchStates
  math::Vector6d y;      // N, N m, at G in O: measured minus predicted for the nominal parameters
  math::Matrix6d R;      // covariance of the noise of y
  math::Vector6d error;  // N, N m, standard deviation of the error that varies with the pose
  double travel = 0;     // motion of the hand until now, in distances that decorrelate this error
};
using WrenchRecord = std::array<HandRecord, 2>;

/// Mean and covariance of WrenchStates and appended states.
class WrenchKnowledge {
 public:
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, WrenchStates::kMost, 1>;
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, WrenchStates::kMost,
                               WrenchStates::kMost>;
  /// A measured wrench compared with the knowledge.
  struct Comparison {
    bool valid = false;
    math::Vector6d difference;  // N, N m
    math::Matrix6d S;           // its covariance
    HandRecord::Rows HP;        // covariance with the states
    double squared = 0;         // normalised square of the difference
    double log_likelihood = 0;  // of the wrench
  };

  /// Zero means with these deviations; no knowledge of the errors that vary with the pose.
  WrenchKnowledge(WrenchStates states, const Vector& deviations);

  /// Adds states of mean zero and this covariance.
  void append(const Matrix& covariance) noexcept;
  /// The errors that vary with the pose decorrelate by the motion of the hands until `record`.
  void advance(const WrenchRecord& record) noexcept;
  /// `H`: rows of all states; `y`, `R`: as in HandRecord.
  Comparison compare(const HandRecord::Rows& H, const math::Vector6d& y,
                     const math::Matrix6d& R) const noexcept;
  void correct(const Comparison& comparison) noexcept;
  /// Adds to the variance of appended states from `first` on, in their order.
  void diffuse(int first, const Matrix& covariance) noexcept;
  /// Without appended states, of which the first six are added to those from `into` on.
  WrenchKnowledge folded(int into) const noexcept;

  const WrenchStates& states() const noexcept { return states_; }
  const Vector& mean() const noexcept { return mean_; }
  const Matrix& covariance() const noexcept { return covariance_; }

 private:
  WrenchStates states_;
  Vector mean_;
  Matrix covariance_;
  std::array<double, 2> travel_;
};

}  // namespace palpate::estimation
