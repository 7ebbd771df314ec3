#pragma once

#include "core/estimation/wrench_innovation.hpp"

namespace palpate::estimation {

/// States on which the predicted wrenches of one or two hands depend: for each hand the offset of
/// its grasp (m, rad, in G) and the bias of its sensor (N, N m, in G); the logarithm of Young's
/// modulus over its nominal value, the error of Poisson's ratio, the logarithm of the density over
/// its nominal value; for each hand the relative errors of the elastic part of each component of
/// its wrench (stiffness that differs between tension, bending and torsion, in O), and two errors
/// that vary with its pose: of the grasp (m, rad, in G), and of the predicted wrench relative to
/// its size (in O); the motion of obstacles in their free directions (m, rad, in B). Causes of a
/// discrepancy may append states of their own.
struct WrenchStates {
  static constexpr int kMostAppended = 15;
  static constexpr int kMost = 63 + collision::kMostFreeDirections + kMostAppended;

  int grasps = 1;
  int free_directions = 0;  // of obstacles

  int offset(int grasp) const noexcept { return 6 * grasp; }
  int bias(int grasp) const noexcept { return 6 * grasps + 6 * grasp; }
  int log_young() const noexcept { return 12 * grasps; }
  int stiffness(int grasp) const noexcept { return log_young() + 3 + 6 * grasp; }
  int pose_error(int grasp) const noexcept { return stiffness(grasps) + 6 * grasp; }
  int wrench_error(int grasp) const noexcept { return pose_error(grasps) + 6 * grasp; }
  int obstacle() const noexcept { return wrench_error(grasps); }
  int count() const noexcept { return obstacle() + free_directions; }  // without appended states
};

/// s, correlation time of the errors of a moving hand: records within it carry the information of
/// one.
inline constexpr double kMotionErrors = 0.3;

/// Mean differences between measured and predicted wrenches of one hand over a short time.
struct HandRecord {
  using Rows = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, WrenchStates::kMost>;

  bool valid = false;
  int grasp = 0;
  /// Dependence on offsets, biases, material, errors of the pose and obstacles, for the nominal
  /// parameters; other columns are zero.
  Rows H;
  math::Vector6d y;     // N, N m, at G in O: measured minus predicted for the nominal parameters
  math::Matrix6d R;     // covariance of the noise of y
  math::Vector6d size;  // N, N m, size of the predicted force and torque, by component
  double travel = 0;    // motion of the hand until now, in distances that decorrelate the errors
  double time = 0;      // s, until now
};
using WrenchRecord = std::array<HandRecord, 2>;

/// Mean and covariance of WrenchStates and appended states: an extended Kalman filter. The elastic
/// part of a wrench is proportional to E, also where offsets of the grasps or obstacles cause it.
class WrenchKnowledge {
 public:
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, WrenchStates::kMost, 1>;
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, WrenchStates::kMost,
                               WrenchStates::kMost>;
  /// Dependence of a hand's wrench on appended states.
  using Appended = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, WrenchStates::kMostAppended>;
  /// A measured wrench compared with the knowledge.
  struct Comparison {
    bool valid = false;
    math::Vector6d difference;  // N, N m
    math::Matrix6d S;           // its covariance
    HandRecord::Rows HP;        // covariance with the states
    double squared = 0;         // normalised square of the difference
    double log_likelihood = 0;  // of the wrench
  };

  /// Zero means with these deviations, which are also those of the stationary processes that the
  /// states follow. `memory`: s, their correlation time; errors that vary with the pose decorrelate
  /// with motion instead.
  WrenchKnowledge(WrenchStates states, const Vector& deviations, double memory);

  /// Adds states of mean zero and this covariance.
  void append(const Matrix& covariance) noexcept;
  /// The states change with the time and the motion of the hands until `record`.
  void advance(const WrenchRecord& record) noexcept;
  /// `R`: covariance of the noise of the wrench, at least that of the record.
  Comparison compare(const HandRecord& hand, const Appended& appended,
                     const math::Matrix6d& R) const noexcept;
  Comparison compare(const HandRecord& hand) const noexcept {
    return compare(hand, Appended::Zero(6, 0), hand.R);
  }
  /// Corrects the states by a wrench; the dependence on them is evaluated at the corrected ones.
  void correct(const HandRecord& hand, const Appended& appended, const math::Matrix6d& R) noexcept;
  /// Adds to the variance of appended states from `first` on, in their order.
  void diffuse(int first, const Matrix& covariance) noexcept;
  /// Without appended states, of which the first six are added to those from `into` on.
  WrenchKnowledge folded(int into) const noexcept;
  /// Replaces what is known of states from `first` on by independent ones.
  void assume(int first, const Vector& mean, const Vector& deviations) noexcept;
  /// Forgets what is known of six states from `first` on.
  void forget(int first) noexcept;
  /// What is known of the states that a WrenchFilter has too, in its order: the offsets with their
  /// present errors, log E, the obstacles, the biases.
  void write(Vector& mean, Matrix& covariance) const noexcept;
  /// N, N m, size of a hand's force and torque under the object alone, by component, from the
  /// predicted wrench for the nominal parameters, the means and the deviations of the grasps.
  /// `lever`: m, of the error of a force.
  math::Vector6d size_of_wrench(const HandRecord& hand, const math::Vector6d& nominal,
                                double lever) const noexcept;

  const WrenchStates& states() const noexcept { return states_; }
  const Vector& mean() const noexcept { return mean_; }
  const Matrix& covariance() const noexcept { return covariance_; }

 private:
  struct Linearised {
    HandRecord::Rows H;
    math::Vector6d predicted;  // N, N m, relative to the prediction for the nominal parameters
  };
  math::Vector6d by_displacements(const HandRecord& hand, const Vector& mean) const noexcept;
  Linearised linearise(const HandRecord& hand, const Appended& appended,
                       const Vector& mean) const noexcept;

  WrenchStates states_;
  Vector mean_;
  Matrix covariance_;
  Vector stationary_;  // variances
  double memory_;
  std::array<double, 2> travel_{};
  double time_ = 0;
};

}  // namespace palpate::estimation
