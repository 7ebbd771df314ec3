#pragma once

#include <array>

#include "core/estimation/estimator.hpp"

namespace palpate::estimation {

/// Determines from the poses of the hands whether they rest, and since when. The change of the
/// wrench when a hand starts to move must not be taken for an external contact; therefore a hand
/// counts as moving when it has left its rest pose, which is then reset to the present one, and
/// also when it has moved recently.
class RestDetector {
 public:
  struct Options {
    /// m (rad: ten times as much), maximum distance of a resting hand from its rest pose
    double rest_distance = 3e-4;
    /// m (rad: ten times as much), maximum distance of a resting hand from its pose 0.1 s earlier
    double rest_recently = 5e-5;
    double rest = 0.3;  // s, rest time before a wrench change is attributed to an external contact
  };

  explicit RestDetector(const Options& options) : options_(options) {}

  void reset() noexcept;
  /// The hand no longer holds the object: its rest pose is unknown.
  void release(int grasp) noexcept { hands_[grasp] = Hand(); }
  /// Takes the poses of the first `count` grasps. Poses that are not finite are ignored.
  void update(const std::array<GraspInput, 2>& grasps, int count, double dt) noexcept;

  double rest_time() const noexcept { return rest_time_; }  // s for which all hands have rested
  /// Whether the hands have rested for Options::rest.
  bool is_at_rest() const noexcept { return rest_time_ > options_.rest; }

 private:
  struct Hand {
    math::Pose X_OG_rest = math::Pose::Identity();  // pose of the hand at which it came to rest
    math::Vector6d displacement = math::Vector6d::Zero();  // m, rad, from there, mean over 0.1 s
  };
  bool has_moved(Hand& hand, const math::Pose& X_OG, double dt) const noexcept;

  Options options_;
  std::array<Hand, 2> hands_;
  double rest_time_ = 0;
};

}  // namespace palpate::estimation
