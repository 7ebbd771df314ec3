#pragma once

#include <filesystem>
#include <memory>

#include "tools/fit/experiment.hpp"
#include "tools/fit/held/held_cell.hpp"
#include "tools/fit/held/held_log.hpp"
#include "tools/fit/held/held_modes.hpp"

namespace palpate::fit {

/// Wrist readings after the hand has come to rest, while the object still vibrates.
struct HeldRinging {
  double time = 0;  // s, time of the stop since the start of the recording
  math::Pose X_WE = math::Pose::Identity();
  Eigen::VectorXd times;                              // s since the stop
  Eigen::Matrix<double, 6, Eigen::Dynamic> readings;  // F_S, as the sensor reports it
  math::Vector6d deviation = math::Vector6d::Ones();  // standard, of one column
};

struct HeldDecayOptions {
  int modes = 4;  // number of vibrating modes
  bool density = false;
  bool mass_damping = true;
  bool stiffness_damping =
      false;  // identifiable with the other only from modes of different frequencies
};

/// Free decay of an object in a hand that has stopped. Linear vibrations about the equilibrium
/// under the hand's pose, by the lowest modes of the daemon's own elements and consistent mass,
/// whose superposition with Rayleigh damping is the exact solution in time: the contribution of
/// mode i is
///    P_i exp(-d t) (a cos(w t) + b sin(w t)),
///    omega^2 = omega_i^2 E rho_i / E_i rho, 2 d = mass_damping + stiffness_damping omega^2,
///    w^2 = omega^2 - d^2,
/// with the pattern P_i of its wrench on the hand. Shape and modes are those at the configuration's
/// material. Parameters: young_modulus; density, mass_damping (1/s) and stiffness_damping (s),
/// known unless listed in `sought`; for each stop NAME.stop1_mode1_cos and _sin (in units of the
/// pattern of length 1, torques weighted by 10 per m) and the six NAME.stop1_rest_fx ... that the
/// wrist reads at rest.
class HeldDecay final : public Experiment {
 public:
  /// Starts at the frequency and damping that best explain the readings in a scan (without
  /// readings, at the configuration's). Throws std::invalid_argument if the hand's pose has no
  /// stable equilibrium or nothing vibrates.
  HeldDecay(std::string name, const HeldCell& cell, std::vector<HeldRinging> ringings,
            const HeldDecayOptions& options = {});

  /// False if a mode would be overdamped.
  bool predict(const Eigen::VectorXd& parameters, Eigen::VectorXd& prediction,
               Eigen::MatrixXd* jacobian) const override;

  /// The parameters with the amplitudes that stop `stop` causes if the hand, with this twist in O
  /// of the origin of G, stops instantly (HeldModes::stops).
  Eigen::VectorXd after_stop(Eigen::VectorXd parameters, int stop,
                             const math::Vector6d& twist) const;
  /// First own parameter of a stop, 2 modes + 6 of them.
  int first_parameter(int stop) const { return stops_[stop].first_parameter; }
  static constexpr int kShared = 4;  // parameters before them

 private:
  enum { kYoungModulus, kObjectDensity, kMass, kStiffness };
  /// Patterns of one stop, in S, by mode; modes concatenated.
  struct Stop {
    Eigen::VectorXd frequencies;
    Eigen::Matrix<double, 6, Eigen::Dynamic> patterns;
    Eigen::VectorXd sizes;                           // by which the patterns have been divided
    Eigen::Matrix<double, Eigen::Dynamic, 6> begin;  // HeldModes::stops
    Eigen::Index first_row = 0;
    int first_parameter = 0;
  };
  void find_patterns(const HeldCell& cell);
  void list_series(const HeldCell& cell);
  void list_parameters(const HeldCell& cell);
  void scan();
  double fit_amplitudes(Eigen::VectorXd& parameters) const;

  std::vector<HeldRinging> ringings_;
  HeldDecayOptions options_;
  std::vector<Stop> stops_;
  double young_ = 1, density_ = 1;  // for which the modes were computed
};

/// The decays of a log: from each stop of the hand (see CalmRule, whose `settle` and `window` are
/// not used here) for `duration` s while it stays calm, in means of 1 / `rate` s.
std::vector<HeldRinging> read_ringings(const std::string& log, const CalmRule& rule,
                                       const std::string& time, double duration, double rate);

/// Kind `held_decay`. Keys: log, configuration, set, time, calm as of held_object; duration (s, 1),
/// rate (Hz, 200), modes, sought (list of density, mass_damping, stiffness_damping; default:
/// mass_damping). Throws config::Error and std::runtime_error.
std::unique_ptr<Experiment> make_held_decay(const config::Node& node,
                                            const std::filesystem::path& folder);

}  // namespace palpate::fit
