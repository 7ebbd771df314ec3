#pragma once

#include <filesystem>
#include <memory>

#include "core/mesh/point_locator.hpp"
#include "tools/fit/experiment.hpp"
#include "tools/fit/held/held_cell.hpp"
#include "tools/fit/held/held_equilibrium.hpp"
#include "tools/fit/held/held_log.hpp"

namespace palpate::fit {

/// Parameters to identify in addition to Young's modulus, which is always identified. Otherwise
/// Poisson's ratio and density are known: as configured.
struct HeldSought {
  bool poisson_ratio = true;
  bool density = false;
  bool grasp = false;  // six: the hand's pose in its measured frame G, m and rotation vector, rad
  bool bias = true;    // six: bias of the sensor, N and N m in S
  bool hand = false;   // four: mass of the hand, kg, and mass times its centre in S, kg m
  bool pads = false;   // stiffness of the hand's pads together, N/m; else as configured
};

/// N/m, of pads together: start of a fit where the configuration has rigid ones.
inline constexpr double kPadStiffness = 1e5;

struct HeldOptions {
  HeldSought sought;
  std::vector<Eigen::Vector3d> markers;  // rest points, O, in the order of observation
  int points = 60;                       // of a cloud, spread over it; the others are not used
  /// Relative to the largest force and torque between hand and object, at the start: model error,
  /// independent of the sensor. Counts as noise.
  double model_error = 0.01;
  std::vector<bool> is_held_out;  // by sample; empty: none
};

/// An object in a hand that moves it and rests: at each rest the co-rotational statics of the
/// daemon's own mesh (quadratic or linear elements, exact tangent) under the pose of the hand
/// predict the wrist reading,
///    F_S = [R_SO f, R_SO tau + p_SG x R_SO f] + weight of the hand + bias,
/// with (f, tau) of the hand on the object at the origin of G, and the positions of markers, or the
/// distance of an observed point from the surface (positive outside, measured as 0). Pads yield as
/// palpated's do, and with them what the mesh lacks next to them (HeldEquilibrium). The Jacobian is
/// that of StaticResponse (control.md 6.2), chained to the grasp's offset and the pads; own
/// parameters have the recording's name as prefix, "NAME.bias_fx".
class HeldObject final : public Experiment {
 public:
  /// Follows the hand from rest to each sample; the resulting shapes are the starts of all
  /// predictions. Throws std::invalid_argument if a sample has no equilibrium, or points other than
  /// markers are named.
  HeldObject(std::string name, HeldCell cell, HeldRecording recording, HeldOptions options = {});

  bool predict(const Eigen::VectorXd& parameters, Eigen::VectorXd& prediction,
               Eigen::MatrixXd* jacobian) const override;

  /// Principal strains (stretch - 1) of the elements' corners over the samples, at the start.
  std::array<double, 2> strain_range() const override;

 private:
  struct State;
  void list_parameters();
  void list_series();
  State state(const Eigen::VectorXd& parameters) const;
  math::Pose grasp(const State& state, const math::Pose& X_WE) const;
  void follow_hand();
  HeldEquilibrium::Changes changes(const State& state, const math::Pose& X_WE,
                                   double stiffness) const;
  void predict_wrench(const State& state, int sample, const HeldEquilibrium& found,
                      Eigen::VectorXd& prediction, Eigen::MatrixXd* jacobian) const;
  void predict_markers(int sample, const HeldEquilibrium& found, Eigen::VectorXd& prediction,
                       Eigen::MatrixXd* jacobian) const;
  void predict_cloud(int sample, const HeldEquilibrium& found, Eigen::VectorXd& prediction,
                     Eigen::MatrixXd* jacobian) const;
  static constexpr int kMaterial = 3;  // first columns, in the order of Sensitivity::Parameter
  int samples() const { return static_cast<int>(recording_.samples.size()); }

  HeldCell cell_;
  HeldRecording recording_;
  HeldOptions options_;
  /// First columns, -1: not identified.
  int grasp_ = -1, bias_ = -1, mass_ = -1, pads_ = -1;
  math::Matrix6d soft_pads_ = math::Matrix6d::Zero();  // compliance of pads of 1 N/m
  std::vector<mesh::PointWeights> markers_;
  std::vector<Eigen::Matrix3Xd> seen_;  // by sample, in O
  std::vector<int> first_row_;          // from a sample's points
  // By sample, start of Newton's method.
  std::vector<Eigen::Matrix3Xd> shapes_;
  std::vector<math::Vector6d> yields_;  // of the pads
};

/// Kind `held_object`: a grasp-and-move recording from an LCM log. Keys: log (below the folder of
/// the data), configuration (of palpated, which describes the object; relative to this file), set
/// (overrides of it), time (received, sent), calm (linear_speed, angular_speed, settle, window,
/// every: see CalmRule), sought (list of poisson_ratio, density, grasp, bias, hand, pads; absent:
/// poisson_ratio, bias), model_error (0.01), markers (rest points), points (of a cloud, 60),
/// held_out (by `time` or `sample`). A few rests are not enough to estimate the noise: with them
/// fit by `solver: {reweigh: false}`. Throws config::Error and std::runtime_error.
std::unique_ptr<Experiment> make_held_object(const config::Node& node,
                                             const std::filesystem::path& folder);

}  // namespace palpate::fit
