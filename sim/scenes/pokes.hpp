#pragma once

#include <utility>
#include <vector>

#include "rt/config/node.hpp"
#include "sim/object/plant.hpp"

namespace palpate::scenes {

/// An external force on one point of the object that no sensor of the robot measures, e.g. the
/// weight of a mass that hangs there (without its inertia). It rises and falls along half a cosine,
/// so that it excites no vibration.
struct Poke {
  static constexpr double kRamp = 0.1;  // s, or half the duration if that is shorter

  double at = 0;                                    // s, start
  double duration = 0;                              // s, including rise and fall
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  // m, at rest, in O
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  // N, in O

  /// Fraction of the force that acts at `time` (s), 0 to 1.
  double share(double time) const;
};

/// The key `pokes` of a scene: a list of {at, duration, point, force} or {at, duration, point,
/// mass}, which hangs in this gravity (m/s^2, in O). Throws config::Error, also if a point lies
/// outside the object of this size (m, from the origin of O).
std::vector<Poke> read_pokes(const config::Node& scene, const Eigen::Vector3d& size,
                             const Eigen::Vector3d& gravity_O);

/// Applies the pokes to the plant, whose applied forces come only from here.
class Pokes {
 public:
  explicit Pokes(std::vector<Poke> pokes) : pokes_(std::move(pokes)) {}

  /// Sets the forces at this time (s), for the plant's next step.
  void apply(double time, object::Plant& plant) noexcept;

 private:
  std::vector<Poke> pokes_;
  bool applied_ = false;
};

}  // namespace palpate::scenes
